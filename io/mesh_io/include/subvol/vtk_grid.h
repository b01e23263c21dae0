// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/read_options.h"
#include "subvol/vec.h"

namespace subvol {

/// An array of a VTK grid.
struct VtkGridArray {
    std::string name;
    int components = 1;
    bool at_cells = false;
    std::vector<double> values;  ///< `components` for each point or cell
    bool integers = false;       ///< the type of the values in the grid is one of integers
};

/// An array of whole numbers in the field data of a VTK grid.
struct VtkFieldArray {
    std::string name;
    std::vector<std::int64_t> numbers;
};

/// An unstructured grid as VTK has it in memory.
struct VtkUnstructuredGrid {
    std::vector<Vec3> points;
    std::vector<std::uint8_t> types;         ///< VTK's number for the type of each cell
    std::vector<std::int64_t> ends;          ///< end of each cell in `connectivity`
    std::vector<std::int64_t> connectivity;  ///< the points of the cells, one cell after the other
    /// VTK's list of the faces of polyhedra: how many faces, then for each its number of points and the points; for each cell
    /// all its faces, one cell after the other
    std::vector<std::int64_t> faces{};
    /// End of each cell in `faces`; that of the cell before for cells of other types; empty if there are no polyhedra
    std::vector<std::int64_t> face_ends{};
    std::vector<VtkGridArray> arrays{};
    /// Arrays of the field data whose names are `is_vtk_field_array`; others are not looked at
    std::vector<VtkFieldArray> field_arrays{};
};

/// Whether an array in the field data of VTK's grids and files has the creases and sharp faces or a patch of a mesh:
/// `SubvolSharp`, or `patch:` with the name of the patch.
[[nodiscard]] bool is_vtk_field_array(std::string_view name);
/// The arrays of a mesh; none if it has neither creases, sharp faces nor patches.
[[nodiscard]] std::vector<VtkFieldArray> vtk_field_arrays(const HexMesh& mesh, const MeshSets& sets = {});
/// The name of the array at the cells that is 1 in those of a set and 0 in the others: `set:` with the name of the set.
[[nodiscard]] std::string vtk_set_array(const CellSet& set);
/// The name of the array at points that has 1 at those of a set of nodes.
[[nodiscard]] std::string vtk_node_array(const NodeSet& set);

/// The mesh that `read_mesh` makes of a `.vtu` file with this grid: tetrahedra, prisms, pyramids and polyhedra are split,
/// curved cells followed, ghost cells dropped, values at cells moved to the points, creases, sharp faces, patches and sets of
/// cells found. Warnings name the arrays of field data that are of another mesh.
///
/// throws: Error(InvalidInput) as `read_mesh`, or if the sizes of the arrays contradict each other or a point is not there
[[nodiscard]] ReadResult mesh_of_vtk(VtkUnstructuredGrid grid, const ReadOptions& options = {});

/// One mesh of several grids, as `read_mesh` makes it of a `.vtm` file that lists them: points are joined by an array
/// `GlobalNodeId` where all grids have it, else where two are at the same place; arrays that a grid lacks are left out, and
/// `field_arrays`. Grids without points are left out.
///
/// throws: Error(InvalidInput) as for one grid, or if no grid has cells
[[nodiscard]] ReadResult mesh_of_vtk(std::vector<VtkUnstructuredGrid> blocks, const ReadOptions& options = {});

}  // namespace subvol
