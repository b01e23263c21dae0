// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolVdbWriter.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include <algorithm>
#include <filesystem>

#include "grids.h"
#include "subvol/error.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "subvol/version.h"

using namespace subvol;

vtkStandardNewMacro(vtkSubvolVdbWriter);

void vtkSubvolVdbWriter::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << FileName << '\n' << indent << "Resolution: " << Resolution << '\n';
}

void vtkSubvolVdbWriter::AddArray(const char* name) {
    Arrays.emplace_back(name);
    Modified();
}

void vtkSubvolVdbWriter::ClearArrays() {
    Arrays.clear();
    Modified();
}

int vtkSubvolVdbWriter::FillInputPortInformation(int, vtkInformation* info) {
    take_cells(*info);
    return 1;
}

void vtkSubvolVdbWriter::WriteData() {
    try {
        if (FileName.empty()) throw Error(ErrorCode::InvalidInput, "no file is named", "FileName");
        if (!has_cells(GetInput())) throw Error(ErrorCode::InvalidInput, "there are no cells to write");
        const HexMesh mesh = mesh_of_data(*GetInput()).mesh;
        std::vector<std::string> fields = Arrays;
        for (const Attribute& field : mesh.attributes) {
            if (Arrays.empty() && (field.channels == 1 || field.channels == 3)) fields.push_back(field.name);
        }
        RasterizeOptions options{.resolution = Resolution, .half = HalfFloats};
        options.refine.scheme.kind = named<subvol::Scheme>(Scheme, "Scheme");
        options.metadata = {{"subvol_scheme", Scheme}, {"subvol_version", SUBVOL_VERSION}};
        write_vdb(std::filesystem::path(FileName), rasterize_limit(mesh, fields, options).grids);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        SetErrorCode(1);  // of no file, in the table of vtkErrorCode
    }
}
