// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "subvol/topology.h"

namespace subvol::detail {

/// A structured grid that a mesh is: its cells, u fastest, and how each lies.
struct StructuredCells {
    std::array<std::size_t, 3> counts{};
    std::vector<Index> cells;
    /// For each corner of a cell in the grid's orientation, the corner as the mesh has it
    std::vector<std::array<std::uint8_t, 8>> corners;
};

/// Nothing if the mesh is not one block of nx × ny × nz cells.
[[nodiscard]] std::optional<StructuredCells> structured_cells(const Topology& topology);

/// One level up.
struct CoarserMesh {
    HexMesh mesh;
    std::vector<Index> points;                   ///< for each coarse point the finer point that it is
    std::vector<std::array<Index, 8>> children;  ///< for each coarse cell and each of its corners the finer cell there
    /// For each of these finer cells and each corner of a cell in the coarse cell's orientation, the corner as the finer cell
    /// has it
    std::vector<std::array<std::array<std::uint8_t, 8>, 8>> corners;
};

/// The mesh whose eightfold split has these cells. Nothing if there is none; then `why` says what is in the way.
[[nodiscard]] std::optional<CoarserMesh> coarser_mesh(const HexMesh& fine, std::string& why);

}  // namespace subvol::detail
