// SPDX-License-Identifier: Apache-2.0
#include "formats.h"
#include "format_table.h"

#include <algorithm>
#include <cmath>

#include "abaqus/inp_io.h"
#include "cgns/cgns_io.h"
#include "collection.h"
#include "ensight/ensight_io.h"
#include "openfoam/foam_case.h"
#include "text_readers.h"
#include "text_scanner.h"
#include "vtkhdf/vtkhdf_io.h"
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

constexpr std::array<MeshFormat, 22> kFormats{{
    {{".mesh"}, "MEDIT", read_file<read_medit>, write_medit, true},
    {{".meshb"}, "MEDIT", read_file<read_meshb>, nullptr, true},
    {{".vtk"}, "legacy VTK", read_file<read_legacy_vtk>, nullptr},
    {{".vtu"}, "VTK XML", read_file<read_vtu>, write_vtu, false, false, nullptr, false, read_vtu_piece},
    {{".vts"}, "VTK XML", read_file<read_vts>, nullptr, false, false, nullptr, false, read_vts_piece},
    {{".vtr"}, "VTK XML", read_file<read_vtr>, nullptr, false, false, nullptr, false, read_vtr_piece},
    {{".vti"}, "VTK XML", read_file<read_vti>, nullptr, false, false, nullptr, false, read_vti_piece},
    {{".pvtu", ".pvts", ".pvtr", ".pvti"},
     "VTK XML",
     read_collection,
     nullptr,
     false,
     false,
     nullptr,
     false,
     nullptr,
     read_pieces_list},
    {{".vtm"}, "VTK XML", read_collection, nullptr, false, true, nullptr, false, nullptr, read_blocks_list},
    {{".pvd"}, "ParaView", read_collection, nullptr, false, true, pvd_times, false, nullptr, read_pvd},
    {{".series"}, "ParaView", read_collection, nullptr, false, true, series_list_times, false, nullptr, read_series_list},
    {{".msh"}, "Gmsh", read_file<read_gmsh>, nullptr, true},
    {{".xyz", ".p3d"}, "Plot3D", read_grid_and_flow, nullptr},
    {{".e", ".exo", ".ex2", ".g"}, "Exodus II", read_file<read_exodus>, nullptr, false, true, exodus_times},
    {{".vtkhdf", ".hdf"}, "VTKHDF", read_vtkhdf, nullptr, false, false, vtkhdf_times},
    {{".xdmf", ".xmf"}, "XDMF", read_file<read_xdmf>, nullptr, false, false, xdmf_times},
    {{".frd"}, "CalculiX", read_file<read_frd>, nullptr, false, false, frd_times},
    {{".cgns"}, "CGNS", read_cgns, nullptr, false, true, cgns_times},
    {{".case"}, "EnSight Gold", read_ensight, nullptr, false, true, ensight_times},
    {{".foam", ".openfoam"}, "OpenFOAM", read_foam, nullptr, false, false, foam_times, true},
    {{".inp"}, "Abaqus", read_inp, nullptr, false, true},
    {{".svw"}, "wavelets", read_file<read_wavelets>, nullptr},
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
