// SPDX-License-Identifier: Apache-2.0
#include "grids.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellIterator.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "subvol/vtk_grid.h"

namespace subvol {

namespace {

/// Points and cells, and what marks ghosts.
VtkUnstructuredGrid cells_of(vtkUnstructuredGridBase& grid) {
    VtkUnstructuredGrid made;
    made.points.resize(static_cast<std::size_t>(grid.GetNumberOfPoints()));
    for (std::size_t p = 0; p < made.points.size(); ++p) {
        double x[3];
        grid.GetPoint(static_cast<vtkIdType>(p), x);
        made.points[p] = {x[0], x[1], x[2]};
    }
    bool polyhedra = false;
    const auto cell = vtkSmartPointer<vtkCellIterator>::Take(grid.NewCellIterator());
    for (cell->InitTraversal(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
        vtkIdList& points = *cell->GetPointIds();
        made.types.push_back(static_cast<std::uint8_t>(cell->GetCellType()));
        made.connectivity.insert(made.connectivity.end(), points.begin(), points.end());
        made.ends.push_back(static_cast<std::int64_t>(made.connectivity.size()));
        if (cell->GetCellType() == VTK_POLYHEDRON) {
            polyhedra = true;
            vtkIdList& faces = *cell->GetFaces();
            made.faces.insert(made.faces.end(), faces.begin(), faces.end());
        }
        made.face_ends.push_back(static_cast<std::int64_t>(made.faces.size()));
    }
    if (!polyhedra) made.face_ends.clear();
    return made;
}

VtkGridArray whole_array(vtkDataArray& array, bool at_cells) {
    VtkGridArray made{array.GetName() != nullptr ? array.GetName() : "unnamed", array.GetNumberOfComponents(), at_cells, {}};
    made.values.resize(static_cast<std::size_t>(array.GetNumberOfValues()));
    const auto tuple = static_cast<std::size_t>(made.components);
    for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i)
        array.GetTuple(i, made.values.data() + static_cast<std::size_t>(i) * tuple);
    return made;
}

void add_ghosts(vtkUnstructuredGridBase& grid, VtkUnstructuredGrid& made) {
    const auto add = [&](vtkDataSetAttributes& from, bool at_cells) {
        if (vtkDataArray* const ghosts = from.GetArray(vtkDataSetAttributes::GhostArrayName()))
            made.arrays.push_back(whole_array(*ghosts, at_cells));
    };
    add(*grid.GetPointData(), false);
    add(*grid.GetCellData(), true);
}

}  // namespace

ReadResult mesh_of_grid(vtkUnstructuredGridBase& grid, const ShownArray& shown) {
    VtkUnstructuredGrid made = cells_of(grid);
    VtkGridArray values = whole_array(*shown.array, shown.at_cells);
    const auto components = static_cast<std::size_t>(values.components);
    for (std::size_t i = 0; i < values.values.size() / components; ++i) {
        const std::span<const double> tuple(values.values.data() + i * components, components);
        double squares = 0;
        for (const double v : tuple) squares += v * v;
        values.values[i] = shown.component >= 0 ? tuple[static_cast<std::size_t>(shown.component)] : std::sqrt(squares);
    }
    values.values.resize(values.values.size() / components);
    values.components = 1;
    made.arrays.push_back(std::move(values));
    add_ghosts(grid, made);
    return mesh_of_vtk(std::move(made));
}

ReadResult mesh_of_grid(vtkUnstructuredGridBase& grid) {
    VtkUnstructuredGrid made = cells_of(grid);
    const auto add = [&](vtkDataSetAttributes& from, bool at_cells) {
        for (int a = 0; a < from.GetNumberOfArrays(); ++a) {
            if (vtkDataArray* const array = from.GetArray(a)) made.arrays.push_back(whole_array(*array, at_cells));
        }
    };
    add(*grid.GetPointData(), false);
    add(*grid.GetCellData(), true);
    return mesh_of_vtk(std::move(made));
}

void add_array(vtkDataSetAttributes& to, const std::string& name, int components, std::span<const double> values) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
    std::ranges::copy(values, array->GetPointer(0));
    to.AddArray(array);
}

void set_grid(vtkUnstructuredGrid& grid, const HexMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points.size()));
    for (std::size_t p = 0; p < mesh.points.size(); ++p) points->SetPoint(static_cast<vtkIdType>(p), &mesh.points[p].x);
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact(static_cast<vtkIdType>(mesh.cells.size()), static_cast<vtkIdType>(8 * mesh.cells.size()));
    for (const auto& cell : mesh.cells) {
        vtkIdType corners[8];
        std::ranges::copy(cell, corners);
        cells->InsertNextCell(8, corners);
    }
    grid.SetPoints(points);
    grid.SetCells(VTK_HEXAHEDRON, cells);
    for (const Attribute& field : mesh.attributes)
        add_array(*grid.GetPointData(), field.name, static_cast<int>(field.channels), field.values);
}

void set_surface(vtkPolyData& polygons, const LimitSurface& surface) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& p : surface.surface.points) points->InsertNextPoint(p.x, p.y, p.z);
    vtkNew<vtkCellArray> triangles;
    for (const auto& triangle : surface.surface.triangles) {
        vtkIdType corners[3];
        std::ranges::copy(triangle, corners);
        triangles->InsertNextCell(3, corners);
    }
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    for (const Vec3& n : surface.normals) normals->InsertNextTuple3(n.x, n.y, n.z);
    polygons.SetPoints(points);
    polygons.SetPolys(triangles);
    polygons.GetPointData()->SetNormals(normals);
    for (const ProbedField& field : surface.fields)
        add_array(*polygons.GetPointData(), field.name, static_cast<int>(field.channels), field.values);
}

}  // namespace subvol
