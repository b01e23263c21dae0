// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolLimitProbe.h"

#include <vtkDataSet.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>

#include <vector>

#include "grids.h"
#include "subvol/error.h"
#include "subvol/probe.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolLimitProbe);

vtkSubvolLimitProbe::vtkSubvolLimitProbe() {
    SetNumberOfInputPorts(2);
}

void vtkSubvolLimitProbe::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Scheme: " << Scheme << '\n' << indent << "Reach: " << Reach << '\n';
}

int vtkSubvolLimitProbe::FillInputPortInformation(int port, vtkInformation* info) {
    if (port == 1)
        take_cells(*info);
    else
        info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    return 1;
}

int vtkSubvolLimitProbe::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataSet& places = *vtkDataSet::GetData(inputs[0]);
    vtkDataObject* const data = vtkDataObject::GetData(inputs[1]);
    vtkDataSet& probed = *vtkDataSet::GetData(outputs);
    probed.CopyStructure(&places);
    if (places.GetNumberOfPoints() == 0 || !has_cells(data)) return 1;
    try {
        std::vector<Vec3> points(static_cast<std::size_t>(places.GetNumberOfPoints()));
        for (std::size_t p = 0; p < points.size(); ++p) places.GetPoint(static_cast<vtkIdType>(p), &points[p].x);
        const HexMesh mesh = mesh_of_data(*data).mesh;
        ProbeOptions options{.reach_world = Reach};
        options.limit.scheme.kind = named<subvol::Scheme>(Scheme, "Scheme");
        add_probed(*probed.GetPointData(), probe_limit(mesh, points, options), Gradients);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
