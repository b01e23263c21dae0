// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolWriter_h
#define vtkSubvolWriter_h

#include <string>

#include "SubvolVtkModule.h"
#include "vtkWriter.h"

/// Writes a grid as the extension of the file says: kernels (.svk), wavelets (.svw), or a folder of bricks (.bricks), as
/// `subvol points`, `subvol points --wavelet-tolerance` and `subvol split` do.
class SUBVOLVTK_EXPORT vtkSubvolWriter : public vtkWriter {
public:
    static vtkSubvolWriter* New();
    vtkTypeMacro(vtkSubvolWriter, vtkWriter);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    vtkSetMacro(FileName, std::string);
    vtkGetMacro(FileName, std::string);
    /// Kernels and wavelets have them.
    vtkSetMacro(Scheme, std::string);
    vtkGetMacro(Scheme, std::string);
    /// Options of these commands by their names in Python: "per_edge=2", "tolerance=1e-4", "bricks=8".
    vtkSetMacro(Options, std::string);
    vtkGetMacro(Options, std::string);

protected:
    vtkSubvolWriter() = default;
    ~vtkSubvolWriter() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    void WriteData() override;

private:
    vtkSubvolWriter(const vtkSubvolWriter&) = delete;
    void operator=(const vtkSubvolWriter&) = delete;

    std::string FileName, Scheme = "mcq", Options;
};

#endif
