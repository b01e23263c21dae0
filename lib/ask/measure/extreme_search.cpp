// SPDX-License-Identifier: Apache-2.0
// Largest and least values of the limit, by branch and bound. A side is a part of the mesh, a channel and a sign: it has the
// best value that is known, and `open`, the largest bound of all that was left without being searched.
//
//     cells of a level → candidates, open while their bound is beyond the best value by more than half the tolerance
//       └→ the most promising are refined; those of the last level become boxes in the parameters of their cells
//            └→ a box is sampled at 5³ nodes, and halved along the axes along which the values bend most
//                 └→ the best places, in up to four cells a side, are followed in the limit itself
//
// In the last part 27 places around the best one are looked at, and the distance shrinks when none of them is better. One of
// the boxes that look alike is enough. Boxes are worked on in batches, with the cells around them that their limit depends on;
// their number is limited, and the error of an extreme is what `open` is beyond it.
#include "extreme_search.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "extreme_bounds.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kStarts = 4;     // cells in which an extreme is followed
constexpr std::size_t kEnough = 8192;  // candidates, before those that are no longer open are looked for

constexpr std::size_t kBoxNodes = 125;                       // of 5³
constexpr std::size_t kBoxesAtOnce = 128;                    // so that their values need little memory
constexpr std::size_t kBoxesOfSide = 512;                    // at most: around an extreme some are enough
constexpr std::size_t kLeastBoxes = 2048, kCellsOfBox = 16;  // so many are halved at most; a box takes some 100 µs
constexpr double kLeastWidth = 1.0 / 64;                     // of a box that is halved

/// One of the best places on its way. step: in parameters, how far the extreme may be along each axis
struct Climb {
    std::size_t part, channel;
    bool high;
    Index cell;
    Vec3 step;
    LimitExtreme best{};

    [[nodiscard]] double largest_step() const { return std::max({step.x, step.y, step.z}); }
};

double value_of(const LimitSamples& samples, std::size_t query, std::size_t channel) {
    for (const LimitAttribute& attribute : samples.attributes) {
        if (channel < attribute.channels) return attribute.values[query * attribute.channels + channel];
        channel -= attribute.channels;
    }
    return 0;
}

/// Takes the best of the places that were looked at for each climb, as many for all. Where that is the one before, the next
/// ones are nearer.
void take_best(const LimitSamples& samples, std::span<const LimitQuery> queries, std::span<Climb> climbs) {
    constexpr double kShrink = 0.35;
    const std::size_t each = queries.size() / climbs.size();
    for (std::size_t i = 0; i < climbs.size(); ++i) {
        Climb& one = climbs[i];
        bool moved = false;
        for (std::size_t q = i * each; q < (i + 1) * each; ++q) {
            const double value = value_of(samples, q, one.channel);
            if (one.best.cell != kNone && (one.high ? value <= one.best.value : value >= one.best.value)) continue;
            one.best = {value, samples.positions[q], one.cell, queries[q].uvw};
            moved = true;
        }
        if (!moved) one.step *= kShrink;
    }
}

/// Looks at the 27 places around the best one of each climb, again and again.
///
/// queries: two for each climb, where it begins
/// number:  of a cell of the climbs in the limit's mesh
template <class Number>
void climb(const LimitEvaluator& limit, std::vector<LimitQuery> queries, std::vector<Climb>& climbs, const Number& number,
           Progress* progress) {
    constexpr int kRounds = 16;
    constexpr double kNear = 2e-4;  // in parameters
    take_best(limit.at(queries), queries, climbs);
    for (int round = 0; round < kRounds; ++round) {
        report_progress(progress, "extremes", static_cast<double>(round) / kRounds);
        queries.clear();
        std::stable_partition(climbs.begin(), climbs.end(), [&](const Climb& one) { return one.largest_step() > kNear; });
        for (const Climb& one : climbs) {
            if (one.largest_step() <= kNear) break;
            for (std::size_t n = 0; n < 27; ++n) {
                const Vec3 offset = one.step * (Vec3(n % 3, n / 3 % 3, n / 9) - Vec3(1.0));
                queries.push_back({number(one.cell), glm::clamp(one.best.uvw + offset, Vec3(0.0), Vec3(1.0))});
            }
        }
        if (queries.empty()) break;
        take_best(limit.at(queries), queries, std::span(climbs).first(queries.size() / 27));
    }
}

void take(const Climb& from, PartMeasure& part) {
    FieldMeasure& field = part.fields[from.channel];
    LimitExtreme& to = from.high ? field.max : field.min;
    const bool better = from.high ? from.best.value > to.value : from.best.value < to.value;
    if (to.cell == kNone || better) to = from.best;
}

}  // namespace

ExtremeSearch::ExtremeSearch(std::size_t parts, std::vector<double> scales, std::vector<std::array<double, 2>> bounds,
                             double tolerance)
    : scales_(std::move(scales)), bounds_(std::move(bounds)), tolerance_(tolerance) {
    for (std::size_t i = 0; i < parts * scales_.size(); ++i) {
        for (const double sign : {-1.0, 1.0}) sides_.push_back({sign});
    }
}

void ExtremeSearch::Side::add(const Start& start) {
    best = std::max(best, sign * start.value);
    const auto same = std::ranges::find(starts, start.cell, &Start::cell);
    if (same != starts.end()) {
        if (sign * start.value < sign * same->value) return;
        starts.erase(same);
    }
    auto at = starts.end();
    while (at != starts.begin() && sign * start.value > sign * (at - 1)->value) --at;
    starts.insert(at, start);
    if (starts.size() > kStarts) starts.pop_back();
}

void ExtremeSearch::know(std::size_t part, std::size_t channel, double value) {
    for (const bool high : {false, true}) {
        const std::size_t number = side_of(part, channel, high);
        Side& side = sides_[number];
        side.best = std::max(side.best, within(number, side.sign * value));
    }
}

void ExtremeSearch::know_constant(std::size_t part, std::size_t channel, double value, Index cell) {
    for (const bool high : {false, true}) {
        Side& side = sides_[side_of(part, channel, high)];
        if (side.starts.empty()) side.add({value, side.sign * value, cell, Vec3(0.0), Vec3(0.0), Vec3(0.0)});
    }
}

void ExtremeSearch::look(std::size_t part, Index cell, std::size_t number, const Vec3& step,
                         std::span<const GridMeasure::Extreme> found) {
    for (const GridMeasure::Extreme& one : found) {
        const std::size_t side = side_of(part, one.channel, one.sign > 0);
        const double bound = within(side, one.bound);
        sides_[side].add({one.sign * one.value, bound, cell, one.uvw, one.peak, step});
        const Candidate candidate{static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(side), bound, one.alike};
        is_open(candidate) ? candidates_.push_back(candidate) : leave(candidate);
    }
    if (candidates_.size() > 2 * kept_ + kEnough) keep_open();
}

void ExtremeSearch::keep_open() {
    std::erase_if(candidates_, [&](const Candidate& candidate) {
        if (!is_open(candidate)) leave(candidate);
        return !is_open(candidate);
    });
    kept_ = candidates_.size();
}

void ExtremeSearch::end_level(std::size_t room, std::vector<std::uint8_t>& marked) {
    keep_open();
    std::ranges::stable_sort(candidates_, std::ranges::greater{}, [&](const Candidate& one) { return excess(one); });
    for (const Candidate& one : candidates_) {
        if (marked[one.number] == 0 && room > 0) {
            marked[one.number] = 1;
            --room;
        }
        if (marked[one.number] == 0) leave(one);
    }
    candidates_.clear();
    kept_ = 0;
}

void ExtremeSearch::end_cells(std::span<const Index> cells) {
    keep_open();
    for (const Candidate& one : candidates_) boxes_.push_back({one, cells[one.number]});
    candidates_.clear();
    kept_ = 0;
}

void ExtremeSearch::end_sides(std::span<const CellSide> sides) {
    keep_open();
    for (const Candidate& one : candidates_) {
        const auto [lower, width] = box_of_side(sides[one.number].side);
        boxes_.push_back({one, sides[one.number].cell, lower, width});
    }
    candidates_.clear();
    kept_ = 0;
}

/// One cell stands for all that look alike, of which a symmetric body or a flag has thousands.
void ExtremeSearch::leave_out_copies() {
    std::set<std::array<std::uint64_t, 2>> met;
    std::erase_if(boxes_, [&](const CellBox& box) { return !met.insert({box.side, box.alike}).second; });
}

struct ExtremeSearch::Surroundings {
    MeshSubset subset;
    LimitEvaluator limit;

    Surroundings(MeshSubset cells, const LimitOptions& options, const LimitExtent& extent)
        : subset(std::move(cells)), limit(subset.mesh, options, extent) {}

    [[nodiscard]] Index number(Index cell) const {
        return static_cast<Index>(std::ranges::lower_bound(subset.cells, cell) - subset.cells.begin());
    }
};

namespace {

/// Some cells of a mesh, and those on which their limit depends.
MeshSubset around(const HexMesh& mesh, std::vector<std::uint8_t> cells) {
    grow(mesh, cells, kHaloOfLimit);
    return subset(mesh, cells);
}

}  // namespace

void ExtremeSearch::find(const HexMesh& control, const SchemeOptions& scheme, const LimitExtent& extent, Progress* progress,
                         std::vector<PartMeasure>& found) {
    LimitOptions options{.scheme = scheme};
    options.scheme.crease_angle_deg.reset();
    halve_all(control, options, extent, progress);
    std::vector<std::uint8_t> cells(control.cells.size(), 0);
    for (const Side& side : sides_) {
        for (const Start& start : side.starts) cells[start.cell] = 1;
    }
    if (std::ranges::find(cells, 1) == cells.end()) return;
    climb_sides(Surroundings(around(control, std::move(cells)), options, extent), progress, found);
}

/// Attribute by attribute where they have many boxes, as a place costs as much as it has channels; the others together.
void ExtremeSearch::halve_all(const HexMesh& control, LimitOptions options, const LimitExtent& extent, Progress* progress) {
    constexpr double kPartOfTolerance = 0.1;
    constexpr std::size_t kManyBoxes = 64;
    options.tolerance = std::max(options.tolerance, kPartOfTolerance * tolerance_);
    leave_out_copies();
    std::vector<std::size_t> attribute_of;  // of each channel
    for (std::size_t a = 0; a < control.attributes.size(); ++a) {
        attribute_of.insert(attribute_of.end(), static_cast<std::size_t>(control.attributes[a].channels), a);
    }
    const auto attribute = [&](const CellBox& box) { return attribute_of[channel_of(box.side)]; };
    std::vector<std::size_t> counts(control.attributes.size(), 0);
    for (const CellBox& box : boxes_) ++counts[attribute(box)];
    std::size_t room = std::max(kLeastBoxes, control.cells.size() / kCellsOfBox);
    std::vector<CellBox> waiting = std::exchange(boxes_, {});
    while (!waiting.empty()) {
        const std::size_t first = attribute(waiting.front()), all = waiting.size();
        const auto is_now = [&](std::size_t a) {
            return counts[a] > 0 && (a == first || std::max(counts[a], counts[first]) < kManyBoxes);
        };
        std::vector<std::uint8_t> cells(control.cells.size(), 0);
        std::erase_if(waiting, [&](const CellBox& box) {
            if (!is_now(attribute(box))) return false;
            boxes_.push_back(box);
            cells[box.cell] = 1;
            return true;
        });
        MeshSubset part = around(control, std::move(cells));
        const std::vector<Attribute> before = std::exchange(part.mesh.attributes, {});
        LimitExtent of_part = extent;
        of_part.ranges.clear();
        std::vector<std::size_t> columns;
        for (std::size_t a = 0, column = 0; a < before.size(); ++a) {
            for (int k = 0; k < before[a].channels; ++k) columns.push_back(column + static_cast<std::size_t>(k));
            if (!is_now(a)) continue;
            column += static_cast<std::size_t>(before[a].channels);
            part.mesh.attributes.push_back(before[a]);
            of_part.ranges.push_back(extent.ranges[a]);
        }
        const std::size_t share = std::min(room, std::max(room * boxes_.size() / all, kBoxesAtOnce));
        room -= halve_boxes(Surroundings(std::move(part), options, of_part), columns, share, progress);
    }
}

/// The most promising boxes first, some at once.
std::size_t ExtremeSearch::halve_boxes(const Surroundings& around, std::span<const std::size_t> columns, std::size_t room,
                                       Progress* progress) {
    const std::size_t all = room;
    std::vector<std::size_t> halved(sides_.size(), 0);
    std::vector<LimitQuery> queries;
    std::array<double, kBoxNodes> grid;
    while (true) {
        std::erase_if(boxes_, [&](const CellBox& box) {
            const bool ends = !is_open(box) || box.narrowest() < kLeastWidth || halved[box.side] >= kBoxesOfSide;
            if (ends) leave(box);
            return ends;
        });
        if (boxes_.empty() || room == 0) break;
        report_progress(progress, "extremes", 1 - static_cast<double>(room) / static_cast<double>(all));
        const std::size_t count = std::min({boxes_.size(), room, kBoxesAtOnce});
        std::ranges::stable_sort(boxes_, std::ranges::greater{}, [&](const CellBox& box) { return excess(box); });
        const std::vector<CellBox> batch(boxes_.begin(), boxes_.begin() + static_cast<std::ptrdiff_t>(count));
        boxes_.erase(boxes_.begin(), boxes_.begin() + static_cast<std::ptrdiff_t>(count));
        queries.clear();
        std::map<std::array<double, 7>, std::size_t> first;  // of the queries of a box: those of several sides share them
        for (const CellBox& box : batch) {
            ++halved[box.side];
            if (!first.try_emplace(box.place(), queries.size()).second) continue;
            for (std::size_t n = 0; n < kBoxNodes; ++n) queries.push_back({around.number(box.cell), box.node(n)});
        }
        room -= std::min(room, first.size());
        const LimitSamples samples = around.limit.at(queries);
        for (const CellBox& box : batch) {
            const std::size_t query = first.at(box.place());
            for (std::size_t n = 0; n < kBoxNodes; ++n) {
                grid[n] = sides_[box.side].sign * value_of(samples, query + n, columns[channel_of(box.side)]);
            }
            halve(box, grid);
        }
    }
    for (const CellBox& box : boxes_) leave(box);
    boxes_.clear();
    return all - room;
}

/// Takes the best node, and the parts in which there may be better places. A box is halved along those axes along which the
/// limit is least known: along a ridge nothing is gained.
void ExtremeSearch::halve(const CellBox& box, std::span<const double, 125> grid) {
    constexpr double kWorth = 0.3;
    Side& side = sides_[box.side];
    const auto best = static_cast<std::size_t>(std::ranges::max_element(grid) - grid.begin());
    const OctantBounds octants = octant_bounds(grid);
    const double bound = std::max(grid[best], std::ranges::max(octants.bounds)),
                 widest = std::max({box.width.x, box.width.y, box.width.z});
    Vec3 step(widest / 8);
    for (int axis = 0; axis < 3; ++axis) {
        if (box.width[axis] == 0) step[axis] = 0;
    }
    side.add({side.sign * grid[best], bound, box.cell, box.node(best), box.node(best), step});
    std::size_t whole = 0;  // the bits of the axes that stay
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (octants.bends[axis] < kWorth * std::ranges::max(octants.bends)) whole |= std::size_t{1} << axis;
    }
    for (std::size_t k = 0; k < 8; ++k) {
        if ((k & whole) != 0) continue;
        CellBox part = box;
        part.bound = -HUGE_VAL;
        for (std::size_t n = 0; n < 8; ++n) {
            if ((n & ~whole) == k) part.bound = std::max(part.bound, octants.bounds[n]);
        }
        part.bound = within(box.side, std::min(part.bound, box.bound));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if ((whole >> axis & 1) != 0) continue;
            const auto a = static_cast<int>(axis);
            part.width[a] /= 2;
            if ((k >> axis & 1) != 0) part.lower[a] += part.width[a];
        }
        is_open(part) ? boxes_.push_back(part) : leave(part);
    }
}

void ExtremeSearch::climb_sides(const Surroundings& around, Progress* progress, std::vector<PartMeasure>& found) const {
    std::vector<Climb> climbs;
    std::vector<LimitQuery> queries;
    for (std::size_t s = 0; s < sides_.size(); ++s) {
        const std::size_t channel = channel_of(s);
        for (const Start& start : sides_[s].starts) {
            if (&start != &sides_[s].starts.front() && start.bound < sides_[s].best) continue;  // leads to nothing better
            climbs.push_back(
                {s / 2 / scales_.size(), channel, s % 2 == 1, start.cell, scales_[channel] > 0 ? start.step : Vec3(0.0)});
            queries.push_back({around.number(start.cell), start.uvw});
            queries.push_back({around.number(start.cell), start.peak});
        }
    }
    climb(
        around.limit, std::move(queries), climbs, [&](Index cell) { return around.number(cell); }, progress);
    const auto each_part = [&](std::size_t part, const auto& visit) {
        visit(found[0]);
        if (found.size() > 1) visit(found[part + 1]);
    };
    for (const Climb& one : climbs) each_part(one.part, [&](PartMeasure& part) { take(one, part); });
    for (std::size_t s = 0; s < sides_.size(); ++s) {
        each_part(s / 2 / scales_.size(), [&](PartMeasure& part) {
            FieldMeasure& field = part.fields[channel_of(s)];
            const double known = s % 2 == 1 ? field.max.value : -field.min.value;
            field.extreme_error = std::max(field.extreme_error, sides_[s].open - known);
        });
    }
}

std::vector<std::array<double, 2>> channel_bounds(const HexMesh& mesh) {
    std::vector<std::array<double, 2>> bounds;
    for (const Attribute& field : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(field.channels);
        if (field.bounds.empty()) {
            bounds.resize(bounds.size() + channels, {-HUGE_VAL, HUGE_VAL});
        } else {
            bounds.insert(bounds.end(), field.bounds.begin(), field.bounds.end());
        }
    }
    return bounds;
}

SideBox box_of_side(std::uint8_t side) {
    const auto a = place_on_side(side, 0, 0), b = place_on_side(side, 1, 1);
    const Vec3 first(a[0], a[1], a[2]), last(b[0], b[1], b[2]);
    return {glm::min(first, last), glm::abs(last - first)};
}

}  // namespace subvol::detail
