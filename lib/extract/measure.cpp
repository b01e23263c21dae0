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
// Extremes follow by branch and bound: a cell is refined as well if the limit may go beyond the best value so far between its
// nodes. In the end the best places are evaluated in the limit itself.
//
// Cells are worked on in blocks. What is kept of a cell beyond its block is a number, and which cells go on.
#include "subvol/measure.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "cell_refiner.h"
#include "extreme_search.h"
#include "grid_measure.h"
#include "hanging_nodes.h"
#include "node_steps.h"
#include "refine_steps.h"
#include "space_order.h"
#include "subvol/cell.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/error.h"
#include "sum_changes.h"

namespace subvol {

namespace {

using detail::Changes;
using detail::GridMeasure;
using detail::Rest;

constexpr std::size_t kBlock = 8192;  // cells: fixed, so that sums do not depend on the number of threads
constexpr int kUnitBits = 52;         // of the largest volume of a histogram
constexpr int kMostLevels = 6, kMostLevelsOfExtremes = 4;
constexpr double kLeftOfTrilinear = 1, kLeftOfQuadratic = 1.0 / 3;  // at most

/// The part of the tolerance that the cells use up which end at a level: as each level costs eight times as much a cell, later
/// ones get more than what their changes are.
double share_of(int level) {
    return level <= 2 ? 0.4 : std::ldexp(0.2, 2 - level);
}

/// One channel of an attribute. scale: 1/range of the attribute, or 0 for a constant
struct Channel {
    std::string name;
    double origin, scale;
};

std::vector<Channel> channels_of(const HexMesh& mesh, const detail::LimitExtent& extent) {
    std::vector<Channel> channels;
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
        const auto& [low, high] = extent.ranges[a];
        for (int k = 0; k < mesh.attributes[a].channels; ++k) {
            const std::string suffix = mesh.attributes[a].channels > 1 ? "." + std::to_string(k) : "";
            channels.push_back({mesh.attributes[a].name + suffix, low + (high - low) / 2, detail::value_scale(low, high)});
        }
    }
    return channels;
}

std::vector<double> origins_of(const std::vector<Channel>& channels) {
    std::vector<double> origins;
    for (const Channel& channel : channels) origins.push_back(channel.origin);
    return origins;
}

std::vector<double> scales_of(const std::vector<Channel>& channels) {
    std::vector<double> scales{1};
    for (const Channel& channel : channels) scales.push_back(channel.scale);
    return scales;
}

/// What the cells of a part sum up to.
///
/// sums:     the volume, then the integrals of the channels without their origins
/// left:     of these, as a volume: that of an integral is divided by the channel's range
struct PartSums {
    std::vector<double> sums;
    double left = 0;
};

/// The notes of one cell of a block: what it adds to the sums, and by how much its own sums differ from those of the level
/// before.
struct CellNote {
    std::vector<double> sums, changes;
    std::vector<GridMeasure::Extreme> extremes;
};

/// Memory of one thread.
struct Scratch {
    GridMeasure measure;
    std::vector<double> means;
    std::vector<Vec3> points;
};

class Measurer {
public:
    /// owned:  a flag for each cell that is measured, the others are a halo; none: all are
    /// extent: of the whole mesh
    Measurer(const HexMesh& mesh, std::span<const std::uint8_t> owned, const detail::LimitExtent& extent,
             const MeasureOptions& options)
        : options_(options),
          extent_(extent),
          control_(detail::control_mesh(HexMesh(mesh), options.scheme)),
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
          extremes_(parts_.size(), {scales_.begin() + 1, scales_.end()}, options.tolerance) {
        list_cells(owned);
    }

    /// The whole, then the parts of the groups.
    std::vector<PartMeasure> measure() {
        start();
        std::vector<Index> cells = cells_;
        for (int level = 1; !cells.empty(); ++level) cells = run(cells, level);
        std::vector<PartMeasure> found = results();
        extremes_.find(control_, options_.scheme, extent_, options_.progress, found);
        return found;
    }

    [[nodiscard]] std::size_t pieces() const { return pieces_; }

    /// found: the whole, whose extremes are those of the histograms, and then the parts
    void add_histograms(std::vector<PartMeasure>& found) {
        const auto bins = static_cast<std::size_t>(options_.bins);
        for (PartMeasure& part : found) {
            for (FieldMeasure& field : part.fields) field.histogram.assign(bins, 0);
        }
        if (!has_fields_) {
            for (PartMeasure& part : found) {
                for (FieldMeasure& field : part.fields) field.histogram[0] = part.volume;
            }
            return;
        }
        // Few cells are refined more often, so that each interval has enough Gauss points.
        constexpr std::size_t kEnough = 16384;  // pieces
        int level = 1;
        while (level < 4 && cells_.size() << 3 * level <= kEnough) ++level;
        // Volumes are counted in a unit, as sums of whole numbers are the same in any order.
        const double unit = std::ldexp(std::max(std::abs(found[0].volume), box_volume()), -kUnitBits);
        using Counts = std::vector<std::int64_t>;
        const std::size_t each = channels_.size() * bins;
        tbb::enumerable_thread_specific<Counts> counts([&] { return Counts(parts_.size() * each, 0); });
        each_block(
            cells_, level, "histogram",
            [&](const DenseCell& grid, std::size_t) {
                count(grid, found[0], unit, std::span(counts.local()).subspan(part_of(grid.cell) * each, each));
            },
            [](Index, std::size_t, std::size_t) {});
        Counts all(parts_.size() * each, 0);
        for (const Counts& some : counts) std::ranges::transform(some, all, all.begin(), std::plus{});
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double volume = static_cast<double>(all[i]) * unit;
            const auto add = [&](PartMeasure& part) { part.fields[i % each / bins].histogram[i % bins] += volume; };
            add(found[0]);
            if (found.size() > 1) add(found[i / each + 1]);
        }
    }

    /// The volumes of a histogram sum up to that of the part, which is known better.
    static void scale_histograms(PartMeasure& part) {
        for (FieldMeasure& field : part.fields) {
            const double sum = std::accumulate(field.histogram.begin(), field.histogram.end(), 0.0);
            if (sum == 0) continue;
            for (double& volume : field.histogram) volume *= part.volume / sum;
        }
    }

private:
    [[nodiscard]] static std::size_t part_count(const MeasureOptions& options) {
        std::size_t count = 1;
        for (const Index group : options.groups) count = std::max(count, static_cast<std::size_t>(group) + 1);
        return count;
    }
    [[nodiscard]] std::size_t part_of(Index cell) const { return options_.groups.empty() ? 0 : options_.groups[cell]; }

    /// The cells in the order in which they are worked on: neighbours in space, as their refinement shares what is around them.
    void list_cells(std::span<const std::uint8_t> owned) {
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
        std::vector<Index> order = detail::space_order(middles);
        for (Index& i : order) i = cells_[i];
        cells_ = std::move(order);
    }

    /// If the scheme interpolates, the limit is known to have the values of the control points; a constant has its own anyway.
    void start() {
        const bool is_known = interpolates(options_.scheme.kind);
        for (const Index cell : cells_) {
            std::size_t c = 0;
            for (const Attribute& attribute : control_.attributes) {
                const auto count = static_cast<std::size_t>(attribute.channels);
                for (std::size_t k = 0; k < count; ++k, ++c) {
                    const auto value = [&](Index p) { return attribute.values[p * count + k]; };
                    if (channels_[c].scale == 0) {
                        extremes_.know_constant(part_of(cell), c, value(control_.cells[cell][0]), cell);
                    } else if (is_known) {
                        for (const Index p : control_.cells[cell]) extremes_.know(part_of(cell), c, value(p));
                    }
                }
            }
        }
    }

    /// Refines cells block by block.
    ///
    /// note:    gets the grid of each cell and its place in the block, from several threads and in any order
    /// collect: gets each cell, its number in `cells` and its place in the block, in the order of `cells`
    template <class Note, class Collect>
    void each_block(std::span<const Index> cells, int level, const char* stage, const Note& note, const Collect& collect) {
        const std::size_t most = std::max<std::size_t>(kBlock >> 3 * (level - 1), 64);
        for (std::size_t first = 0; first < cells.size(); first += most) {
            report_progress(options_.progress, stage, static_cast<double>(first) / static_cast<double>(cells.size()));
            const auto block = cells.subspan(first, std::min(most, cells.size() - first));
            for (std::size_t slot = 0; slot < block.size(); ++slot) slots_[block[slot]] = static_cast<Index>(slot);
            refiner_.for_each(
                block, level, nullptr, [&](const DenseCell& grid) { note(grid, slots_[grid.cell]); },
                detail::CellRefiner::Tables::Common);
            for (std::size_t slot = 0; slot < block.size(); ++slot) collect(block[slot], first + slot, slot);
        }
    }

    /// How much of a level's changes is left depends on how well the mesh resolves its fields, by a factor of forty. A sample
    /// of the cells tells.
    void calibrate(std::span<const Index> cells, int level, Changes& changes) {
        constexpr std::size_t kSample = 128;
        std::vector<std::uint32_t> order;
        for (std::uint32_t i = 0; i < cells.size(); ++i) {
            if (levels_[cells[i]] == level) order.push_back(i);
        }
        std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::uint32_t i) { return changes.largest(i); });
        const std::size_t stride = std::max<std::size_t>(static_cast<std::size_t>(level) * order.size() / kSample, 1);
        const std::size_t all = order.size(), count = (all + stride - 1) / stride;
        for (std::size_t i = 0; i < count; ++i) order[i] = order[i * stride];
        order.resize(count);
        std::vector<Index> sample(count);
        Rest before(scales_.size());
        for (std::size_t i = 0; i < count; ++i) {
            sample[i] = cells[order[i]];
            before.add(changes, order[i], 1);
        }
        Changes next(1 + channels_.size(), sample.size(), 0);
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
        Rest after(scales_.size());
        for (std::size_t i = 0; i < sample.size(); ++i) after.add(next, i, 1);
        changes.expect(before, after, stray_of_sample(changes, order, next, all));
    }

    /// Measures cells at a level. Returns those that are to be refined further, in the same order.
    std::vector<Index> run(std::span<const Index> cells, int level) {
        notes_.resize(std::min(kBlock, cells.size()));
        pieces_ +=
            level == 1 ? cells.size() : 7 * static_cast<std::size_t>(std::ranges::count(levels_, level)) << 3 * (level - 2);
        Changes changes(1 + channels_.size(), cells.size(), level == 1 ? kLeftOfTrilinear : kLeftOfQuadratic);
        each_block(
            cells, level, level == 1 ? "measure" : "refine",
            [&](const DenseCell& grid, std::size_t slot) { note_cell(grid, level, notes_[slot]); },
            [&](Index cell, std::size_t number, std::size_t slot) {
                changes.note(number, notes_[slot].changes, scales_);
                collect(cell, number, std::ldexp(0.5, -level), notes_[slot]);
            });
        compare_with_neighbors(cells, changes);
        if (level > 2 && gone_on_) {
            Rest after(scales_.size());
            for (std::size_t i = 0; i < cells.size(); ++i) {
                if (levels_[cells[i]] == level) after.add(changes, i, 1);
            }
            changes.expect(*gone_on_, after);
        } else if (!is_enough(cells, level, changes)) {
            calibrate(cells, level, changes);
        }
        return choose(cells, changes, level);
    }

    void compare_with_neighbors(std::span<const Index> cells, Changes& changes) {
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

    void note_cell(const DenseCell& grid, int level, CellNote& note) {
        GridMeasure& measure = scratch_.local().measure;
        note.sums.clear();
        note.changes.assign(1 + channels_.size(), 0);
        if (levels_[grid.cell] == level) note_sums(grid, level, note);
        note.extremes.clear();
        if (level > 1 && is_candidate_[grid.cell] == 0) return;
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            if (channels_[c].scale == 0) continue;
            measure.add_extremes(grid, c, extremes_.known(part_of(grid.cell), c), note.extremes);
        }
    }

    void note_sums(DenseCell grid, int level, CellNote& note) {
        Scratch& scratch = scratch_.local();
        note.sums = note.changes;
        if (level == 1) {
            scratch.measure.add_trilinear_sums(grid, note.changes);
        } else {
            close_gaps(grid, level, levels_beside(grid.cell, level), scratch.points);
            grid.points = scratch.points;
            scratch.measure.add_sums(grid, 2, note.changes);
        }
        scratch.measure.add_sums(grid, 1, note.sums);
        for (std::size_t i = 0; i < note.sums.size(); ++i) note.changes[i] = note.sums[i] - note.changes[i];
        if (level > 1) note.sums = note.changes;
        leave_out_shared(grid, note.changes);
    }

    /// What a side sweeps, the cell beside it loses: it changes nothing but the volume at the hull.
    void leave_out_shared(const DenseCell& grid, std::vector<double>& changes) {
        Scratch& scratch = scratch_.local();
        changes[0] = 0;
        for (std::size_t side = 0; side < 6; ++side) {
            const bool is_hull = refiner_.links().neighbors[grid.cell][side] == kNone;
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

    /// The levels of the cells beside one that is refined to a level. All cells at an edge are at both of its ends, so that the
    /// coarsest cells at these tell which level all of them have at least.
    [[nodiscard]] detail::LevelsBeside levels_beside(Index cell, int level) const {
        detail::LevelsBeside beside;
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

    /// Notes the level to which the sums of cells are known, and the coarsest at each point.
    void note_levels(std::span<const Index> cells, int level) {
        for (const Index cell : cells) levels_[cell] = static_cast<std::uint8_t>(level);
        std::ranges::fill(coarsest_, 0xff);
        for (std::size_t c = 0; c < levels_.size(); ++c) {
            for (const Index p : control_.cells[c]) coarsest_[p] = std::min(coarsest_[p], levels_[c]);
        }
    }

    void collect(Index cell, std::size_t number, double step, const CellNote& note) {
        const std::size_t p = part_of(cell);
        for (std::size_t i = 0; i < note.sums.size(); ++i) parts_[p].sums[i] += note.sums[i];
        extremes_.look(p, cell, number, step, note.extremes);
    }

    /// The cells that go on to the next level: those with candidates for extremes, and those of whose sums most is left. At
    /// most so many as cost about as much as the first level. What stays is added to what is left of the parts.
    std::vector<Index> choose(std::span<const Index> cells, const Changes& changes, int level) {
        constexpr std::size_t kLeastWork = 32768;  // pieces
        const std::size_t work = level >= kMostLevels ? 0 : std::max(cells_.size(), kLeastWork);
        std::vector<std::uint8_t> for_extremes(cells.size(), 0), for_sums(cells.size(), 0);
        extremes_.end_level(level < kMostLevelsOfExtremes ? work >> 3 * level : 0, for_extremes);
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

    /// What is left of each part in the cells that are known to a level.
    [[nodiscard]] std::vector<Rest> rests_of(std::span<const Index> cells, int level, const Changes& changes) const {
        std::vector<Rest> rests(parts_.size(), Rest(scales_.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (levels_[cells[i]] == level) rests[part_of(cells[i])].add(changes, i, 1);
        }
        return rests;
    }

    [[nodiscard]] double allowed(std::size_t part, int level) const {
        return share_of(level) * options_.tolerance * std::abs(parts_[part].sums[0]);
    }

    /// Whether nothing has to be refined for sums.
    [[nodiscard]] bool is_enough(std::span<const Index> cells, int level, const Changes& changes) const {
        const std::vector<Rest> rests = rests_of(cells, level, changes);
        for (std::size_t p = 0; p < rests.size(); ++p) {
            if (rests[p].size(changes.left) > allowed(p, level)) return false;
        }
        return true;
    }

    void choose_for_sums(std::span<const Index> cells, const Changes& changes, int level, std::size_t room,
                         std::vector<std::uint8_t>& chosen) {
        std::vector<Rest> rests = rests_of(cells, level, changes);
        std::vector<std::uint32_t> order;
        for (std::uint32_t i = 0; i < cells.size(); ++i) {
            if (levels_[cells[i]] == level) order.push_back(i);
        }
        std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::uint32_t i) { return changes.largest(i); });
        gone_on_.reset();
        for (const std::uint32_t i : order) {
            const std::size_t p = part_of(cells[i]);
            if (room == 0 || rests[p].size(changes.left) <= allowed(p, level)) continue;
            chosen[i] = 1;
            rests[p].add(changes, i, -1);
            if (!gone_on_) gone_on_.emplace(scales_.size());
            gone_on_->add(changes, i, 1);
            --room;
        }
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            parts_[p].left += rests[p].size(changes.left);
            for (std::size_t i = 0; i < parts_[p].sums.size(); ++i) {
                if (scales_[i] > 0) parts_[p].sums[i] += changes.follows[i] * rests[p].sum(i) / scales_[i];
            }
        }
    }

    /// The whole and the parts, without their extremes.
    [[nodiscard]] std::vector<PartMeasure> results() const {
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
        for (const Index group : options_.groups) ++found[group + 1].cells;
        return found;
    }

    [[nodiscard]] PartMeasure result(const PartSums& part) const {
        PartMeasure measure;
        const double volume = part.sums[0];
        measure.volume = volume;
        measure.error = volume != 0 ? part.left / std::abs(volume) : 0;
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            FieldMeasure field;
            const double sum = part.sums[1 + c], origin = channels_[c].origin;
            field.name = channels_[c].name;
            field.integral = sum + origin * volume;
            field.mean = volume != 0 ? origin + sum / volume : 0;
            measure.fields.push_back(std::move(field));
        }
        return measure;
    }

    [[nodiscard]] double box_volume() const {
        const Vec3 size = extent_.box.upper - extent_.box.lower;
        return size.x * size.y * size.z;
    }

    /// Adds the volumes of a cell to the counts, bin by bin, channel after channel.
    void count(const DenseCell& grid, const PartMeasure& whole, double unit, std::span<std::int64_t> counts) {
        const auto bins = static_cast<std::size_t>(options_.bins);
        scratch_.local().measure.each_gauss_point(grid, [&](double weight, std::span<const double> values) {
            const double units = weight / unit;
            if (!(std::abs(units) < std::ldexp(1.0, kUnitBits))) return;  // no such volume is in the box
            const auto whole_units = static_cast<std::int64_t>(std::llround(units));
            for (std::size_t c = 0; c < values.size(); ++c) {
                const double low = whole.fields[c].min.value - channels_[c].origin;
                const double width = whole.fields[c].max.value - whole.fields[c].min.value;
                const double t = width > 0 ? (values[c] - low) / width * static_cast<double>(bins) : 0;
                counts[c * bins + static_cast<std::size_t>(std::clamp(t, 0.0, static_cast<double>(bins - 1)))] += whole_units;
            }
        });
    }

    const MeasureOptions& options_;
    const detail::LimitExtent& extent_;
    HexMesh control_;
    detail::CellRefiner refiner_;
    std::vector<Channel> channels_;
    std::vector<double> scales_;  // of the volume and of the channels
    tbb::enumerable_thread_specific<Scratch> scratch_;
    bool has_fields_;                              // that are not constant
    std::vector<Index> cells_, slots_;             // that are measured; the place of each in its block
    std::vector<std::uint8_t> levels_, coarsest_;  // of the cells; the least at each point
    std::vector<std::uint8_t> is_candidate_;       // a flag for each cell: for an extreme
    std::optional<Rest> gone_on_;                  // the changes of the cells that were refined further for their sums
    std::vector<PartSums> parts_;
    std::vector<CellNote> notes_;
    detail::ExtremeSearch extremes_;
    std::size_t pieces_ = 0;
};

LimitMeasure measure(const HexMesh& mesh, const MeasureOptions& options) {
    if (!options.groups.empty() && options.groups.size() != mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.groups.size()) + " groups of cells",
                    "measure", "one for each of the cells");
    }
    const detail::LimitExtent extent = detail::limit_extent(mesh);
    Measurer measurer(mesh, {}, extent, options);
    std::vector<PartMeasure> found = measurer.measure();
    measurer.add_histograms(found);
    for (PartMeasure& part : found) Measurer::scale_histograms(part);
    LimitMeasure result{std::move(found.front()), {}, measurer.pieces()};
    result.parts.assign(std::make_move_iterator(found.begin() + 1), std::make_move_iterator(found.end()));
    return result;
}

LimitExtreme in_whole(LimitExtreme extreme, const MeshPiece& piece) {
    const std::uint64_t number = extreme.cell == kNone ? kNone : piece.cell_numbers[extreme.cell];
    extreme.cell = number < kNone ? static_cast<Index>(number) : kNone;
    return extreme;
}

/// Adds the measure of a piece to those before it. first: there are none
void add(const PartMeasure& measured, const MeshPiece& piece, bool first, PartMeasure& all) {
    all.cells += measured.cells;
    all.volume += measured.volume;
    all.error += measured.error * std::abs(measured.volume);  // divided by the volume of all when that is known
    all.fields.resize(measured.fields.size());
    for (std::size_t f = 0; f < measured.fields.size(); ++f) {
        const FieldMeasure& from = measured.fields[f];
        FieldMeasure& to = all.fields[f];
        to.name = from.name;
        to.integral += from.integral;
        to.extreme_error = std::max(to.extreme_error, from.extreme_error);
        if (first || from.min.value < to.min.value) to.min = in_whole(from.min, piece);
        if (first || from.max.value > to.max.value) to.max = in_whole(from.max, piece);
    }
}

/// Adds the volumes of a piece to the histograms of the whole.
void add_to_histograms(Measurer& measurer, PartMeasure& whole) {
    std::vector<PartMeasure> piece(1, whole);
    measurer.add_histograms(piece);
    for (std::size_t f = 0; f < whole.fields.size(); ++f) {
        for (std::size_t b = 0; b < whole.fields[f].histogram.size(); ++b) {
            whole.fields[f].histogram[b] += piece[0].fields[f].histogram[b];
        }
    }
}

/// The extent of a mesh in pieces, whose fields may not be known.
detail::LimitExtent extent_of(const MeshSource::Stored& stored, const HexMesh& piece) {
    detail::LimitExtent extent = detail::limit_extent(piece);
    extent.box = stored.bounds;
    if (stored.fields.size() != extent.ranges.size()) return extent;
    for (std::size_t f = 0; f < stored.fields.size(); ++f) extent.ranges[f] = {stored.fields[f].min, stored.fields[f].max};
    return extent;
}

LimitMeasure measure_pieces(const MeshSource& source, const MeasureOptions& options) {
    source.check_halo(detail::kHaloOfLimit, "values of the limit");
    if (!options.groups.empty()) throw Error(ErrorCode::InvalidInput, "bricks have no groups of cells", "measure");
    MeasureOptions quiet = options;
    quiet.progress = nullptr;
    LimitMeasure all;
    const auto each_piece = [&](const char* stage, const auto& visit) {
        for_each_piece(source.stored(), stage, options.progress, [&](std::size_t number, const MeshPiece& piece) {
            const detail::LimitExtent extent = extent_of(source.stored(), piece.mesh);
            Measurer measurer(piece.mesh, piece.owned_cells, extent, quiet);
            visit(number, piece, measurer);
        });
    };
    each_piece("measure", [&](std::size_t number, const MeshPiece& piece, Measurer& measurer) {
        add(measurer.measure().front(), piece, number == 0, all.whole);
        all.pieces += measurer.pieces();
    });
    if (all.whole.volume != 0) all.whole.error /= std::abs(all.whole.volume);
    for (FieldMeasure& field : all.whole.fields) {
        field.mean = all.whole.volume != 0 ? field.integral / all.whole.volume : 0;
        field.histogram.assign(static_cast<std::size_t>(options.bins), 0);
    }
    each_piece("histogram", [&](std::size_t, const MeshPiece&, Measurer& measurer) { add_to_histograms(measurer, all.whole); });
    Measurer::scale_histograms(all.whole);
    return all;
}

}  // namespace

LimitMeasure measure_limit(const MeshSource& source, const MeasureOptions& options) {
    check_options(options);
    return source.mesh() != nullptr ? measure(*source.mesh(), options) : measure_pieces(source, options);
}

std::vector<Option> options_of(MeasureOptions& options) {
    constexpr double kLeast = 1e-100;
    return {Option("tolerance", options.tolerance)
                .between(kLeast, 1)
                .help("E", "of the volume as a part of it, of means and extremes as parts of each field's range"),
            Option("bins", options.bins).between(1, 100000).help("N", "intervals of the histogram")};
}

}  // namespace subvol
