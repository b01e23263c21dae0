// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolLimitLine_h
#define vtkSubvolLimitLine_h

#include <string>

#include "SubvolVtkModule.h"
#include "vtkPolyDataAlgorithm.h"

/// The fields of the limit along a line: `subvol probe --line`. The array arc_length has the distance from the first end.
/// Outside the limit values are not a number, and the array vtkValidPointMask is 0.
class SUBVOLVTK_EXPORT vtkSubvolLimitLine : public vtkPolyDataAlgorithm {
public:
    static vtkSubvolLimitLine* New();
    vtkTypeMacro(vtkSubvolLimitLine, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetVector3Macro(Point1, double);
    vtkGetVector3Macro(Point1, double);
    vtkSetVector3Macro(Point2, double);
    vtkGetVector3Macro(Point2, double);
    /// How many places on the line, its ends included.
    vtkSetMacro(Count, int);
    vtkGetMacro(Count, int);
    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    /// Also the gradient of each field, as NAME_gradient.
    vtkSetMacro(Gradients, bool);
    vtkGetMacro(Gradients, bool);

protected:
    vtkSubvolLimitLine() = default;
    ~vtkSubvolLimitLine() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolLimitLine(const vtkSubvolLimitLine&) = delete;
    void operator=(const vtkSubvolLimitLine&) = delete;

    double Point1[3]{0, 0, 0}, Point2[3]{1, 0, 0};
    int Count = 1000;
    std::string Scheme = "mcq";
    bool Gradients = false;
};

#endif
