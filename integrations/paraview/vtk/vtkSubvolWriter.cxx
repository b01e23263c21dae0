// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolWriter.h"

#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkObjectFactory.h>

#include <filesystem>
#include <tuple>

#include "grids.h"
#include "option_words.h"
#include "subvol/error.h"
#include "subvol/kernel_file.h"
#include "subvol/sample.h"
#include "subvol/split.h"
#include "subvol/wavelet_file.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolWriter);

void vtkSubvolWriter::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << FileName << '\n' << indent << "Options: " << Options << '\n';
}

int vtkSubvolWriter::FillInputPortInformation(int, vtkInformation* info) {
    take_cells(*info);
    return 1;
}

void vtkSubvolWriter::WriteData() {
    try {
        const std::filesystem::path path(FileName);
        const std::string extension = path.extension().string();
        if (!has_cells(GetInput())) throw Error(ErrorCode::InvalidInput, "there are no cells to write");
        const OptionWords given = words_of(Options.c_str());
        const SchemeOptions scheme{.kind = named<subvol::Scheme>(Scheme, "Scheme")};
        if (extension == ".svk") {
            SampleOptions options{.scheme = scheme};
            set_options(options_of(options), given);
            std::ignore = write_kernel_file(path, sample_rbf_points(mesh_of_data(*GetInput()).mesh, options).volume);
        } else if (extension == ".svw") {
            WaveletFileOptions options{.scheme = scheme};
            set_options(options_of(options), given);
            std::ignore = write_wavelet_file(path, mesh_of_data(*GetInput()).mesh, options);
        } else if (extension == ".bricks") {
            SplitOptions options;
            set_options(options_of(options), given);
            std::ignore = split_mesh(path, mesh_of_data(*GetInput()).mesh, options);
        } else {
            throw Error(ErrorCode::InvalidInput, "'" + FileName + "' has an unknown extension", "FileName",
                        ".svk, .svw or .bricks");
        }
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        SetErrorCode(1);  // of no file, in the table of vtkErrorCode
    }
}
