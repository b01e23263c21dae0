#include "subvol/mesh_io.h"

#include "mesh_file.h"
#include "subvol/error.h"

namespace subvol {

namespace {

std::string format_of(const std::filesystem::path& path) {
    return upper_case(path.extension().string());
}

[[noreturn]] void refuse_format(const std::filesystem::path& path, const std::string& verb, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, in_quotes(path.extension().string()) + " files cannot be " + verb, path.string(),
                allowed);
}

}  // namespace

ReadResult read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string format = format_of(path);
    if (format == ".MESH") return read_medit(read_text(path), path.string(), options);
    if (format == ".VTK") return read_legacy_vtk(read_text(path), path.string(), options);
    if (format == ".VTU") return read_vtu(read_text(path), path.string(), options);
    if (format == ".MSH") return read_gmsh(read_text(path), path.string(), options);
    refuse_format(path, "read", ".mesh: MEDIT ASCII; .vtk: legacy VTK; .vtu: VTK XML; .msh: Gmsh 2 ASCII");
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh) {
    const std::string format = format_of(path);
    if (format != ".MESH" && format != ".VTU") refuse_format(path, "written", ".mesh: MEDIT ASCII; .vtu: VTK XML");
    validate(mesh);
    return format == ".MESH" ? write_medit(path, mesh) : write_vtu(path, mesh);
}

}  // namespace subvol
