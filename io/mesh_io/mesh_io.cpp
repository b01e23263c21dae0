// SPDX-License-Identifier: Apache-2.0
// Reads and writes meshes of all formats. A table has a row for each: its file name extensions, and the functions that read it,
// write it and list its times. Where the first bytes of a file show its format with certainty, they decide which row is taken;
// elsewhere the extension does, if there is a row with it. A folder may be of a format, too. What the reader returns is
// finished here:
//
//     options → row → step nearest to the time → reader → check ┐
//     ┌─────────────────────────────────────────────────────────┘
//     └→ means of cells become values at points → values on patches → bounds of fractions → steps and time
//
// Values on patches come after those that are fitted to means, which they replace at the points on patches. The writer is found
// by the extension alone, and gets a mesh only after it has been validated with its sets.
#include "subvol/mesh_io.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <tuple>

#include "formats.h"
#include "series_format.h"
#ifdef SUBVOL_SOLVERS
#include "solver_formats.h"
#endif
#include "subvol/cell_means.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/field_bounds.h"
#include "subvol/foreign_files.h"
#include "subvol/mesh_series.h"
#include "subvol/option.h"
#include "vtk/collection.h"
#include "wavelet_format.h"

namespace subvol {

using namespace detail;

namespace {

// The file with the flow has the grid's name.
ReadResult read_grid_and_flow(const std::filesystem::path& path, const ReadOptions& options) {
    const std::filesystem::path flow = std::filesystem::path(path).replace_extension(".q");
    const std::string grid_text = read_text(path), flow_file = flow.string();
    const std::string flow_text = std::filesystem::exists(flow) ? read_regular(flow) : std::string();
    return read_plot3d(grid_text, path.string(), options, {flow_text, flow_file});
}

// Whether a .svw file has steps. What is no regular file is not looked into, as it could be read only once.
bool has_steps(const std::filesystem::path& path) {
    return not_regular(path).empty() && is_series_text(read_range(path, 0, kSeriesMagic.size()));
}

std::vector<double> wavelet_times(const std::filesystem::path& path) {
    return has_steps(path) ? series_file_times(path) : std::vector<double>();
}

ReadResult read_wavelets(const std::filesystem::path& path, const ReadOptions& options) {
    ReadResult result;
    if (has_steps(path)) {
        const std::size_t step = chosen_step(options, series_file_times(path).size(), path.string(), result.warnings);
        auto [mesh, sets] = read_series_file(path, step);
        result.mesh = std::move(mesh);
        result.sets = std::move(sets);
    } else {
        std::ignore = chosen_step(options, 1, path.string(), result.warnings);
        result.mesh = read_wavelet_mesh(read_text(path), path.string());
    }
    for (const Attribute& a : result.mesh.attributes) {
        const auto channels = static_cast<std::size_t>(a.channels);
        FieldInfo& field = result.fields.emplace_back(FieldInfo{a.name, "point", a.channels});
        bool first = true;
        for (std::size_t i = 0; i < a.values.size(); i += channels) {
            double square = 0;
            for (std::size_t k = i; k < i + channels; ++k) square += a.values[k] * a.values[k];
            const double value = channels == 1 ? a.values[i] : std::sqrt(square);
            if (!std::isfinite(value)) continue;  // at a point that no cell uses
            field.min = first ? value : std::min(field.min, value);
            field.max = first ? value : std::max(field.max, value);
            first = false;
        }
    }
    return result;
}

// Neighbouring rows with the same name share an entry in the lists of formats that messages show.
constexpr std::array<MeshFormat, 17> kFormats{{
    {.extensions = {".mesh"}, .name = "MEDIT", .read = read_file<read_medit>, .write = write_medit, .groups = true},
    {.extensions = {".meshb"}, .name = "MEDIT", .read = read_file<read_meshb>, .groups = true},
    {.extensions = {".vtk"}, .name = "legacy VTK", .read = read_file<read_legacy_vtk>},
    {.extensions = {".vtu"}, .name = "VTK XML", .read = read_file<read_vtu>, .write = write_vtu, .piece = read_vtu_piece},
    {.extensions = {".vts"}, .name = "VTK XML", .read = read_file<read_vts>, .piece = read_vts_piece},
    {.extensions = {".vtr"}, .name = "VTK XML", .read = read_file<read_vtr>, .piece = read_vtr_piece},
    {.extensions = {".vti"}, .name = "VTK XML", .read = read_file<read_vti>, .piece = read_vti_piece},
    {.extensions = {".pvtu", ".pvts", ".pvtr", ".pvti"}, .name = "VTK XML", .read = read_collection, .files = read_pieces_list},
    {.extensions = {".vth", ".vthb"}, .name = "VTK XML", .read = read_amr},
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
    {.extensions = {".msh"},
     .name = "Gmsh",
     .read = read_file<read_gmsh>,
     .write = write_gmsh,
     .times = gmsh_times,
     .groups = true},
    {.extensions = {".xyz", ".p3d"}, .name = "Plot3D", .read = read_grid_and_flow},
    {.extensions = {".vtkhdf", ".hdf"}, .name = "VTKHDF", .read = read_vtkhdf, .write = write_vtkhdf, .times = vtkhdf_times},
    {.extensions = {".xdmf", ".xmf"}, .name = "XDMF", .read = read_file<read_xdmf>, .times = xdmf_times},
    {.extensions = {".svw"}, .name = "wavelets", .read = read_wavelets, .times = wavelet_times},
}};

// Those of all families, in their order.
const std::vector<MeshFormat>& all_formats() {
    static const std::vector<MeshFormat> formats = [] {
        std::vector<MeshFormat> all;
        for (const FormatFamily& family : format_families())
            all.insert(all.end(), family.formats.begin(), family.formats.end());
        return all;
    }();
    return formats;
}

bool is_left_out(const MeshFormat& format, bool writable_only) {
    return writable_only && !format.write;
}

// Those that are written: ".mesh: MEDIT; .vtkhdf, .hdf: VTKHDF"; neighbouring formats of one name share an entry.
std::string list_written_formats() {
    std::string list;
    std::string_view name;
    for (const MeshFormat& format : all_formats()) {
        if (is_left_out(format, true)) continue;
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
    for (const MeshFormat& format : all_formats()) {
        if (is_left_out(format, writable_only)) continue;
        for (const std::string_view extension : format.extensions) {
            if (!extension.empty()) extensions.emplace_back(extension);
        }
    }
    return extensions;
}

// ".exo, .cgns": of the formats that have something.
std::string extensions_with(bool MeshFormat::*has) {
    std::string list;
    for (const MeshFormat& format : all_formats()) {
        if (!(format.*has)) continue;
        for (const std::string_view extension : format.extensions)
            if (!extension.empty()) list += (list.empty() ? "" : ", ") + std::string(extension);
    }
    return list.empty() ? "none is built in" : list;
}

// Puts the fitted fields in the place of those that were read.
void fit_fields(ReadResult& result, CellValues method) {
    std::vector<Attribute> fields;
    CellMeansReport report;
    if (method == CellValues::Exact) {
        ExactMeansFit fit = fit_exact_cell_means(result.mesh, result.cell_means, result.cell_parts);
        fields = std::move(fit.fields);
        report = fit.report.found;
    } else {
        CellMeansFit fit = fit_cell_means(result.mesh, result.cell_means, result.on_patches, result.cell_parts);
        fields = std::move(fit.fields);
        report = fit.report;
    }
    result.cell_values = CellValuesReport{method, fields.size(), report.rms_off, report.most_off};
    std::map<std::string_view, Attribute*> fitted;
    for (Attribute& field : fields) fitted.emplace(field.name, &field);
    for (Attribute& attribute : result.mesh.attributes) {
        const auto found = fitted.find(attribute.name);
        if (found == fitted.end()) continue;
        attribute.values = std::move(found->second->values);
        attribute.bounds = std::move(found->second->bounds);
    }
    const auto percent = [](double part) { return number_text(100 * part, 2) + " %"; };
    result.warnings.push_back(counted(fields.size(), "cell array", "cell arrays") +
                              " became values at points whose volume has the cells' means to within " +
                              percent(report.rms_off) + " of their range (root mean square; at most " +
                              percent(report.most_off) + ")");
}

// Points on patches get the values that the file has there.
void take_patch_values(ReadResult& result, PatchValuesUse use) {
    const PatchValuesReport report = meet_patch_values(result.mesh, result.on_patches, use);
    if (report.fields == 0) return;
    result.patch_values = report;
    std::string change;
    if (report.most_of_mean >= .001) {
        change = "; the integral of " + in_quotes(report.most_changed) + " over the volume changed by about " +
                 number_text(100 * report.most_of_mean, 2) + " %";
    }
    result.warnings.push_back(counted(report.points, "point", "points") + " on patches got the values that " +
                              counted(report.fields, "field has", "fields have") + " there" + change);
}

// The types of VTK XML, and the ending of each.
constexpr std::array<std::array<std::string_view, 2>, 13> kVtkXmlTypes{{{"\"UnstructuredGrid\"", ".vtu"},
                                                                        {"\"StructuredGrid\"", ".vts"},
                                                                        {"\"RectilinearGrid\"", ".vtr"},
                                                                        {"\"ImageData\"", ".vti"},
                                                                        {"\"PUnstructuredGrid\"", ".pvtu"},
                                                                        {"\"PStructuredGrid\"", ".pvts"},
                                                                        {"\"PRectilinearGrid\"", ".pvtr"},
                                                                        {"\"PImageData\"", ".pvti"},
                                                                        {"\"vtkMultiBlockDataSet\"", ".vtm"},
                                                                        {"\"vtkOverlappingAMR\"", ".vth"},
                                                                        {"\"vtkNonOverlappingAMR\"", ".vth"},
                                                                        {"\"vtkHierarchicalBoxDataSet\"", ".vth"},
                                                                        {"\"Collection\"", ".pvd"}}};

// begin: of a file of text
Contents contents_of_text(std::string_view begin) {
    const std::string_view first = trimmed(begin);
    const std::string upper = upper_case(first);
    if (upper.starts_with("# VTK DATAFILE")) return {".vtk"};
    if (first.starts_with('<')) {
        if (const std::size_t vtk = first.substr(0, 1024).find("<VTKFile"); vtk != std::string_view::npos) {
            const std::string_view element = first.substr(vtk, first.find('>', vtk) - vtk);
            for (const auto& [type, extension] : kVtkXmlTypes) {
                if (element.find(type) != std::string_view::npos) return {extension};
            }
            return {};
        }
        return {upper.find("<XDMF") != std::string::npos ? ".xdmf" : ""};
    }
    if (first.starts_with("$MeshFormat") || first.starts_with("$NOD")) return {".msh"};
    if (first.starts_with("$Comments") || first.starts_with("$PhysicalNames")) return {".msh", false};
    if (upper.starts_with("MESHVERSIONFORMATTED")) return {".mesh"};
    return {};
}

// begin: of a file of one of the formats above
Contents contents_of_own(std::string_view begin) {
    if (begin.starts_with("\x89HDF") && begin.find("VTKHDF") != std::string_view::npos) return {".vtkhdf"};
    return contents_of_text(begin.substr(0, kFirstText));
}

// Empty if the first bytes do not show a format.
Contents contents_of(const std::filesystem::path& path) {
    if (!not_regular(path).empty()) return {};
    std::string begin(kFirstBytes, '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    begin.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
    for (const FormatFamily& family : format_families()) {
        if (const Contents found = family.contents(begin); !found.extension.empty()) return found;
    }
    return {};
}

// The way to files that the library does not read, for its refusal; empty for endings that are unknown.
std::string way_to(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (const ForeignFormat* foreign = foreign_format(path)) {
        return "; python3 -m subvol.convert " + path.filename().string() + " mesh.vtu converts it by " + foreign->by +
               " (Debian: " + foreign->packages + ")";
    }
    if (extension == ".unv") return "; gmsh -save -format msh4 -o mesh.msh " + path.filename().string() + " converts it";
    if (extension == ".re2" || extension == ".rea")
        return "; ParaView opens the results of a run of Nek5000 (NAME.nek5000) and saves them as .vtu files";
    constexpr std::array<std::string_view, 7> kUnknown{".k", ".key", ".cdb", ".ans", ".op2", ".mphtxt", ".pf3"};
    if (std::ranges::find(kUnknown, extension) != kUnknown.end()) {
        return "; meshio cannot read them either: export one of these from the program that made them";
    }
    return {};
}

// Files that are of something else than cells, of which the command makes a mesh.
void refuse_others(const std::filesystem::path& path) {
    if (names_surface(path) || names_foreign_surface(path)) refuse_surface(path);
    if (upper_case(path.extension().string()) == ".VDB") {
        throw Error(ErrorCode::InvalidInput, "is a grid, not a mesh of cells", path.string(),
                    "`" + command_for_surface(path, "--iso VALUE") + "` makes a control mesh of it");
    }
}

// The row with an extension in any case; null if there is none.
const MeshFormat* format_with(std::string_view extension) {
    const std::string upper = upper_case(extension);
    const auto has_it = [&](const MeshFormat& format) {
        return std::ranges::any_of(format.extensions, [&](std::string_view e) { return !e.empty() && upper_case(e) == upper; });
    };
    const auto found = std::ranges::find_if(all_formats(), has_it);
    return found == all_formats().end() ? nullptr : &*found;
}

void warn_of_time(const std::optional<double>& asked, const std::vector<double>& times, ReadResult& result) {
    if (!asked) return;
    if (times.size() < 2) {
        result.warnings.emplace_back("the file has one step, so there is no time to choose");
        return;
    }
    const auto [first, last] = std::ranges::minmax(times);
    if (*asked >= first && *asked <= last) return;
    result.warnings.push_back("time " + number_text(*asked) + " is beyond the steps of the file: it is step " +
                              std::to_string(result.step) + " of 0 to " + std::to_string(times.size() - 1) + ", time " +
                              number_text(times[result.step]));
}

[[noreturn]] void refuse_format(const std::filesystem::path& path, const std::string& verb, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, in_quotes(path.extension().string()) + " files cannot be " + verb, path.string(),
                allowed);
}

}  // namespace

std::span<const FormatFamily> detail::format_families() {
    static const std::vector<FormatFamily> families{
        {kFormats, contents_of_own},
#ifdef SUBVOL_SOLVERS
        solver_formats(),
#endif
    };
    return families;
}

const MeshFormat* detail::format_of(const std::filesystem::path& path) {
    std::error_code none;
    const MeshFormat* named = format_with(path.extension().string());
    if (std::filesystem::is_directory(path, none)) {
        const auto folder = std::ranges::find_if(all_formats(), &MeshFormat::folder);
        return named || folder == all_formats().end() ? named : &*folder;
    }
    const Contents contents = contents_of(path);
    const MeshFormat* found = format_with(contents.extension);
    if (found && (contents.certain || (!named && !(contents.shared && foreign_format(path))))) return found;
    return named ? named : foreign_row(path);
}

const MeshFormat& detail::readable_format(const std::filesystem::path& path) {
    const MeshFormat* format = format_of(path);
    if (!format) {
        refuse_missing(path);
        refuse_others(path);
#ifdef SUBVOL_SOLVERS
        const std::string without;
#else
        const std::string without = "; this build is one without the readers of solvers' files, SUBVOL_SOLVERS";
#endif
        refuse_format(path, "read",
                      "docs/formats.md and `subvol info --help` list the formats that can" + way_to(path) + without);
    }
    return *format;
}

CellValues detail::resolved_cell_values(const MeshFormat& format, CellValues chosen) {
    if (chosen != CellValues::Auto) return chosen;
    return format.finite_volumes ? CellValues::Fit : CellValues::Auto;
}

void detail::check_options(const MeshFormat& format, const std::filesystem::path& path, const ReadOptions& options) {
    if (!options.sharp.empty() && !format.groups) {
        throw Error(ErrorCode::InvalidInput, "groups of faces and edges are not read from such files", path.string(),
                    "sharp faces come from Gmsh (.msh) and MEDIT (.mesh, .meshb) files");
    }
    if (!options.deck.empty() && !format.deck) {
        throw Error(ErrorCode::InvalidInput, "such files have their own sets and patches", path.string(),
                    "a deck is read beside files that have none: " + extensions_with(&MeshFormat::deck));
    }
    if (!options.blocks.empty() && !format.blocks) {
        throw Error(ErrorCode::InvalidInput, "such files have no named blocks", path.string(),
                    "those of these have: " + extensions_with(&MeshFormat::blocks));
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
    if (!format.times) std::ignore = chosen_step(options, 1, path.string(), none);
    ReadOptions resolved = options;
    resolved.cell_values = resolved_cell_values(format, options.cell_values);
    if (options.time && !options.step && format.times) resolved.step = nearest_step(open_series(path), *options.time);
    ReadResult result = format.read(path, resolved);
    check_read(result, path.string());
    if (const MeshFormat* named = format_with(path.extension().string()); named && named != &format) {
        result.warnings.insert(result.warnings.begin(), "the contents are those of " + std::string(format.name) +
                                                            ", which decides, not the ending " + path.extension().string() +
                                                            " (" + std::string(named->name) + ")");
    }
    if (!result.cell_means.empty()) fit_fields(result, resolved.cell_values);
    if (resolved.patch_values != PatchValuesUse::Ignore && !result.on_patches.fields.empty()) {
        set_wall_gradients(result.mesh, result.on_patches, result.cell_parts);
        const bool meets = resolved.cell_values != CellValues::Exact && resolved.cell_values != CellValues::Constant;
        if (meets) take_patch_values(result, resolved.patch_values);
    }
    if (const auto fractions = bound_fractions(result.mesh, result.cell_means); !fractions.empty()) {
        result.warnings.push_back(bounded_fractions_text(fractions));
    }
    if (format.times) {
        const std::vector<double> times = format.times(path);
        result.steps = std::max<std::size_t>(times.size(), 1);
        result.step = resolved.step.value_or(result.steps - 1);
        // A list of one file says its time; other formats of one step have none.
        if (result.steps > 1 || (format.files != nullptr && times.size() == 1)) result.mesh.time = times[result.step];
        warn_of_time(options.time, times, result);
    } else {
        warn_of_time(options.time, {}, result);
    }
    return result;
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh, const Shells& shells,
                                    const MeshSets& sets) {
    const auto writes = [&](const MeshFormat& format) {
        return format.write && std::ranges::find(format.extensions, path.extension().string()) != format.extensions.end();
    };
    const auto format = std::ranges::find_if(all_formats(), writes);
    if (path.extension().empty() || format == all_formats().end()) refuse_format(path, "written", list_written_formats());
    if (!shells.empty() && path.extension() != ".vtu") {
        throw Error(ErrorCode::InvalidInput, "shells and beams cannot be written to such files", path.string(), ".vtu");
    }
    validate(mesh);
    if (!shells.empty()) validate(shells, mesh);
    validate(sets, mesh);
    return format->write(path, {mesh, shells, sets});
}

bool is_mesh_file(const std::filesystem::path& path) {
    return format_of(path) != nullptr;
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
