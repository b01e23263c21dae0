// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/hex_mesh.h"
#include "subvol/limit_surface.h"
#include "subvol/read_options.h"

class vtkDataArray;
class vtkDataSetAttributes;
class vtkPolyData;
class vtkUnstructuredGrid;
class vtkUnstructuredGridBase;

namespace subvol {

/// One number of each tuple of an array. component: -1: the length of the tuple
struct ShownArray {
    vtkDataArray* array = nullptr;
    bool at_cells = false;
    int component = 0;
};

/// The mesh of a grid, with the value that is shown as its only field.
///
/// throws: subvol::Error as `mesh_of_vtk`
[[nodiscard]] ReadResult mesh_of_grid(vtkUnstructuredGridBase& grid, const ShownArray& shown);

/// The mesh of a grid with all of its arrays of numbers.
[[nodiscard]] ReadResult mesh_of_grid(vtkUnstructuredGridBase& grid);

/// Fills a grid with a mesh.
void set_grid(vtkUnstructuredGrid& grid, const HexMesh& mesh);

/// Appends a field. components: of each of its tuples
void add_array(vtkDataSetAttributes& to, const std::string& name, int components, std::span<const double> values);

/// Fills polygons with a surface: normals, and all fields.
void set_surface(vtkPolyData& polygons, const LimitSurface& surface);

}  // namespace subvol
