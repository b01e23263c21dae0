// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolLimitSlice_h
#define vtkSubvolLimitSlice_h

#include <string>
#include <vector>

#include "SubvolVtkModule.h"
#include "vtkPolyDataAlgorithm.h"

/// A field of the limit where a plane cuts the volume, at a grid of places: `subvol slice`. The field is the array to process.
class SUBVOLVTK_EXPORT vtkSubvolLimitSlice : public vtkPolyDataAlgorithm {
public:
    static vtkSubvolLimitSlice* New();
    vtkTypeMacro(vtkSubvolLimitSlice, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetVector3Macro(Origin, double);
    vtkGetVector3Macro(Origin, double);
    vtkSetVector3Macro(Normal, double);
    vtkGetVector3Macro(Normal, double);
    vtkSetMacro(Resolution, int);
    vtkGetMacro(Resolution, int);
    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);

protected:
    vtkSubvolLimitSlice() = default;
    ~vtkSubvolLimitSlice() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolLimitSlice(const vtkSubvolLimitSlice&) = delete;
    void operator=(const vtkSubvolLimitSlice&) = delete;

    double Origin[3]{0, 0, 0}, Normal[3]{1, 0, 0};
    int Resolution = 512;
    std::string Scheme = "mcq";
};

#endif
