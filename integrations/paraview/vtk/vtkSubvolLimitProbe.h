// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolLimitProbe_h
#define vtkSubvolLimitProbe_h

#include <string>

#include "SubvolVtkModule.h"
#include "vtkDataSetAlgorithm.h"

/// The fields of the limit at the points of another data set: `subvol probe`. Port 0 has the places, port 1 the mesh. Outside
/// the limit values are not a number, and the array vtkValidPointMask is 0.
class SUBVOLVTK_EXPORT vtkSubvolLimitProbe : public vtkDataSetAlgorithm {
public:
    static vtkSubvolLimitProbe* New();
    vtkTypeMacro(vtkSubvolLimitProbe, vtkDataSetAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    void SetPlacesConnection(vtkAlgorithmOutput* places) { SetInputConnection(0, places); }
    void SetMeshConnection(vtkAlgorithmOutput* mesh) { SetInputConnection(1, mesh); }

    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    /// Places outside, at most this far from the boundary, get the values of its nearest point.
    vtkSetMacro(Reach, double);
    vtkGetMacro(Reach, double);
    /// Also the gradient of each field, as NAME_gradient.
    vtkSetMacro(Gradients, bool);
    vtkGetMacro(Gradients, bool);

protected:
    vtkSubvolLimitProbe();
    ~vtkSubvolLimitProbe() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolLimitProbe(const vtkSubvolLimitProbe&) = delete;
    void operator=(const vtkSubvolLimitProbe&) = delete;

    std::string Scheme = "mcq";
    double Reach = 0;
    bool Gradients = false;
};

#endif
