// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_io.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "formats.h"
#include "subvol/cell_means.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/mesh_series.h"
#include "text_scanner.h"

namespace subvol {

using namespace detail;

namespace {

bool is_left_out(const MeshFormat& format, bool writable_only) {
    return writable_only && !format.write;
}

// ".mesh: MEDIT; .xyz, .p3d: Plot3D"; neighbouring formats of one name share an entry.
std::string list_formats(bool writable_only) {
    std::string list;
    std::string_view name;
    for (const MeshFormat& format : mesh_formats()) {
        if (is_left_out(format, writable_only)) continue;
        const bool new_entry = format.name != name;
        if (new_entry && !name.empty()) list += ": " + std::string(name) + "; ";
        name = format.name;
        for (const std::string_view extension : format.extensions) {
            if (extension.empty()) continue;
            const bool first = new_entry && extension == format.extensions.front();
            list += (first ? "" : ", ") + std::string(extension);
        }
    }
    return list + ": " + std::string(name);
}

std::vector<std::string> list_extensions(bool writable_only) {
    std::vector<std::string> extensions;
    for (const MeshFormat& format : mesh_formats()) {
        if (is_left_out(format, writable_only)) continue;
        for (const std::string_view extension : format.extensions) {
            if (!extension.empty()) extensions.emplace_back(extension);
        }
    }
    return extensions;
}

// Puts the fitted fields in the place of those that were read.
void fit_fields(ReadResult& result) {
    const CellMeansFit fit = fit_cell_means(result.mesh, result.cell_means, result.cell_parts);
    std::map<std::string_view, const Attribute*> fitted;
    for (const Attribute& field : fit.fields) fitted.emplace(field.name, &field);
    for (Attribute& attribute : result.mesh.attributes) {
        const auto found = fitted.find(attribute.name);
        if (found != fitted.end()) attribute.values = found->second->values;
    }
    const auto percent = [](double part) { return number_text(100 * part, 2) + " %"; };
    result.warnings.push_back(counted(fit.fields.size(), "cell array", "cell arrays") +
                              " became values at points whose volume has the cells' means to within " +
                              percent(fit.report.rms_off) + " of their range (root mean square; at most " +
                              percent(fit.report.most_off) + ")");
}

[[noreturn]] void refuse_format(const std::filesystem::path& path, const std::string& verb, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, in_quotes(path.extension().string()) + " files cannot be " + verb, path.string(),
                allowed);
}

}  // namespace

const MeshFormat& detail::readable_format(const std::filesystem::path& path) {
    const MeshFormat* format = format_of(path);
    if (!format) refuse_format(path, "read", list_formats(false));
    return *format;
}

void detail::check_options(const MeshFormat& format, const std::filesystem::path& path, const ReadOptions& options) {
    if (!options.sharp.empty() && !format.groups) {
        throw Error(ErrorCode::InvalidInput, "groups of faces and edges are not read from such files", path.string(),
                    "sharp faces come from Gmsh (.msh) and MEDIT (.mesh, .meshb) files");
    }
    if (!options.blocks.empty() && !format.blocks) {
        throw Error(ErrorCode::InvalidInput, "such files have no named blocks", path.string(),
                    "blocks come from Exodus II, CGNS, .case, .inp and .vtm files");
    }
}

ReadResult read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    if (options.weld && !(*options.weld >= 0 && std::isfinite(*options.weld))) {
        throw Error(ErrorCode::InvalidInput, "points cannot be welded within " + number_text(*options.weld), path.string(),
                    "0 or a length");
    }
    if (options.curved_tolerance && !(*options.curved_tolerance > 0 && std::isfinite(*options.curved_tolerance))) {
        throw Error(ErrorCode::InvalidInput,
                    "curved cells cannot be followed to within " + number_text(*options.curved_tolerance), path.string(),
                    "a positive part of the mesh's size, such as 1e-4");
    }
    const MeshFormat& format = readable_format(path);
    check_options(format, path, options);
    std::vector<std::string> none;
    if (!format.times) static_cast<void>(chosen_step(options, 1, path.string(), none));
    ReadOptions resolved = options;
    if (options.cell_values == CellValues::Auto) {
        resolved.cell_values = format.finite_volumes ? CellValues::Fit : CellValues::Mean;
    }
    ReadResult result = format.read(path, resolved);
    if (!result.cell_means.empty()) fit_fields(result);
    return result;
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh) {
    const MeshFormat* format = format_of(path);
    if (!format || !format->write) refuse_format(path, "written", list_formats(true));
    validate(mesh);
    return format->write(path, mesh);
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh, const Shells& shells) {
    if (shells.empty()) return write_mesh(path, mesh);
    if (path.extension() != ".vtu") {
        throw Error(ErrorCode::InvalidInput, "shells and beams cannot be written to such files", path.string(), ".vtu");
    }
    validate(mesh);
    validate(shells, mesh);
    return write_vtu(path, mesh, shells);
}

std::vector<std::string> readable_mesh_extensions() {
    return list_extensions(false);
}

std::vector<std::string> writable_mesh_extensions() {
    return list_extensions(true);
}

MeshSeries open_series(const std::filesystem::path& path) {
    const MeshFormat& format = readable_format(path);
    MeshSeries series{path, format.times ? format.times(path) : std::vector<double>()};
    if (series.times.empty()) series.times = {0};
    return series;
}

std::size_t nearest_step(const MeshSeries& series, double time) {
    const auto nearest = std::ranges::min_element(series.times, [&](double a, double b) {
        const auto distance = [&](double t) {
            return std::isnan(t) ? std::numeric_limits<double>::infinity() : std::abs(t - time);
        };
        return distance(a) < distance(b);
    });
    return static_cast<std::size_t>(nearest - series.times.begin());
}

}  // namespace subvol
