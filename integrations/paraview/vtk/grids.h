// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "subvol/hex_mesh.h"
#include "subvol/limit_surface.h"
#include "subvol/probe.h"
#include "subvol/read_options.h"

class vtkAlgorithm;
class vtkDataObject;
class vtkDataSetAttributes;
class vtkInformation;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace subvol {

/// Lets a port take data sets with cells of a volume, and several of them as blocks.
void take_cells(vtkInformation& port);

/// The array of a data set that is shown.
///
/// name:      empty: the active one
/// component: of each tuple; kLength: its length; kAll: all of them
struct ShownArray {
    static constexpr int kLength = -1, kAll = -2;

    std::string name;
    bool at_cells = false;
    int component = kAll;

    bool operator==(const ShownArray&) const = default;
};

/// Whether there is anything to do.
[[nodiscard]] bool has_cells(vtkDataObject* data);

/// What a filter is to process: the array that was chosen, of vectors their length.
[[nodiscard]] ShownArray shown_array(vtkAlgorithm& filter);

/// The mesh of a data set, with the array that is shown as its only field. Blocks become one mesh (`mesh_of_vtk`); those
/// that lack the array are left out.
///
/// throws: subvol::Error as `mesh_of_vtk`, or if the array is nowhere
[[nodiscard]] ReadResult mesh_of_data(vtkDataObject& data, const ShownArray& shown);

/// The mesh of a data set with all of its arrays of numbers; of blocks with those that all have.
[[nodiscard]] ReadResult mesh_of_data(vtkDataObject& data);

/// Fills a grid with a mesh. Its creases, sharp faces and patches are field arrays, its sets arrays at the cells, which
/// `mesh_of_data` takes again.
void set_grid(vtkUnstructuredGrid& grid, const HexMesh& mesh, const MeshSets& sets = {});

/// Appends a field. components: of each of its tuples
void add_array(vtkDataSetAttributes& to, const std::string& name, int components, std::span<const double> values);

/// Appends all fields at places, not a number outside, and which places are inside, as VTK's own probes do.
///
/// gradients: also NAME_gradient, by world position
void add_probed(vtkDataSetAttributes& to, const ProbeResult& probed, bool gradients);

/// Fills polygons with a surface: normals, and all fields.
void set_surface(vtkPolyData& polygons, const LimitSurface& surface);

}  // namespace subvol
