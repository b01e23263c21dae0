// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolVdbWriter_h
#define vtkSubvolVdbWriter_h

#include <string>
#include <vector>

#include "SubvolVtkModule.h"
#include "vtkWriter.h"

/// Writes the limit of a grid as an OpenVDB file, one grid for each array: `subvol vdb`.
class SUBVOLVTK_EXPORT vtkSubvolVdbWriter : public vtkWriter {
public:
    static vtkSubvolVdbWriter* New();
    vtkTypeMacro(vtkSubvolVdbWriter, vtkWriter);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetMacro(FileName, std::string);
    vtkGetMacro(FileName, std::string);
    /// Voxels along the longest side.
    vtkSetMacro(Resolution, int);
    vtkGetMacro(Resolution, int);
    vtkSetMacro(HalfFloats, bool);
    vtkGetMacro(HalfFloats, bool);
    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    /// An array that is written; none: all.
    void AddArray(const char* name);
    void ClearArrays();

protected:
    vtkSubvolVdbWriter() = default;
    ~vtkSubvolVdbWriter() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    void WriteData() override;

private:
    vtkSubvolVdbWriter(const vtkSubvolVdbWriter&) = delete;
    void operator=(const vtkSubvolVdbWriter&) = delete;

    std::string FileName, Scheme = "mcq";
    std::vector<std::string> Arrays;
    int Resolution = 200;
    bool HalfFloats = false;
};

#endif
