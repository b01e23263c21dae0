// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolRepresentation.h"

#include <vtkAlgorithmOutput.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMath.h>
#include <vtkMatrix4x4.h>
#include <vtkObjectFactory.h>
#include <vtkPVRenderView.h>
#include <vtkPVView.h>
#include <vtkRenderer.h>
#include <vtkUnstructuredGrid.h>

#include "../../vtk/grids.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolRepresentation);

vtkSubvolRepresentation::vtkSubvolRepresentation() {
    Actor->SetMapper(Mapper);
}

void vtkSubvolRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "InteractiveReduction: " << InteractiveReduction << '\n';
}

int vtkSubvolRepresentation::FillInputPortInformation(int, vtkInformation* info) {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGridBase");
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
}

int vtkSubvolRepresentation::RequestData(vtkInformation* request, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    vtkMath::UninitializeBounds(DataBounds);
    vtkNew<vtkUnstructuredGrid> cells;
    Joined = false;
    if (inputs[0]->GetNumberOfInformationObjects() == 1) {
        vtkDataObject* const data = vtkDataObject::GetData(inputs[0]);
        if (vtkUnstructuredGrid* const input = vtkUnstructuredGrid::SafeDownCast(data)) {
            cells->ShallowCopy(input);
        } else if (has_cells(data)) {
            Joined = true;
            try {
                ShownArray shown = shown_array(*this);
                shown.component = ShownArray::kAll;
                set_grid(*cells, mesh_of_data(*data, shown).mesh);
            } catch (const std::exception& error) {
                vtkErrorMacro(<< error.what());
            }
        }
        if (cells->GetNumberOfCells() > 0) cells->GetBounds(DataBounds);
    }
    Cells = cells;
    return Superclass::RequestData(request, inputs, outputs);
}

void vtkSubvolRepresentation::SetInputArrayToProcess(int index, int port, int connection, int association, const char* name) {
    Superclass::SetInputArrayToProcess(index, port, connection, association, name);
    if (Joined) MarkModified();
}

int vtkSubvolRepresentation::ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) {
    if (!Superclass::ProcessViewRequest(request, in, out)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE()) {
        out->Set(vtkPVRenderView::NEED_ORDERED_COMPOSITING(), 1);
        vtkPVRenderView::SetPiece(in, this, Cells);
        vtkPVRenderView::SetOrderedCompositingConfiguration(
            in, this, vtkPVRenderView::DATA_IS_REDISTRIBUTABLE | vtkPVRenderView::USE_DATA_FOR_LOAD_BALANCING);
        vtkPVRenderView::SetRedistributionModeToUniquelyAssignBoundaryCells(in, this);
        vtkPVRenderView::SetRequiresDistributedRendering(in, this, true);
        vtkNew<vtkMatrix4x4> matrix;
        Actor->GetMatrix(matrix);
        vtkPVRenderView::SetGeometryBounds(in, this, DataBounds, matrix);
    } else if (request == vtkPVView::REQUEST_UPDATE_LOD()) {
        vtkPVRenderView::SetRequiresDistributedRenderingLOD(in, this, true);
    } else if (request == vtkPVView::REQUEST_RENDER()) {
        Mapper->SetReduction(in->Has(vtkPVRenderView::USE_LOD()) ? InteractiveReduction : 1);
        Mapper->SetInputConnection(vtkPVRenderView::GetPieceProducer(in, this));
        ChooseArray();
    }
    return 1;
}

void vtkSubvolRepresentation::ChooseArray() {
    vtkInformation* const array = GetInputArrayInformation(0);
    const bool chosen = array != nullptr && array->Has(vtkDataObject::FIELD_NAME());
    const bool at_cells =
        chosen && !Joined && array->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    Mapper->SetScalarMode(at_cells ? VTK_SCALAR_MODE_USE_CELL_FIELD_DATA : VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
    Mapper->SelectScalarArray(chosen ? array->Get(vtkDataObject::FIELD_NAME()) : "");
}

bool vtkSubvolRepresentation::AddToView(vtkView* view) {
    vtkPVRenderView* const rendered = vtkPVRenderView::SafeDownCast(view);
    if (rendered == nullptr) return false;
    rendered->GetRenderer()->AddActor(Actor);
    return Superclass::AddToView(view);
}

bool vtkSubvolRepresentation::RemoveFromView(vtkView* view) {
    vtkPVRenderView* const rendered = vtkPVRenderView::SafeDownCast(view);
    if (rendered == nullptr) return false;
    rendered->GetRenderer()->RemoveActor(Actor);
    return Superclass::RemoveFromView(view);
}
