// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolLimitSurface.h"

#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

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
    take_cells(*info);
    return 1;
}

int vtkSubvolLimitSurface::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataObject* const data = vtkDataObject::GetData(inputs[0]);
    if (!has_cells(data)) return 1;
    try {
        const SurfaceOptions options{.scheme = {.kind = named<subvol::Scheme>(Scheme, "Scheme")},
                                     .isos = Isovalues,
                                     .boundary = Boundary,
                                     .cap = Cap,
                                     .tolerance = Tolerance,
                                     .max_level = MaxLevel};
        const std::string field = Isovalues.empty() ? std::string() : shown_array(*this).name;
        const HexMesh mesh = mesh_of_data(*data).mesh;
        set_surface(*vtkPolyData::GetData(outputs), limit_surface(mesh, field, options));
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
