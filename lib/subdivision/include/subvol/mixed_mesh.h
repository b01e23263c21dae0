// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mixed_cells.h"

namespace subvol {

/// A control mesh of tetrahedra, with octahedra, prisms, pyramids and hexahedra where there are some.
///
/// All cells are right-handed; `make_mixed_mesh` makes them so.
struct MixedMesh {
    std::vector<Vec3> points;
    /// (p1−p0, p2−p0, p3−p0) is right-handed; the box spline joins the middles of the edges 0–1 and 2–3
    std::vector<std::array<Index, 4>> tets;
    /// Three pairs of opposite corners, +x −x +y −y +z −z; the box spline uses the diagonal 0–1
    std::vector<std::array<Index, 6>> octahedra;
    std::vector<std::array<Index, 6>> prisms;    ///< as in MixedCells
    std::vector<std::array<Index, 5>> pyramids;  ///< as in MixedCells
    std::vector<std::array<Index, 8>> hexes;
    std::vector<Attribute> attributes;
    /// Boundary edges to be kept sharp, besides those that the default rule finds; two point ids, smaller first
    std::vector<std::array<Index, 2>> creases;

    [[nodiscard]] std::size_t cells() const {
        return tets.size() + octahedra.size() + prisms.size() + pyramids.size() + hexes.size();
    }
};

/// Checks a mesh.
///
/// throws: Error(InvalidInput) if there is no cell, a corner is out of range or twice in a cell, a used point or a value
///         there is not finite, or an attribute has the wrong length; names the cell or point (counted from 0)
void validate(const MixedMesh& mesh);

/// A mixed mesh of the cells of a file: right-handed, without unused points. The corners of a tetrahedron are ordered by their
/// numbers a < b < c < d: the box spline joins the middles of ac and bd, as red refinement does [bey1995].
///
/// hexes:  may have no cells; its points are those of all cells, its creases are kept
/// throws: Error(InvalidInput) as `validate`, and if hexes has sharp faces
[[nodiscard]] MixedMesh make_mixed_mesh(const HexMesh& hexes, const MixedCells& others);

/// The mesh of which `split_into_hexes` made these hexahedra, as readers do: groups of 4, 6 or 8 that follow each other and
/// meet in the middle of their cell become a tetrahedron, a prism or a hexahedron again, with the values at its corners. If a
/// cell is in no such group, all are hexahedra as they are. Pyramids were cut into tetrahedra, which they stay. An edge both
/// halves of which are creases is a crease. Sharp faces, which these schemes do not have, are left out with their creases.
///
/// throws: as `make_mixed_mesh`, and Error(InvalidInput) if the mesh was split and has a crease that is not along such an edge
[[nodiscard]] MixedMesh join_split_cells(const HexMesh& split);

/// The mesh with every cell in tetrahedra: quads are cut along the diagonal from their smallest id, octahedra along the
/// shortest of their three diagonals (the first of those that are equally short).
[[nodiscard]] MixedMesh in_tetrahedra(MixedMesh mesh);

/// The mesh as hexahedra, in which values are linear in the tetrahedra up to the curvature of trilinear cells: octahedra are
/// cut into tetrahedra, then all cells are split by `split_into_hexes`. Creases are left out.
[[nodiscard]] HexMesh in_hexahedra(const MixedMesh& mesh);

struct MixedShape {
    /// Cells with a corner at which the edges are left-handed; octahedra with a part that is not right-handed
    std::size_t inverted = 0;
    /// The least of the volumes of the tetrahedra at the corners, divided by (root mean square edge)³ and scaled so that that
    /// of a regular tetrahedron is 1; of octahedra, prisms, pyramids and hexahedra so that theirs is 1
    double worst = 1;
    double volume = 0;
};
[[nodiscard]] MixedShape measure_cells(const MixedMesh& mesh);

}  // namespace subvol
