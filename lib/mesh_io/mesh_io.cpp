// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_io.h"

#include <cmath>

#include "mesh_file.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

std::string format_of(const std::filesystem::path& path) {
    return upper_case(path.extension().string());
}

// The flow has the grid's name.
ReadResult read_grid_and_flow(const std::filesystem::path& path, const ReadOptions& options) {
    const std::filesystem::path flow = std::filesystem::path(path).replace_extension(".q");
    const std::string grid_text = read_text(path), flow_file = flow.string();
    const std::string flow_text = std::filesystem::exists(flow) ? read_text(flow) : std::string();
    return read_plot3d(grid_text, path.string(), options, {flow_text, flow_file});
}

[[noreturn]] void refuse_format(const std::filesystem::path& path, const std::string& verb, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, in_quotes(path.extension().string()) + " files cannot be " + verb, path.string(),
                allowed);
}

}  // namespace

ReadResult read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    if (options.weld && !(*options.weld >= 0 && std::isfinite(*options.weld))) {
        throw Error(ErrorCode::InvalidInput, "points cannot be welded within " + std::to_string(*options.weld), path.string(),
                    "0 or a length");
    }
    const std::string format = format_of(path);
    if (format == ".MESH") return read_medit(read_text(path), path.string(), options);
    if (format == ".MESHB") return read_meshb(read_text(path), path.string(), options);
    if (format == ".VTK") return read_legacy_vtk(read_text(path), path.string(), options);
    if (format == ".VTU") return read_vtu(read_text(path), path.string(), options);
    if (format == ".VTS") return read_vts(read_text(path), path.string(), options);
    if (format == ".VTR") return read_vtr(read_text(path), path.string(), options);
    if (format == ".VTI") return read_vti(read_text(path), path.string(), options);
    if (format == ".XYZ" || format == ".P3D") return read_grid_and_flow(path, options);
    if (format == ".MSH") return read_gmsh(read_text(path), path.string(), options);
    if (format == ".E" || format == ".EXO" || format == ".EX2" || format == ".G") {
        return read_exodus(read_text(path), path.string(), options);
    }
    refuse_format(path, "read",
                  ".mesh, .meshb: MEDIT; .vtk: legacy VTK; .vtu, .vts, .vtr, .vti: VTK XML; .msh: Gmsh; .xyz, .p3d: Plot3D; "
                  ".e, .exo, .ex2, .g: Exodus II");
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh) {
    const std::string format = format_of(path);
    if (format != ".MESH" && format != ".VTU") refuse_format(path, "written", ".mesh: MEDIT ASCII; .vtu: VTK XML");
    validate(mesh);
    return format == ".MESH" ? write_medit(path, mesh) : write_vtu(path, mesh);
}

}  // namespace subvol
