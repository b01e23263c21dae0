// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolLimitSlice.h"

#include <vtkCellArray.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <cmath>
#include <vector>

#include "grids.h"
#include "subvol/error.h"
#include "subvol/limit_slice.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolLimitSlice);

void vtkSubvolLimitSlice::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Resolution: " << Resolution << '\n' << indent << "Scheme: " << Scheme << '\n';
}

int vtkSubvolLimitSlice::FillInputPortInformation(int, vtkInformation* info) {
    take_cells(*info);
    return 1;
}

namespace {

/// The places inside as points, and the squares between four of them.
void set_slice(vtkPolyData& polygons, const LimitSlice& slice) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    std::vector<double> values;
    std::vector<vtkIdType> numbers(slice.values.size(), -1);
    for (std::size_t i = 0; i < slice.values.size(); ++i) {
        if (std::isnan(slice.values[i])) continue;
        const auto width = static_cast<std::size_t>(slice.width);
        const Vec3 place = slice.place(static_cast<double>(i % width), static_cast<double>(i / width));
        numbers[i] = points->InsertNextPoint(&place.x);
        values.push_back(slice.values[i]);
    }
    vtkNew<vtkCellArray> squares;
    for (int y = 0; y + 1 < slice.height; ++y) {
        for (int x = 0; x + 1 < slice.width; ++x) {
            const auto at = [&](int column, int row) { return numbers[static_cast<std::size_t>(row * slice.width + column)]; };
            const vtkIdType corners[4]{at(x, y), at(x, y + 1), at(x + 1, y + 1), at(x + 1, y)};
            if (corners[0] >= 0 && corners[1] >= 0 && corners[2] >= 0 && corners[3] >= 0) squares->InsertNextCell(4, corners);
        }
    }
    polygons.SetPoints(points);
    polygons.SetPolys(squares);
    add_array(*polygons.GetPointData(), slice.field, 1, values);
}

}  // namespace

int vtkSubvolLimitSlice::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataObject* const data = vtkDataObject::GetData(inputs[0]);
    if (!has_cells(data)) return 1;
    try {
        SliceOptions options{.resolution = Resolution};
        options.limit.scheme.kind = named<subvol::Scheme>(Scheme, "Scheme");
        const HexMesh mesh = mesh_of_data(*data, shown_array(*this)).mesh;
        const Vec3 point(Origin[0], Origin[1], Origin[2]), normal(Normal[0], Normal[1], Normal[2]);
        set_slice(*vtkPolyData::GetData(outputs), slice_limit(mesh, {}, point, normal, options));
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
