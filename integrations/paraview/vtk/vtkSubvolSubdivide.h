// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolSubdivide_h
#define vtkSubvolSubdivide_h

#include <string>
#include <vector>

#include "SubvolVtkModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

/// The refined mesh of a level, all cells hexahedra: `subvol subdivide`. With the check of folds the cells say, too, what is
/// known of the limit: 0 it is proved not to fold, 1 folded, 2 open, 3 irregular; `subvol check`.
class SUBVOLVTK_EXPORT vtkSubvolSubdivide : public vtkUnstructuredGridAlgorithm {
public:
    static vtkSubvolSubdivide* New();
    vtkTypeMacro(vtkSubvolSubdivide, vtkUnstructuredGridAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    vtkSetMacro(Levels, int);
    vtkGetMacro(Levels, int);
    /// With level 0 alone, as folds are those of the control mesh.
    vtkSetMacro(CheckFolds, bool);
    vtkGetMacro(CheckFolds, bool);

protected:
    vtkSubvolSubdivide() = default;
    ~vtkSubvolSubdivide() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolSubdivide(const vtkSubvolSubdivide&) = delete;
    void operator=(const vtkSubvolSubdivide&) = delete;

    std::string Scheme = "mcq";
    int Levels = 1;
    bool CheckFolds = false;
};

#endif
