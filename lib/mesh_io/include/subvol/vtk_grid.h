// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/read_options.h"
#include "subvol/vec.h"

namespace subvol {

/// An array of a VTK grid. values: `components` for each point or cell
struct VtkGridArray {
    std::string name;
    int components = 1;
    bool at_cells = false;
    std::vector<double> values;
};

/// An unstructured grid as VTK has it in memory.
///
/// types:        VTK's number for the type of each cell
/// ends:         of each cell in `connectivity`
/// connectivity: the points of the cells, one cell after the other
/// faces:        of polyhedra, VTK's list: how many faces, then for each its number of points and the points; for each cell all
///               its faces, one cell after the other
/// face_ends:    of each cell in `faces`, that of the cell before for cells of other types; empty if there are no polyhedra
/// sharp:        the numbers of the field array `vtk_sharp_array()`; empty if there is none
struct VtkUnstructuredGrid {
    std::vector<Vec3> points;
    std::vector<std::uint8_t> types;
    std::vector<std::int64_t> ends, connectivity;
    std::vector<std::int64_t> faces{}, face_ends{};
    std::vector<VtkGridArray> arrays{};
    std::vector<std::int64_t> sharp{};
};

/// The name of the array of whole numbers in the field data of VTK's grids and files that has the creases and sharp faces of a
/// mesh.
[[nodiscard]] const char* vtk_sharp_array();
/// The numbers of this array; none if the mesh has neither creases nor sharp faces.
[[nodiscard]] std::vector<std::int64_t> vtk_sharp_numbers(const HexMesh& mesh);

/// The mesh that `read_mesh` makes of a `.vtu` file with this grid: tetrahedra, prisms, pyramids and polyhedra are split,
/// curved cells followed, ghost cells dropped, values at cells moved to the points, creases and sharp faces tagged; if `sharp`
/// is of another mesh, a warning says so.
///
/// throws: Error(InvalidInput) as `read_mesh`, or if the sizes of the arrays contradict each other or a point is not there
[[nodiscard]] ReadResult mesh_of_vtk(VtkUnstructuredGrid grid, const ReadOptions& options = {});

/// One mesh of several grids, as `read_mesh` makes it of a `.vtm` file that lists them: points are joined by an array
/// `GlobalNodeId` where all grids have it, else where two are at the same place; arrays that a grid lacks are left out, and
/// `sharp`. Grids without points are left out.
///
/// throws: Error(InvalidInput) as for one grid, or if no grid has cells
[[nodiscard]] ReadResult mesh_of_vtk(std::vector<VtkUnstructuredGrid> blocks, const ReadOptions& options = {});

}  // namespace subvol
