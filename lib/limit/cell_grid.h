// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/dense_cells.h"

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

}  // namespace subvol::detail
