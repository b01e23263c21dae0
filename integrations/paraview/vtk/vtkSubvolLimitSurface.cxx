// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolLimitSurface.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGridBase.h>

#include "grids.h"
#include "subvol/error.h"
#include "subvol/limit_surface.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolLimitSurface);

void vtkSubvolLimitSurface::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Scheme: " << Scheme << '\n' << indent << "Boundary: " << Boundary << '\n';
    for (const double value : Isovalues) os << indent << "Isovalue: " << value << '\n';
}

void vtkSubvolLimitSurface::SetNumberOfIsovalues(int count) {
    Isovalues.resize(static_cast<std::size_t>(count));
    Modified();
}

void vtkSubvolLimitSurface::SetIsovalue(int number, double value) {
    if (number >= static_cast<int>(Isovalues.size())) Isovalues.resize(static_cast<std::size_t>(number) + 1);
    Isovalues[static_cast<std::size_t>(number)] = value;
    Modified();
}

int vtkSubvolLimitSurface::FillInputPortInformation(int, vtkInformation* info) {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGridBase");
    return 1;
}

int vtkSubvolLimitSurface::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkUnstructuredGridBase* const grid = vtkUnstructuredGridBase::GetData(inputs[0]);
    if (grid->GetNumberOfCells() == 0) return 1;
    try {
        const SurfaceOptions options{.scheme = {.kind = named<subvol::Scheme>(Scheme, "Scheme")},
                                     .isos = Isovalues,
                                     .boundary = Boundary,
                                     .cap = Cap,
                                     .tolerance = Tolerance,
                                     .max_level = MaxLevel};
        std::string field;
        if (!Isovalues.empty()) {
            vtkDataArray* const array = GetInputArrayToProcess(0, grid);
            if (array == nullptr || array->GetName() == nullptr)
                throw Error(ErrorCode::InvalidInput, "no array is chosen for the isosurfaces");
            field = array->GetName();
        }
        const HexMesh mesh = mesh_of_grid(*grid).mesh;
        set_surface(*vtkPolyData::GetData(outputs), limit_surface(mesh, field, options));
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
