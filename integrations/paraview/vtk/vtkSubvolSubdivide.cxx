// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolSubdivide.h"

#include <vtkCellData.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkUnstructuredGrid.h>

#include <vector>

#include "grids.h"
#include "subvol/certificate.h"
#include "subvol/error.h"
#include "subvol/refine.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolSubdivide);

void vtkSubvolSubdivide::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Scheme: " << Scheme << '\n' << indent << "Levels: " << Levels << '\n';
}

int vtkSubvolSubdivide::FillInputPortInformation(int, vtkInformation* info) {
    take_cells(*info);
    return 1;
}

int vtkSubvolSubdivide::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataObject* const data = vtkDataObject::GetData(inputs[0]);
    if (!has_cells(data)) return 1;
    try {
        const SchemeOptions scheme{.kind = named<subvol::Scheme>(Scheme, "Scheme")};
        if (CheckFolds && Levels > 0)
            throw Error(ErrorCode::InvalidInput, "folds are those of level 0", "CheckFolds", "Levels 0");
        const ReadResult read = mesh_of_data(*data);
        const HexMesh& mesh = read.mesh;
        vtkUnstructuredGrid& fine = *vtkUnstructuredGrid::GetData(outputs);
        set_grid(fine, Levels > 0 ? refine(mesh, {.scheme = scheme, .levels = Levels}) : mesh,
                 sets_of_children(read.sets, Levels));
        if (!CheckFolds) return 1;
        const FoldCheck check = check_folds(mesh, {.scheme = scheme});
        std::vector<double> verdicts;
        for (const FoldVerdict verdict : check.verdicts) verdicts.push_back(static_cast<double>(verdict));
        add_array(*fine.GetCellData(), "fold", 1, verdicts);
        add_array(*fine.GetCellData(), "open", 1, check.open);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
