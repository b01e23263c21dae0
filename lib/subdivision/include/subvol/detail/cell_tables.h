// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/cache_aligned_allocator.h>
#include <tbb/enumerable_thread_specific.h>

#include <span>
#include <vector>

#include "subvol/dense_cells.h"
#include "subvol/detail/class_tables.h"

namespace subvol::detail {

/// The vertices of one cell's refinement, with the values of all attributes: as DenseCell, with memory of its own.
struct CellGrid {
    std::vector<Vec3> points;
    std::vector<std::vector<double>> values;

    /// Makes room for nodes with the attributes of a mesh.
    void resize(const HexMesh& mesh, std::size_t nodes);

    /// Node `node` from a point of a mesh.
    void take(const HexMesh& mesh, std::size_t node, Index point);

    /// Takes the grid of a child. Children share nodes on the planes between them: a child gives those of its lower sides, and
    /// at the cell's own upper sides the upper ones too.
    ///
    /// half: steps along an axis of the child's grid
    void take_child(const CellGrid& part, std::size_t child, std::size_t half);

    /// The same as a view.
    [[nodiscard]] DenseCell dense_cell(Index cell, int levels) const;
};

/// A cell with the class of its neighbourhood, whose points are points[0 .. point_count).
struct Member {
    ClassKey key;
    Index cell = 0;
    std::uint16_t point_count = 0;
    std::uint8_t turn = kIdentityTurn;
    const Index* points = nullptr;
};

constexpr ClassKey kNoClass{~std::uint64_t{0}, ~std::uint64_t{0}};

/// One mesh whose cells are refined: the control mesh, or a patch of a level of it.
struct RefinedLevel {
    explicit RefinedLevel(const HexMesh& refined)
        : mesh(refined), links(build_links(refined)), walks([this] { return NeighborhoodWalk(mesh, links); }) {}
    const HexMesh& mesh;
    CellLinks links;
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
};

/// Cells with their classes, and the memory of their points.
struct Classified {
    std::vector<Member> members;
    std::vector<std::vector<Index>> points;
};

constexpr int kWhole = 2;  // so many levels are refined as they are, without classes of children

/// The cells in their order with their classes, kNoClass where a class has too few members for a table.
///
/// layers:  how many layers around a cell its refinement by `levels` levels depends on
/// regular: the key of regular cells, with so many layers
/// whole:   up to so many levels only regular cells have a class
[[nodiscard]] Classified classify(RefinedLevel& level, std::span<const Index> cells, int levels, int layers,
                                  const ClassKey& regular, int whole = kWhole);

/// Takes the class from members that are too few of a kind for a table.
void drop_rare(std::vector<Member>& members, int levels);

/// Values of kTableLanes cells of one class: channel by channel, point by point, cell by cell.
class LaneValues {
public:
    /// The points that the table uses.
    void load(const HexMesh& mesh, std::span<const Member> cells, const WeightTable& table);
    void apply(const WeightTable& table);

    /// What row `row` of one cell is of the points.
    [[nodiscard]] Vec3 position(std::size_t lane, std::size_t row) const {
        const double* const x = &out_[row * kTableLanes + lane];
        return {x[0], x[rows_ * kTableLanes], x[2 * rows_ * kTableLanes]};
    }

    /// The rows of one cell as its grid. turn: from the axes of the rows to those of the cell
    void store(std::size_t lane, std::size_t side, std::uint8_t turn, CellGrid& grid) const;

private:
    template <class T>
    using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;
    std::size_t channels_ = 0, stride_ = 0, rows_ = 0;
    Aligned<double> in_, out_;
};

}  // namespace subvol::detail
