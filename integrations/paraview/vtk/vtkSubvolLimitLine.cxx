// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolLimitLine.h"

#include <vtkCellArray.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <vector>

#include "grids.h"
#include "subvol/error.h"
#include "subvol/probe.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolLimitLine);

void vtkSubvolLimitLine::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Count: " << Count << '\n' << indent << "Scheme: " << Scheme << '\n';
}

int vtkSubvolLimitLine::FillInputPortInformation(int, vtkInformation* info) {
    take_cells(*info);
    return 1;
}

int vtkSubvolLimitLine::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataObject* const data = vtkDataObject::GetData(inputs[0]);
    if (!has_cells(data)) return 1;
    try {
        const Vec3 from(Point1[0], Point1[1], Point1[2]), to(Point2[0], Point2[1], Point2[2]);
        const std::vector<Vec3> places = places_on_line(from, to, static_cast<std::size_t>(std::max(Count, 0)));
        const HexMesh mesh = mesh_of_data(*data).mesh;
        ProbeOptions options;
        options.limit.scheme.kind = named<subvol::Scheme>(Scheme, "Scheme");
        const ProbeResult probed = probe_limit(mesh, places, options);
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> line;
        line->InsertNextCell(static_cast<int>(places.size()));
        std::vector<double> lengths;
        for (const Vec3& place : places) {
            line->InsertCellPoint(points->InsertNextPoint(&place.x));
            lengths.push_back(glm::length(place - from));
        }
        vtkPolyData& made = *vtkPolyData::GetData(outputs);
        made.SetPoints(points);
        made.SetLines(line);
        add_array(*made.GetPointData(), "arc_length", 1, lengths);
        add_probed(*made.GetPointData(), probed, Gradients);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
