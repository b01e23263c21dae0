// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/mixed_cells.h"

namespace subvol::detail {

/// The sharp edges of a mesh of hexahedra and other cells, by the rule of `keep_sharp_edges`: the smaller point first, in the
/// order of the points. A facet is a quad or a triangle, as the file has it.
struct FoundSharpEdges {
    std::vector<std::array<Index, 2>> edges;
    bool steps = false;                                 ///< as in SharpEdges
    std::vector<std::array<Index, 2>> edges_between{};  ///< sharp edges of the faces between parts; a corner of a grid is none
    /// All of those faces that an interface with a sharp edge has; a triangle repeats its last corner
    std::vector<std::array<Index, 4>> faces_between{};
};

/// Whether sharp edges of a single cell, which are creases without a tag, get one: as they need where cells are cut into
/// several.
enum class SingleCells { Leave, Tag };

/// others: of either handedness
/// parts:  a number for each cell, counted through the hexahedra, tetrahedra, prisms and pyramids; empty: all are one part
[[nodiscard]] FoundSharpEdges find_sharp_edges(std::span<const Vec3> points, std::span<const std::array<Index, 8>> hexes,
                                               const MixedCells& others, std::span<const Index> parts = {},
                                               SingleCells single = SingleCells::Leave);

}  // namespace subvol::detail
