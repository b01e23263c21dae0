// SPDX-License-Identifier: Apache-2.0
#include "formats.h"

#include <algorithm>
#include <cmath>

#include "text_scanner.h"
#include "vtk/collection.h"
#include "wavelet_format.h"

namespace subvol::detail {

namespace {

template <ReadResult (&kRead)(std::string_view, std::string_view, const ReadOptions&)>
ReadResult read_file(const std::filesystem::path& path, const ReadOptions& options) {
    return kRead(read_text(path), path.string(), options);
}

// The file with the flow has the grid's name.
ReadResult read_grid_and_flow(const std::filesystem::path& path, const ReadOptions& options) {
    const std::filesystem::path flow = std::filesystem::path(path).replace_extension(".q");
    const std::string grid_text = read_text(path), flow_file = flow.string();
    const std::string flow_text = std::filesystem::exists(flow) ? read_regular(flow) : std::string();
    return read_plot3d(grid_text, path.string(), options, {flow_text, flow_file});
}

ReadResult read_wavelets(std::string_view text, std::string_view file, const ReadOptions&) {
    ReadResult result{.mesh = read_wavelet_mesh(text, std::string(file)), .fields = {}, .warnings = {}};
    for (const Attribute& a : result.mesh.attributes) {
        const auto channels = static_cast<std::size_t>(a.channels);
        FieldInfo& field = result.fields.emplace_back(FieldInfo{a.name, "point", a.channels});
        for (std::size_t i = 0; i < a.values.size(); i += channels) {
            double square = 0;
            for (std::size_t k = i; k < i + channels; ++k) square += a.values[k] * a.values[k];
            const double value = channels == 1 ? a.values[i] : std::sqrt(square);
            field.min = i == 0 ? value : std::min(field.min, value);
            field.max = i == 0 ? value : std::max(field.max, value);
        }
    }
    return result;
}

// Neighbouring rows with the same name share an entry in the lists of formats that messages show.
constexpr std::array<MeshFormat, 22> kFormats{{
    {.extensions = {".mesh"}, .name = "MEDIT", .read = read_file<read_medit>, .write = write_medit, .groups = true},
    {.extensions = {".meshb"}, .name = "MEDIT", .read = read_file<read_meshb>, .groups = true},
    {.extensions = {".vtk"}, .name = "legacy VTK", .read = read_file<read_legacy_vtk>},
    {.extensions = {".vtu"}, .name = "VTK XML", .read = read_file<read_vtu>, .write = write_vtu, .piece = read_vtu_piece},
    {.extensions = {".vts"}, .name = "VTK XML", .read = read_file<read_vts>, .piece = read_vts_piece},
    {.extensions = {".vtr"}, .name = "VTK XML", .read = read_file<read_vtr>, .piece = read_vtr_piece},
    {.extensions = {".vti"}, .name = "VTK XML", .read = read_file<read_vti>, .piece = read_vti_piece},
    {.extensions = {".pvtu", ".pvts", ".pvtr", ".pvti"}, .name = "VTK XML", .read = read_collection, .files = read_pieces_list},
    {.extensions = {".vtm"}, .name = "VTK XML", .read = read_collection, .files = read_blocks_list, .blocks = true},
    {.extensions = {".pvd"},
     .name = "ParaView",
     .read = read_collection,
     .times = pvd_times,
     .files = read_pvd,
     .blocks = true},
    {.extensions = {".series"},
     .name = "ParaView",
     .read = read_collection,
     .times = series_list_times,
     .files = read_series_list,
     .blocks = true},
    {.extensions = {".msh"}, .name = "Gmsh", .read = read_file<read_gmsh>, .groups = true},
    {.extensions = {".xyz", ".p3d"}, .name = "Plot3D", .read = read_grid_and_flow},
    {.extensions = {".e", ".exo", ".ex2", ".g"},
     .name = "Exodus II",
     .read = read_file<read_exodus>,
     .times = exodus_times,
     .blocks = true},
    {.extensions = {".vtkhdf", ".hdf"}, .name = "VTKHDF", .read = read_vtkhdf, .times = vtkhdf_times},
    {.extensions = {".xdmf", ".xmf"}, .name = "XDMF", .read = read_file<read_xdmf>, .times = xdmf_times},
    {.extensions = {".frd"}, .name = "CalculiX", .read = read_file<read_frd>, .times = frd_times},
    {.extensions = {".cgns"}, .name = "CGNS", .read = read_cgns, .times = cgns_times, .blocks = true},
    {.extensions = {".case"}, .name = "EnSight Gold", .read = read_ensight, .times = ensight_times, .blocks = true},
    {.extensions = {".foam", ".openfoam"}, .name = "OpenFOAM", .read = read_foam, .times = foam_times, .finite_volumes = true},
    {.extensions = {".inp"}, .name = "Abaqus", .read = read_inp, .blocks = true},
    {.extensions = {".svw"}, .name = "wavelets", .read = read_file<read_wavelets>},
}};

}  // namespace

std::span<const MeshFormat> mesh_formats() {
    return kFormats;
}

const MeshFormat* format_of(const std::filesystem::path& path) {
    std::error_code none;
    const bool folder = std::filesystem::is_directory(path, none);
    std::string extension = upper_case(path.extension().string());
    const auto has_it = [&](const MeshFormat& format) {
        return std::ranges::any_of(format.extensions,
                                   [&](std::string_view e) { return !e.empty() && upper_case(e) == extension; });
    };
    auto found = std::ranges::find_if(kFormats, has_it);
    if (folder && found == kFormats.end()) {
        extension = ".FOAM";
        found = std::ranges::find_if(kFormats, has_it);
    }
    return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace subvol::detail
