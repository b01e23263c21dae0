// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "extreme_search.h"
#include "grid_measure.h"
#include "hanging_nodes.h"
#include "subvol/detail/cell_refiner.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/measure.h"
#include "sum_changes.h"

namespace subvol::detail {

/// Measures the limit of a mesh, or of the cells that a piece owns: sums and extremes first, then histograms over the range of
/// these.
class Measurer {
public:
    /// owned:  a flag for each cell that is measured, the others are a halo; none: all are
    /// extent: of the whole mesh
    Measurer(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& extent,
             const MeasureOptions& options);

    /// The whole, then the parts of the groups.
    std::vector<PartMeasure> measure();

    [[nodiscard]] std::size_t pieces() const { return pieces_; }

    /// Of what was measured.
    [[nodiscard]] SeenFolds folds() const;

    /// found: the whole, whose extremes are those of the histograms, and then the parts
    void add_histograms(std::vector<PartMeasure>& found);

    /// The volumes of a histogram sum up to that of the part, which is known better.
    static void scale_histograms(PartMeasure& part);

private:
    static constexpr std::size_t kBlock = 8192;  // cells: fixed, so that sums do not depend on the number of threads

    /// One channel of an attribute.
    struct Channel {
        std::string name;
        double origin;
        double scale;  ///< 1/range of the attribute, or 0 for a constant
        bool derived;
    };

    /// What the cells of a part sum up to.
    struct PartSums {
        std::vector<double> sums;  ///< the volume, then the integrals of the channels without their origins
        double left = 0;  ///< what is left of these sums, as a volume: that of an integral is divided by the channel's range
        std::vector<double> trilinear{};  ///< the sums of the cells before the first level
    };

    /// The notes of one cell of a block: what it adds to the sums, and by how much its own sums differ from those of the level
    /// before.
    struct CellNote {
        std::vector<double> sums, changes;
        std::vector<double> trilinear;  ///< its sums before the first level; empty at later ones
        std::vector<GridMeasure::Extreme> extremes;
        bool turned = false;  ///< the determinant is negative somewhere
    };

    /// Memory of one thread.
    struct Scratch {
        GridMeasure measure;
        std::vector<double> means;
        std::vector<Vec3> points;
    };

    [[nodiscard]] static std::vector<Channel> channels_of(const HexMesh& mesh, const LimitExtent& extent);
    [[nodiscard]] static std::vector<double> origins_of(const std::vector<Channel>& channels);
    [[nodiscard]] static std::vector<double> scales_of(const std::vector<Channel>& channels);
    [[nodiscard]] static std::size_t part_count(const MeasureOptions& options);

    [[nodiscard]] std::size_t part_of(Index cell) const { return options_.groups.empty() ? 0 : options_.groups[cell]; }

    /// The cells in the order in which they are worked on: neighbours in space, as their refinement shares what is around them.
    void list_cells(std::span<const std::uint8_t> owned);

    /// If the scheme interpolates, the limit is known to have the values of the control points; a constant has its own anyway.
    void start();

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
                CellRefiner::Tables::Common);
            for (std::size_t slot = 0; slot < block.size(); ++slot) collect(block[slot], first + slot, slot);
        }
    }

    /// How much of a level's changes is left depends on how well the mesh resolves its fields, by a factor of forty. A sample
    /// of the cells tells.
    void calibrate(std::span<const Index> cells, int level, Changes& changes);

    /// Measures cells at a level: adds their sums. Returns by how much these differ from those of the level before.
    [[nodiscard]] Changes run(std::span<const Index> cells, int level);

    [[nodiscard]] bool is_settled(std::size_t sum) const;
    /// Refines cells until some of the sums, from `first` to before `last`, are known well enough; the others are left alone.
    /// So the volume is the same whatever fields there are.
    ///
    /// changes: of level 1
    void refine_for(std::size_t first, std::size_t last, Changes changes);

    /// Learns from the cells of the level, or from a sample of them, which part of their changes is left.
    void learn(std::span<const Index> cells, int level, Changes& changes);

    [[nodiscard]] std::vector<std::uint32_t> by_change(std::span<const Index> cells, int level, const Changes& changes) const;

    void compare_with_neighbors(std::span<const Index> cells, Changes& changes);

    void note_cell(const DenseCell& grid, int level, CellNote& note);

    void note_sums(DenseCell grid, int level, CellNote& note);

    /// What a side sweeps, the cell beside it loses: it changes nothing but the volume at the hull.
    void leave_out_shared(const DenseCell& grid, std::vector<double>& changes);

    /// The levels of the cells beside one that is refined to a level. All cells at an edge are at both of its ends, so that the
    /// coarsest cells at these tell which level all of them have at least.
    [[nodiscard]] LevelsBeside levels_beside(Index cell, int level) const;

    /// Notes the level to which the sums of cells are known, and the coarsest at each point.
    void note_levels(std::span<const Index> cells, int level);

    void collect(Index cell, std::size_t number, double step, const CellNote& note);

    /// The cells that go on to the next level: those with candidates for extremes, and those of whose sums most is left. At
    /// most so many as cost about as much as the first level. What stays is added to what is left of the parts.
    ///
    /// for_fields: extremes are looked for, too
    std::vector<Index> choose(std::span<const Index> cells, Changes& changes, int level, bool for_fields);

    /// What is left of each part in the cells that are known to a level.
    [[nodiscard]] std::vector<Rest> rests_of(std::span<const Index> cells, int level, const Changes& changes) const;

    [[nodiscard]] double allowed(std::size_t part, int level) const;

    /// Whether nothing has to be refined for sums.
    [[nodiscard]] bool is_enough(std::span<const Index> cells, int level, const Changes& changes) const;

    void choose_for_sums(std::span<const Index> cells, Changes& changes, int level, std::size_t room,
                         std::vector<std::uint8_t>& chosen);

    /// The whole and the parts, without their extremes.
    [[nodiscard]] std::vector<PartMeasure> results() const;

    [[nodiscard]] PartMeasure result(const PartSums& part) const;

    [[nodiscard]] double box_volume() const;

    /// Adds the volumes of a cell to the counts, bin by bin, channel after channel.
    void count(const DenseCell& grid, const PartMeasure& whole, double unit, std::span<std::int64_t> counts);

    const MeasureOptions& options_;
    const LimitExtent& extent_;
    HexMesh control_;
    CellRefiner refiner_;
    std::vector<Channel> channels_;
    std::vector<double> scales_;  // of the volume and of the channels
    tbb::enumerable_thread_specific<Scratch> scratch_;
    bool has_fields_;                              // that are not constant
    std::vector<Index> cells_, slots_;             // that are measured; the place of each in its block
    std::vector<std::uint8_t> levels_, coarsest_;  // of the cells; the least at each point
    std::vector<std::uint8_t> is_candidate_;       // a flag for each cell: for an extreme
    std::optional<SampleOfChanges> sample_;        // of the level's cells, refined once more
    std::optional<Rest> gone_on_;                  // the changes of the cells that were refined further for their sums
    std::vector<PartSums> parts_;
    std::vector<CellNote> notes_;
    std::vector<Index> turned_;  // cells whose pieces have a negative determinant, perhaps several times
    ExtremeSearch extremes_;
    std::size_t pieces_ = 0;
};

}  // namespace subvol::detail
