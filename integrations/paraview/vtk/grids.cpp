// SPDX-License-Identifier: Apache-2.0
#include "grids.h"

#include <vtkAlgorithm.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellIterator.h>
#include <vtkCharArray.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkVariant.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/error.h"
#include "subvol/vtk_grid.h"

namespace subvol {

namespace {

/// Creases, sharp faces and patches, as our files and `set_grid` have them. A hash among the numbers is exact only as a whole
/// number.
std::vector<VtkFieldArray> field_arrays_of(vtkDataSet& grid) {
    std::vector<VtkFieldArray> arrays;
    vtkFieldData& data = *grid.GetFieldData();
    for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
        vtkDataArray* const array = data.GetArray(a);
        if (array == nullptr || array->GetName() == nullptr || !is_vtk_field_array(array->GetName())) continue;
        std::vector<std::int64_t>& numbers = arrays.emplace_back(VtkFieldArray{array->GetName(), {}}).numbers;
        for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i) numbers.push_back(array->GetVariantValue(i).ToTypeInt64());
    }
    return arrays;
}

/// Points and cells, with creases, sharp faces and patches.
VtkUnstructuredGrid cells_of(vtkDataSet& grid) {
    VtkUnstructuredGrid made;
    made.field_arrays = field_arrays_of(grid);
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
    made.integers = array.GetDataType() != VTK_FLOAT && array.GetDataType() != VTK_DOUBLE;
    made.values.resize(static_cast<std::size_t>(array.GetNumberOfValues()));
    const auto tuple = static_cast<std::size_t>(made.components);
    for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i)
        array.GetTuple(i, made.values.data() + static_cast<std::size_t>(i) * tuple);
    return made;
}

void add_all(vtkDataSetAttributes& from, bool at_cells, VtkUnstructuredGrid& made) {
    for (int a = 0; a < from.GetNumberOfArrays(); ++a) {
        if (vtkDataArray* const array = from.GetArray(a)) made.arrays.push_back(whole_array(*array, at_cells));
    }
}

constexpr const char* kNumbers = "GlobalNodeId";  // the same for the same point of two blocks

void add_named(vtkDataSetAttributes& from, const char* name, bool at_cells, VtkUnstructuredGrid& made) {
    if (vtkDataArray* const array = from.GetArray(name)) made.arrays.push_back(whole_array(*array, at_cells));
}

vtkDataArray* array_in(vtkDataSet& grid, const ShownArray& shown) {
    vtkDataSetAttributes& from =
        shown.at_cells ? static_cast<vtkDataSetAttributes&>(*grid.GetCellData()) : *grid.GetPointData();
    return shown.name.empty() ? from.GetScalars() : from.GetArray(shown.name.c_str());
}

/// One number of each tuple.
void keep_component(VtkGridArray& array, int component) {
    if (component == ShownArray::kAll || array.components == 1) return;
    const auto components = static_cast<std::size_t>(array.components);
    const std::size_t tuples = array.values.size() / components;
    for (std::size_t i = 0; i < tuples; ++i) {
        const std::span<const double> tuple(array.values.data() + i * components, components);
        double squares = 0;
        for (const double v : tuple) squares += v * v;
        array.values[i] = component >= 0 ? tuple[static_cast<std::size_t>(component)] : std::sqrt(squares);
    }
    array.values.resize(tuples);
    array.components = 1;
}

std::vector<vtkDataSet*> blocks_of(vtkDataObject& data) {
    if (vtkDataSet* const one = vtkDataSet::SafeDownCast(&data)) return {one};
    std::vector<vtkDataSet*> blocks;
    if (vtkCompositeDataSet* const several = vtkCompositeDataSet::SafeDownCast(&data)) {
        const auto at = vtkSmartPointer<vtkCompositeDataIterator>::Take(several->NewIterator());
        for (at->InitTraversal(); !at->IsDoneWithTraversal(); at->GoToNextItem()) {
            vtkDataSet* const block = vtkDataSet::SafeDownCast(at->GetCurrentDataObject());
            if (block != nullptr && block->GetNumberOfCells() > 0) blocks.push_back(block);
        }
    }
    return blocks;
}

bool is_several(vtkDataObject& data) {
    return vtkCompositeDataSet::SafeDownCast(&data) != nullptr;
}

ReadResult mesh_of(std::vector<VtkUnstructuredGrid> blocks, bool several) {
    return several ? mesh_of_vtk(std::move(blocks)) : mesh_of_vtk(std::move(blocks.front()));
}

}  // namespace

void take_cells(vtkInformation& port) {
    port.Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    port.Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
}

bool has_cells(vtkDataObject* data) {
    if (data == nullptr) return false;
    return std::ranges::any_of(blocks_of(*data), [](vtkDataSet* block) { return block->GetNumberOfCells() > 0; });
}

ShownArray shown_array(vtkAlgorithm& filter) {
    vtkInformation* const chosen = filter.GetInputArrayInformation(0);
    if (!chosen->Has(vtkDataObject::FIELD_NAME())) return {.component = ShownArray::kLength};
    return {.name = chosen->Get(vtkDataObject::FIELD_NAME()),
            .at_cells = chosen->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS,
            .component = ShownArray::kLength};
}

ReadResult mesh_of_data(vtkDataObject& data, const ShownArray& shown) {
    const bool several = is_several(data), numbered = several && shown.name != kNumbers;
    std::vector<VtkUnstructuredGrid> blocks;
    for (vtkDataSet* const block : blocks_of(data)) {
        vtkDataArray* const array = array_in(*block, shown);
        if (array == nullptr) continue;
        VtkUnstructuredGrid& made = blocks.emplace_back(cells_of(*block));
        keep_component(made.arrays.emplace_back(whole_array(*array, shown.at_cells)), shown.component);
        add_named(*block->GetPointData(), vtkDataSetAttributes::GhostArrayName(), false, made);
        add_named(*block->GetCellData(), vtkDataSetAttributes::GhostArrayName(), true, made);
        if (numbered) add_named(*block->GetPointData(), kNumbers, false, made);
    }
    if (blocks.empty()) {
        throw Error(ErrorCode::InvalidInput,
                    shown.name.empty() ? "no array is chosen" : "there is no array '" + shown.name + "'", "Field");
    }
    ReadResult read = mesh_of(std::move(blocks), several);
    if (numbered) std::erase_if(read.mesh.attributes, [](const Attribute& field) { return field.name == kNumbers; });
    return read;
}

ReadResult mesh_of_data(vtkDataObject& data) {
    std::vector<VtkUnstructuredGrid> blocks;
    for (vtkDataSet* const block : blocks_of(data)) {
        VtkUnstructuredGrid& made = blocks.emplace_back(cells_of(*block));
        add_all(*block->GetPointData(), false, made);
        add_all(*block->GetCellData(), true, made);
    }
    if (blocks.empty()) throw Error(ErrorCode::InvalidInput, "there are no cells");
    return mesh_of(std::move(blocks), is_several(data));
}

void add_array(vtkDataSetAttributes& to, const std::string& name, int components, std::span<const double> values) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
    std::ranges::copy(values, array->GetPointer(0));
    to.AddArray(array);
}

void set_grid(vtkUnstructuredGrid& grid, const HexMesh& mesh, const MeshSets& sets) {
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
    for (const VtkFieldArray& field : vtk_field_arrays(mesh, sets)) {
        vtkNew<vtkTypeInt64Array> array;
        array->SetName(field.name.c_str());
        for (const std::int64_t number : field.numbers) array->InsertNextValue(number);
        grid.GetFieldData()->AddArray(array);
    }
    for (const CellSet& set : sets.sets) {
        vtkNew<vtkUnsignedCharArray> array;
        array->SetName(vtk_set_array(set).c_str());
        array->SetNumberOfValues(static_cast<vtkIdType>(mesh.cells.size()));
        array->FillValue(0);
        for (const Index c : set.cells) array->SetValue(static_cast<vtkIdType>(c), 1);
        grid.GetCellData()->AddArray(array);
    }
}

void add_probed(vtkDataSetAttributes& to, const ProbeResult& probed, bool gradients) {
    constexpr double kOutside = std::numeric_limits<double>::quiet_NaN();
    const std::size_t places = probed.cells.size();
    for (const ProbedField& field : probed.fields) {
        std::vector<double> values = field.values, slopes;
        for (std::size_t p = 0; p < places; ++p) {
            const auto first = values.begin() + static_cast<std::ptrdiff_t>(p * field.channels);
            if (!probed.inside(p)) std::fill(first, first + static_cast<std::ptrdiff_t>(field.channels), kOutside);
        }
        add_array(to, field.name, static_cast<int>(field.channels), values);
        if (!gradients) continue;
        for (std::size_t k = 0; k < field.gradients.size(); ++k) {
            for (int axis = 0; axis < 3; ++axis)
                slopes.push_back(probed.inside(k / field.channels) ? field.gradients[k][axis] : kOutside);
        }
        add_array(to, field.name + "_gradient", static_cast<int>(3 * field.channels), slopes);
    }
    vtkNew<vtkCharArray> inside;
    inside->SetName("vtkValidPointMask");
    for (std::size_t p = 0; p < places; ++p) inside->InsertNextValue(probed.inside(p) ? 1 : 0);
    to.AddArray(inside);
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
