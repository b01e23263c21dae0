// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"

namespace subvol {

/// A corner of a cell of a mesh.
struct CellCorner {
    Index cell = kNone;  ///< kNone if there is no such corner
    std::uint8_t corner = 0;

    bool operator==(const CellCorner&) const = default;
};

/// Shells and beams: quads and lines that do not belong to a cell, beside a mesh of cells or alone. They have their own points,
/// so that the mesh does not depend on them.
struct Shells {
    std::vector<Vec3> points;
    std::vector<Attribute> attributes;        ///< those of the mesh, in its order, with values at these points
    std::vector<std::array<Index, 4>> quads;  ///< four points in cyclic order
    std::vector<std::array<Index, 2>> lines;  ///< two points
    /// For each point a corner of the mesh's cells if it is a point of the mesh too. Numbers of corners stay when unused points
    /// of the mesh are left out, and child k of cell c has the number 8c + k at the next level
    std::vector<CellCorner> solid;

    [[nodiscard]] bool empty() const { return quads.empty() && lines.empty(); }
};

/// Makes shells and beams of quads and lines over the points of a mesh, whether its cells use these points or not. Quads and
/// lines that occur twice are taken once.
///
/// returns: their points in the order of the mesh, with its attributes there
/// throws:  Error(InvalidInput) if a quad or a line has a point that does not exist, or one twice
[[nodiscard]] Shells make_shells(const HexMesh& mesh, std::span<const std::array<Index, 4>> quads,
                                 std::span<const std::array<Index, 2>> lines);

/// The sides of patches as shells, each patch with its own points, which are attached to the cells of this mesh: `limit_sides`
/// has them where they lie in its limit. The last attribute, "patch", counts the patches from 1.
///
/// throws: Error(InvalidInput) if a side is not of the mesh
[[nodiscard]] Shells patch_shells(const HexMesh& mesh, std::span<const Patch> patches);

/// throws: Error(InvalidInput) if a point of a quad or a line does not exist or occurs twice in it, a point is not finite, a
///         corner of a cell does not exist, or the attributes are not those of the mesh with one finite value for each point
void validate(const Shells& shells, const HexMesh& mesh);

/// How shells and beams are connected, for `subvol info`.
struct ShellReport {
    std::size_t quads = 0, lines = 0, points = 0;
    std::size_t attached = 0;           ///< points that are points of the mesh too
    std::size_t free_edges = 0;         ///< edges of one quad whose ends are not both attached
    std::size_t nonmanifold_edges = 0;  ///< edges of more than two quads
};
[[nodiscard]] ShellReport inspect(const Shells& shells);

}  // namespace subvol
