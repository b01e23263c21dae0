// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol {

/// A side of a cell, on the boundary of the mesh.
struct CellSide {
    Index cell = 0;
    std::uint8_t side = 0;  ///< 0 to 5 as in `kCellFaces`

    bool operator==(const CellSide&) const = default;
};

/// A named part of a mesh's boundary: a patch, a side set, a surface.
struct Patch {
    std::string name;
    std::vector<CellSide> sides;
};

/// A named set of a mesh's cells, ascending.
struct CellSet {
    std::string name;
    std::vector<Index> cells;
};

/// Corners of a cell.
struct CellCorners {
    Index cell = 0;
    std::uint8_t corners = 0;  ///< a bit for each corner, the lowest one for corner 0

    bool operator==(const CellCorners&) const = default;
};

/// A named set of a mesh's points, by the cells that have them at their corners: all such cells, ascending.
struct NodeSet {
    std::string name;
    std::vector<CellCorners> cells;
};

/// The named parts of a mesh. Patches and sets may have cells, sides and points in common.
struct MeshSets {
    std::vector<Patch> patches;
    std::vector<CellSet> sets;
    std::vector<NodeSet> nodes = {};

    [[nodiscard]] bool empty() const { return patches.empty() && sets.empty() && nodes.empty(); }
};

/// Checks that all sides and cells exist, each once in a patch or set, and that no two patches, sets of cells or sets of nodes
/// have one name.
///
/// throws: Error(InvalidInput)
void validate(const MeshSets& sets, const HexMesh& mesh);

/// "2 patches (in, out) and 1 set of cells (rotor)"; empty if there are none
[[nodiscard]] std::string list_of(const MeshSets& sets);

/// throws: Error(InvalidInput) if there is no patch of that name; lists those that exist
[[nodiscard]] const Patch& find_patch(const MeshSets& sets, std::string_view name);

/// throws: Error(InvalidInput) if there is no set of that name; lists those that exist
[[nodiscard]] const CellSet& find_set(const MeshSets& sets, std::string_view name);

/// throws: Error(InvalidInput) if there is no set of nodes of that name; lists those that exist
[[nodiscard]] const NodeSet& find_node_set(const MeshSets& sets, std::string_view name);

/// The points of a set of nodes, ascending.
[[nodiscard]] std::vector<Index> points_of(const HexMesh& mesh, const NodeSet& set);

/// The points as a set of nodes, by all cells that have one at a corner. Points that no cell has are left out.
///
/// throws: Error(InvalidInput) if a point does not exist
[[nodiscard]] NodeSet node_set_of(const HexMesh& mesh, std::string name, std::span<const Index> points);

/// The sides of the boundary all of whose corners are in a set of nodes, by cell and side, with the set's name.
[[nodiscard]] Patch boundary_of(const HexMesh& mesh, const NodeSet& set);

/// The sides of a set's cells that have no cell of the set beside them, by cell and side: its hull, with the set's name.
[[nodiscard]] Patch hull_of(const HexMesh& mesh, const CellSet& set);

/// The patches of these names, in their order; all that have sides for "all", the hull of a set of cells for "set:NAME" and
/// the sides between the points of a set of nodes for "nodes:NAME", unless a patch is called so.
///
/// throws: Error(InvalidInput) as `find_patch`, `find_set` and `find_node_set`, or if a named patch has no sides
[[nodiscard]] std::vector<Patch> chosen_patches(const HexMesh& mesh, const MeshSets& sets, std::span<const std::string> names);

/// The sets of a mesh of which some cells are left, in their order. Patches and sets that have lost all cells stay, empty.
///
/// kept: a flag for each cell
[[nodiscard]] MeshSets sets_of_cells(MeshSets sets, std::span<const std::uint8_t> kept);

/// The patches and sets of a mesh that is refined so often, as `refine` numbers its cells: the sides of children that lie on a
/// side of a patch, all children of a set's cells, and the new points on edges and faces and in cells all of whose corners are
/// in a set of nodes.
[[nodiscard]] MeshSets sets_of_children(MeshSets sets, int levels);

/// Where a cell lies that a cell was split into: in the cell `parent`, between lower and lower + size of its parameters, in
/// halves, quarters and so on.
struct PartOfCell {
    Index parent;
    Vec3 lower, size;
};

/// The patches and sets of a mesh whose cells were split: the sides of parts that lie on a side of a patch, all parts of a
/// set's cells, and points as `sets_of_children` has them.
///
/// parts: one for each new cell, whose orientation is that of its parent
[[nodiscard]] MeshSets sets_of_parts(MeshSets sets, std::span<const PartOfCell> parts);

/// The place on a side: s and t in [0,1], along the first and the last edge of the side's corners in `kCellFaces`.
[[nodiscard]] std::array<double, 3> place_on_side(std::uint8_t side, double s, double t);

}  // namespace subvol
