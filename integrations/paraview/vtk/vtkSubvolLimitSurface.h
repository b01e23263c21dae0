// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolLimitSurface_h
#define vtkSubvolLimitSurface_h

#include <string>
#include <vector>

#include "SubvolVtkModule.h"
#include "vtkPolyDataAlgorithm.h"

/// Isosurfaces of a field of the limit, and the boundary of the volume, as triangles with normals and the fields of the limit;
/// `subvol surface`. The field is the array to process.
class SUBVOLVTK_EXPORT vtkSubvolLimitSurface : public vtkPolyDataAlgorithm {
public:
    static vtkSubvolLimitSurface* New();
    vtkTypeMacro(vtkSubvolLimitSurface, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    vtkSetMacro(Boundary, bool);
    vtkGetMacro(Boundary, bool);
    vtkSetMacro(Cap, bool);
    vtkGetMacro(Cap, bool);
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    vtkSetMacro(MaxLevel, int);
    vtkGetMacro(MaxLevel, int);

    /// Isovalues one after the other, as ParaView sets them. Values that are not set stay as they are.
    void SetNumberOfIsovalues(int count);
    void SetIsovalue(int number, double value);

protected:
    vtkSubvolLimitSurface() = default;
    ~vtkSubvolLimitSurface() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolLimitSurface(const vtkSubvolLimitSurface&) = delete;
    void operator=(const vtkSubvolLimitSurface&) = delete;

    std::string Scheme = "mcq";
    std::vector<double> Isovalues;
    bool Boundary = true, Cap = false;
    double Tolerance = 1e-3;
    int MaxLevel = 6;
};

#endif
