// SPDX-License-Identifier: Apache-2.0
// Every cell is refined once, by the table of its class, and integrated. What is left is estimated by what the last level
// changed, and the cells in which that is too much for the whole are refined again:
//
//     level 1  all cells      S₁ is added         left: a part of S₁ − S₀, S₀ of the trilinear cell
//     level 2  some of them   S₂ − S₁ is added    left: a part of S₂ − S₁
//     level 3  some of those  S₃ − S₂ is added …
//
// The cells in which most is left are refined, until that of the others sums up to less than the tolerance. Which part of a
// change is left, is measured where it matters: by a sample of the cells that is refined once more, and from level 3 on by the
// cells themselves. If ρ is the part by which the sums change again, ρ·(S₂ − S₁) is added for the cells that are not refined,
// and ρ times what the changes are without regard to signs is said as the error.
//
// Extremes follow by branch and bound: a cell is refined once more if the limit may go beyond the best value so far between its
// nodes. Where it still may, the octants of the cell are looked at, and theirs (ExtremeSearch).
//
// Cells are worked on in blocks. What is kept of a cell beyond its block is a number, and which cells go on.
#include "measurer.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "seen_folds.h"
#include "subvol/cell.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/node_steps.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/space_order.h"

namespace subvol::detail {

namespace {

constexpr int kMostLevels = 6;
constexpr double kLeftOfTrilinear = 1, kLeftOfQuadratic = 1.0 / 3;  // at most

/// The part of the tolerance that the cells use up which end at a level: as each level costs eight times as much a cell, later
/// ones get more than what their changes are.
double share_of(int level) {
    return level <= 2 ? 0.4 : std::ldexp(0.2, 2 - level);
}

}  // namespace

std::vector<Measurer::Channel> Measurer::channels_of(const HexMesh& mesh, const LimitExtent& extent) {
    std::vector<Channel> channels;
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
        const auto& [low, high] = extent.ranges[a];
        for (int k = 0; k < mesh.attributes[a].channels; ++k) {
            const std::string suffix = mesh.attributes[a].channels > 1 ? "." + std::to_string(k) : "";
            channels.push_back(
                {mesh.attributes[a].name + suffix, low + (high - low) / 2, value_scale(low, high), mesh.attributes[a].derived});
        }
    }
    return channels;
}

std::vector<double> Measurer::origins_of(const std::vector<Channel>& channels) {
    std::vector<double> origins;
    for (const Channel& channel : channels) origins.push_back(channel.origin);
    return origins;
}

std::vector<double> Measurer::scales_of(const std::vector<Channel>& channels) {
    std::vector<double> scales{1};
    for (const Channel& channel : channels) scales.push_back(channel.scale);
    return scales;
}

Measurer::Measurer(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& extent,
                   const MeasureOptions& options)
    : options_(options),
      extent_(extent),
      control_(control_mesh(HexMesh(mesh), options.scheme)),
      refiner_(control_, options.scheme, true),
      channels_(channels_of(control_, extent)),
      scales_(scales_of(channels_)),
      scratch_([this] {
          return Scratch{GridMeasure(origins_of(channels_)), std::vector<double>(channels_.size()), {}};
      }),
      has_fields_(std::ranges::any_of(channels_, [](const Channel& channel) { return channel.scale > 0; })),
      slots_(control_.cells.size()),
      levels_(control_.cells.size(), 1),
      coarsest_(control_.points.size(), 1),
      is_candidate_(control_.cells.size(), 0),
      parts_(part_count(options), PartSums{std::vector<double>(1 + channels_.size(), 0)}),
      extremes_(parts_.size(), {scales_.begin() + 1, scales_.end()}, channel_bounds(control_), options.tolerance) {
    list_cells(owned);
}

std::vector<PartMeasure> Measurer::measure() {
    start();
    notes_.resize(std::min(kBlock, cells_.size()));
    Changes changes = run(cells_, 1);
    const std::vector<PartSums> first = parts_;
    refine_for(0, 1, changes);
    if (has_fields_) {
        const std::vector<PartSums> volumes = std::exchange(parts_, first);
        refine_for(1, scales_.size(), std::move(changes));
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            // A mean is divided by the volume, and a field is within half its range of its origin.
            parts_[p].left = std::max(volumes[p].left, parts_[p].left + volumes[p].left / 2);
            parts_[p].sums[0] = volumes[p].sums[0];
        }
    }
    std::vector<PartMeasure> found = results();
    extremes_.find(control_, options_.scheme, extent_, options_.progress, found);
    return found;
}

SeenFolds Measurer::folds() const {
    return seen_folds(control_, turned_, options_.scheme, options_.progress);
}

/// Whether the first level changes no part's sum, though it changes that of cells: they only exchange what they have, as inside
/// a body with flat sides and a linear field. The levels to come do the same, and what they would add is rounding and guesses.
bool Measurer::is_settled(std::size_t sum) const {
    constexpr double kRounding = 1e-12;
    return std::ranges::all_of(parts_, [&](const PartSums& part) {
        const double size = std::abs(part.sums[0]) / (sum > 0 && scales_[sum] > 0 ? scales_[sum] : 1);  // a field's: its range
        return !part.trilinear.empty() && std::abs(part.sums[sum] - part.trilinear[sum]) <= kRounding * size;
    });
}

void Measurer::refine_for(std::size_t first, std::size_t last, Changes changes) {
    const std::vector<double> scales = scales_;
    std::vector<std::uint8_t> settled(scales_.size(), 0);
    for (std::size_t i = first; i < last; ++i) settled[i] = is_settled(i);
    const auto is_meant = [&](std::size_t sum) { return sum >= first && sum < last && settled[sum] == 0; };
    for (std::size_t i = 0; i < scales_.size(); ++i) scales_[i] = is_meant(i) ? scales[i] : 0;
    changes.keep(is_meant);
    std::ranges::fill(levels_, 1);
    std::ranges::fill(coarsest_, 1);
    std::vector<Index> cells = cells_;
    for (int level = 1; !cells.empty(); ++level) {
        if (level > 1) changes = run(cells, level);
        learn(cells, level, changes);
        cells = choose(cells, changes, level, /*for_fields=*/first > 0);
    }
    scales_ = scales;
}

std::size_t Measurer::part_count(const MeasureOptions& options) {
    std::size_t count = 1;
    for (const Index group : options.groups) count = std::max(count, static_cast<std::size_t>(group) + 1);
    return count;
}

void Measurer::list_cells(std::span<const std::uint8_t> owned) {
    for (Index cell = 0; cell < control_.cells.size(); ++cell) {
        if (owned.empty() || owned[cell] != 0) cells_.push_back(cell);
    }
    if (cells_.size() <= kBlock) return;
    std::vector<Vec3> middles;
    middles.reserve(cells_.size());
    for (const Index cell : cells_) {
        const auto& corners = control_.cells[cell];
        middles.push_back(0.5 * (control_.points[corners[0]] + control_.points[corners[6]]));
    }
    std::vector<Index> order = space_order(middles);
    for (Index& i : order) i = cells_[i];
    cells_ = std::move(order);
}

void Measurer::start() {
    const bool is_known = interpolates(options_.scheme.kind);
    for (const Index cell : cells_) {
        std::size_t c = 0;
        for (const Attribute& attribute : control_.attributes) {
            const auto count = static_cast<std::size_t>(attribute.channels);
            for (std::size_t k = 0; k < count; ++k, ++c) {
                const auto value = [&](Index p) { return attribute.values[p * count + k]; };
                const bool in_cells = is_constant_in_cells(control_, attribute);
                if (channels_[c].scale == 0) {
                    const double constant = in_cells ? attribute.cells[cell * count + k] : value(control_.cells[cell][0]);
                    extremes_.know_constant(part_of(cell), c, constant, cell);
                } else if (is_known && !in_cells) {
                    for (const Index p : control_.cells[cell]) extremes_.know(part_of(cell), c, value(p));
                }
            }
        }
    }
}

void Measurer::calibrate(std::span<const Index> cells, int level, Changes& changes) {
    constexpr std::size_t kSample = 128, kLeastWork = 8192;  // cells; pieces
    std::vector<std::uint32_t> order = by_change(cells, level, changes);
    const std::size_t wanted = std::max(kSample / static_cast<std::size_t>(level), kLeastWork >> 3 * level);
    const std::size_t stride = std::max<std::size_t>((order.size() + wanted - 1) / wanted, 1);
    const std::size_t count = (order.size() + stride - 1) / stride;
    for (std::size_t i = 0; i < count; ++i) order[i] = order[i * stride];
    order.resize(count);
    std::vector<Index> sample(count);
    for (std::size_t i = 0; i < count; ++i) sample[i] = cells[order[i]];
    sample_ = SampleOfChanges{std::move(order), Changes(1 + channels_.size(), sample.size(), 0), stride == 1};
    Changes& next = sample_->next;
    each_block(
        sample, level + 1, "measure",
        [&](const DenseCell& grid, std::size_t slot) {
            GridMeasure& measure = scratch_.local().measure;
            std::vector<double> coarse(1 + channels_.size(), 0);
            notes_[slot].changes.assign(coarse.size(), 0);
            measure.add_sums(grid, 1, notes_[slot].changes);
            measure.add_sums(grid, 2, coarse);
            for (std::size_t i = 0; i < coarse.size(); ++i) notes_[slot].changes[i] -= coarse[i];
            leave_out_shared(grid, notes_[slot].changes);
        },
        [&](Index, std::size_t number, std::size_t slot) { next.note(number, notes_[slot].changes, scales_); });
    next.compare([](std::size_t) { return std::array<Index, 0>{}; });
    changes.expect(*sample_);
}

/// The cells of a level, those with the largest changes first.
std::vector<std::uint32_t> Measurer::by_change(std::span<const Index> cells, int level, const Changes& changes) const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
        if (levels_[cells[i]] == level) order.push_back(i);
    }
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::uint32_t i) { return changes.largest(i); });
    return order;
}

Changes Measurer::run(std::span<const Index> cells, int level) {
    pieces_ += level == 1 ? cells.size() : 7 * static_cast<std::size_t>(std::ranges::count(levels_, level)) << 3 * (level - 2);
    Changes changes(1 + channels_.size(), cells.size(), level == 1 ? kLeftOfTrilinear : kLeftOfQuadratic);
    each_block(
        cells, level, level == 1 ? "measure" : "refine",
        [&](const DenseCell& grid, std::size_t slot) { note_cell(grid, level, notes_[slot]); },
        [&](Index cell, std::size_t number, std::size_t slot) {
            changes.note(number, notes_[slot].changes, scales_);
            collect(cell, number, std::ldexp(0.5, -level), notes_[slot]);
        });
    compare_with_neighbors(cells, changes);
    return changes;
}

void Measurer::learn(std::span<const Index> cells, int level, Changes& changes) {
    sample_.reset();
    if (level > 2 && gone_on_) {
        Rest after(scales_.size());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (levels_[cells[i]] == level) after.add(changes, i, 1);
        }
        changes.expect(*gone_on_, after);
    } else if (!is_enough(cells, level, changes)) {
        calibrate(cells, level, changes);
    }
}

void Measurer::compare_with_neighbors(std::span<const Index> cells, Changes& changes) {
    std::vector<Index> numbers(control_.cells.size(), kNone);
    for (std::size_t i = 0; i < cells.size(); ++i) numbers[cells[i]] = static_cast<Index>(i);
    changes.compare([&](std::size_t number) {
        std::array<Index, 6> beside;
        for (std::size_t side = 0; side < 6; ++side) {
            const Index cell = refiner_.links().neighbors[cells[number]][side];
            beside[side] = cell == kNone ? kNone : numbers[cell];
        }
        return beside;
    });
}

void Measurer::note_cell(const DenseCell& grid, int level, CellNote& note) {
    GridMeasure& measure = scratch_.local().measure;
    note.sums.clear();
    note.trilinear.clear();
    note.turned = false;
    note.changes.assign(1 + channels_.size(), 0);
    if (levels_[grid.cell] == level) note_sums(grid, level, note);
    note.extremes.clear();
    if (level > 1 && is_candidate_[grid.cell] == 0) return;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        if (channels_[c].scale == 0) continue;
        measure.add_extremes(grid, c, extremes_.known(part_of(grid.cell), c), extremes_.quantum(c), note.extremes);
    }
}

void Measurer::note_sums(DenseCell grid, int level, CellNote& note) {
    Scratch& scratch = scratch_.local();
    note.sums = note.changes;
    if (level == 1) {
        scratch.measure.add_trilinear_sums(grid, note.changes);
        note.trilinear = note.changes;
    } else {
        close_gaps(grid, level, levels_beside(grid.cell, level), scratch.points);
        grid.points = scratch.points;
        scratch.measure.add_sums(grid, 2, note.changes);
    }
    scratch.measure.add_sums(grid, 1, note.sums);
    note.turned = scratch.measure.least_determinant() < 0;
    for (std::size_t i = 0; i < note.sums.size(); ++i) note.changes[i] = note.sums[i] - note.changes[i];
    if (level > 1) note.sums = note.changes;
    leave_out_shared(grid, note.changes);
}

void Measurer::leave_out_shared(const DenseCell& grid, std::vector<double>& changes) {
    Scratch& scratch = scratch_.local();
    changes[0] = 0;
    for (std::size_t side = 0; side < 6; ++side) {
        const Index beside = refiner_.links().neighbors[grid.cell][side];
        const bool is_hull = beside == kNone || !(options_.cells.empty() || options_.cells[beside] != 0);
        if (!is_hull && !has_fields_) continue;
        const double swept = GridMeasure::swept(grid, side);
        if (is_hull) {
            changes[0] += swept;
            continue;
        }
        scratch.measure.mean_on_side(grid, side, scratch.means);
        for (std::size_t c = 0; c < channels_.size(); ++c) changes[1 + c] -= scratch.means[c] * swept;
    }
}

LevelsBeside Measurer::levels_beside(Index cell, int level) const {
    LevelsBeside beside;
    const auto most = static_cast<std::uint8_t>(level);
    for (std::size_t side = 0; side < 6; ++side) {
        const Index other = refiner_.links().neighbors[cell][side];
        beside.sides[side] = other == kNone ? most : std::min(most, levels_[other]);
    }
    const auto& corners = control_.cells[cell];
    for (std::size_t e = 0; e < 12; ++e) {
        const Index a = corners[static_cast<std::size_t>(kCellEdges[e][0])],
                    b = corners[static_cast<std::size_t>(kCellEdges[e][1])];
        beside.edges[e] = std::min(most, std::max(coarsest_[a], coarsest_[b]));
    }
    return beside;
}

void Measurer::note_levels(std::span<const Index> cells, int level) {
    for (const Index cell : cells) levels_[cell] = static_cast<std::uint8_t>(level);
    std::ranges::fill(coarsest_, 0xff);
    for (std::size_t c = 0; c < levels_.size(); ++c) {
        for (const Index p : control_.cells[c]) coarsest_[p] = std::min(coarsest_[p], levels_[c]);
    }
}

void Measurer::collect(Index cell, std::size_t number, double step, const CellNote& note) {
    const std::size_t p = part_of(cell);
    for (std::size_t i = 0; i < note.sums.size(); ++i) parts_[p].sums[i] += note.sums[i];
    parts_[p].trilinear.resize(scales_.size());
    for (std::size_t i = 0; i < note.trilinear.size(); ++i) parts_[p].trilinear[i] += note.trilinear[i];
    if (note.turned) turned_.push_back(cell);
    extremes_.look(p, cell, number, Vec3(step), note.extremes);
}

std::vector<Index> Measurer::choose(std::span<const Index> cells, Changes& changes, int level, bool for_fields) {
    constexpr std::size_t kLeastWork = 32768;  // pieces
    const std::size_t work = level >= kMostLevels ? 0 : std::max(cells_.size(), kLeastWork);
    std::vector<std::uint8_t> for_extremes(cells.size(), 0), for_sums(cells.size(), 0);
    if (for_fields && level == 1) extremes_.end_level(work >> 3, for_extremes);
    if (for_fields && level > 1) extremes_.end_cells(cells);
    choose_for_sums(cells, changes, level, 8 * work >> 3 * level, for_sums);
    std::vector<Index> next, summed;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (for_extremes[i] != 0 || for_sums[i] != 0) next.push_back(cells[i]);
        if (for_sums[i] != 0) summed.push_back(cells[i]);
        is_candidate_[cells[i]] = for_extremes[i];
    }
    note_levels(summed, level + 1);
    return next;
}

std::vector<Rest> Measurer::rests_of(std::span<const Index> cells, int level, const Changes& changes) const {
    std::vector<Rest> rests(parts_.size(), Rest(scales_.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (levels_[cells[i]] == level) rests[part_of(cells[i])].add(changes, i, 1);
    }
    return rests;
}

double Measurer::allowed(std::size_t part, int level) const {
    return share_of(level) * options_.tolerance * std::abs(parts_[part].sums[0]);
}

bool Measurer::is_enough(std::span<const Index> cells, int level, const Changes& changes) const {
    const std::vector<Rest> rests = rests_of(cells, level, changes);
    for (std::size_t p = 0; p < rests.size(); ++p) {
        if (rests[p].size(changes.left) > allowed(p, level)) return false;
    }
    return true;
}

void Measurer::choose_for_sums(std::span<const Index> cells, Changes& changes, int level, std::size_t room,
                               std::vector<std::uint8_t>& chosen) {
    constexpr int kRounds = 8;
    std::vector<Rest> rests = rests_of(cells, level, changes);
    const std::vector<std::uint32_t> order = by_change(cells, level, changes);
    gone_on_.reset();
    // What is not refined has smaller changes than what is, and need not behave like it: it is judged by itself.
    for (int round = 0; round < kRounds; ++round) {
        bool is_enough = true;
        for (const std::uint32_t i : order) {
            const std::size_t p = part_of(cells[i]);
            if (chosen[i] != 0 || room == 0 || rests[p].size(changes.left) <= allowed(p, level)) continue;
            is_enough = false;
            chosen[i] = 1;
            rests[p].add(changes, i, -1);
            if (!gone_on_) gone_on_.emplace(scales_.size());
            gone_on_->add(changes, i, 1);
            --room;
        }
        if (is_enough || !sample_) break;
        changes.expect(*sample_, chosen);
    }
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        parts_[p].left += rests[p].size(changes.left);
        for (std::size_t i = 0; i < parts_[p].sums.size(); ++i) {
            if (scales_[i] > 0) parts_[p].sums[i] += changes.follows[i] * rests[p].sum(i) / scales_[i];
        }
    }
}

std::vector<PartMeasure> Measurer::results() const {
    PartSums whole = parts_.front();
    for (std::size_t p = 1; p < parts_.size(); ++p) {
        for (std::size_t i = 0; i < whole.sums.size(); ++i) whole.sums[i] += parts_[p].sums[i];
        whole.left += parts_[p].left;
    }
    std::vector<PartMeasure> found(1, result(whole));
    found[0].cells = cells_.size();
    if (options_.groups.empty()) return found;
    for (const PartSums& part : parts_) found.push_back(result(part));
    for (std::size_t p = 0; p < parts_.size(); ++p) found[p + 1].name = p < options_.names.size() ? options_.names[p] : "";
    for (const Index cell : cells_) ++found[options_.groups[cell] + 1].cells;
    return found;
}

PartMeasure Measurer::result(const PartSums& part) const {
    PartMeasure measure;
    const double volume = part.sums[0];
    measure.volume = volume;
    measure.error = volume != 0 ? part.left / std::abs(volume) : 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        FieldMeasure field;
        const double sum = part.sums[1 + c], origin = channels_[c].origin;
        field.name = channels_[c].name;
        field.derived = channels_[c].derived;
        field.integral = sum + origin * volume;
        if (volume != 0) field.mean = origin + sum / volume;
        measure.fields.push_back(std::move(field));
    }
    return measure;
}

}  // namespace subvol::detail
