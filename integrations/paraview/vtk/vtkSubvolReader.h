// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolReader_h
#define vtkSubvolReader_h

#include <string>

#include "SubvolVtkModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

/// Reads a mesh of any format that `subvol` reads, as the hexahedra that it makes of it, with its steps.
class SUBVOLVTK_EXPORT vtkSubvolReader : public vtkUnstructuredGridAlgorithm {
public:
    static vtkSubvolReader* New();
    vtkTypeMacro(vtkSubvolReader, vtkUnstructuredGridAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetMacro(FileName, std::string);
    vtkGetMacro(FileName, std::string);
    /// Options of reading by their names in Python: "other_cells=ignore weld=0".
    vtkSetMacro(Options, std::string);
    vtkGetMacro(Options, std::string);

    /// Whether the first bytes and the extension are those of such a file.
    static int CanReadFile(const char* name);

protected:
    vtkSubvolReader();
    ~vtkSubvolReader() override = default;

    int RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
    vtkSubvolReader(const vtkSubvolReader&) = delete;
    void operator=(const vtkSubvolReader&) = delete;

    std::string FileName, Options;
};

#endif
