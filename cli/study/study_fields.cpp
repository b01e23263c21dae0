// SPDX-License-Identifier: Apache-2.0
// Cases of studies that compare fields, without a picture. Each case gets the mesh of its input, makes something of it, and
// measures the difference from the limit at random places in the mesh, or at the points that one refinement adds.
//
//     mesh ─┬─► kernels, every second of them, or fewer within a target error
//           ├─► voxels, written to a file and read again
//           ├─► a coarser control mesh, fitted or of wavelets          ─► error at the places, number of kernels or voxels,
//           └─► values at new points by a rule                            bytes of the file
//
// One case only counts kernels and tetrahedra. Errors are given in the field's unit, as root mean square and largest, and in
// parts of the range of the mesh's values. A file is measured as it is read again, so that rounding counts, and it is
// temporary.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <map>

#include "input.h"
#include "study_input.h"
#include "study_work.h"
#include "subvol/approximate.h"
#include "subvol/cell.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/error.h"
#include "subvol/field_metrics.h"
#include "subvol/field_places.h"
#include "subvol/field_range.h"
#include "subvol/hierarchy.h"
#include "subvol/limit.h"
#include "subvol/limit_field.h"
#include "subvol/mesh_field.h"
#include "subvol/mesh_io.h"
#include "subvol/option.h"
#include "subvol/points_field.h"
#include "subvol/points_io.h"
#include "subvol/reduce.h"
#include "subvol/sample.h"
#include "subvol/vdb_grid.h"
#include "subvol/wavelet_file.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

template <class T>
void keep_first(std::vector<T>& values, std::size_t count) {
    if (!values.empty()) values.resize(count);
}

/// The kernels of every second control point: the points before the last refinement, which come first; twice as wide.
RbfVolume every_second(RbfVolume volume, std::size_t count) {
    keep_first(volume.centers, count);
    keep_first(volume.frames, count);
    for (auto& frame : volume.frames) {
        for (float& s : frame) s *= 4;
    }
    for (RbfChannel& channel : volume.channels) {
        keep_first(channel.values, count);
        keep_first(channel.gradients, count);
        keep_first(channel.moments, count);
        keep_first(channel.hessians, count);
        for (float& moment : channel.moments) moment *= 4;
    }
    return volume;
}

/// How many points the mesh had before its last refinement.
std::size_t coarse_points(const StudyCase& item) {
    if (item.whole("input.refine") < 1) {
        throw Error(ErrorCode::InvalidInput, "needs an input that is refined", "every_second", "refine 1 or more");
    }
    StudyCase coarse = item;
    coarse.values["input.refine"] = item.number("input.refine") - 1;
    return study_mesh(coarse).points.size();
}

FieldSamples places_of(const StudyCase& item, const HexMesh& mesh) {
    const std::string& where = item.text("where");
    FieldSamples places =
        random_places(mesh, mesh.attributes.front().name, named<PlaceKind>(where, "where"), item.number("within"),
                      static_cast<std::size_t>(item.number("places")), static_cast<std::uint64_t>(item.number("seed")));
    if (places.size() == 0) throw Error(ErrorCode::InvalidInput, "the mesh has no such places", where);
    return places;
}

/// Puts the error at the places, in the field's unit and in parts of the range of the mesh's values.
void put_errors(double rmse, double max, std::size_t uncovered, const HexMesh& mesh, CaseResult& result) {
    result.metrics["rmse"] = rmse;
    result.metrics["max"] = max;
    result.metrics["uncovered"] = static_cast<double>(uncovered);
    const Range range = field_range(mesh);
    if (range.max <= range.min) return;
    result.metrics["rmse_of_range"] = rmse / (range.max - range.min);
    result.metrics["max_of_range"] = max / (range.max - range.min);
}

CaseResult field_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    RbfVolume volume = sample_rbf_points(mesh, study_sampling(item, mesh)).volume;
    if (item.flag("every_second")) volume = every_second(std::move(volume), coarse_points(item));
    const ErrorAtSamples error = error_at_samples(volume, places_of(item, mesh));
    put_errors(error.rmse, error.max_abs, error.uncovered, mesh, result);
    result.metrics["kernels"] = static_cast<double>(volume.size());
    result.metrics["spacing"] = item.flag("every_second") ? 2 : 1 / item.number("per_edge");  // in cells
    return result;
}

/// Compares kernels with the limit as fields: norms, gradients, the integral and an isosurface.
CaseResult volume_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    const std::string name = mesh.attributes.front().name;
    const MeshField limit(on_limit(refine(mesh, {.levels = item.whole("levels")}), Scheme::Mcq), name);
    const RbfVolume volume = sample_rbf_points(mesh, study_sampling(item, mesh)).volume;
    const PointsField kernels(volume);
    const FieldDifference errors = compare_fields(
        kernels.view(), limit.view(),
        {.samples = static_cast<std::size_t>(item.number("places")), .seed = static_cast<std::uint64_t>(item.number("seed"))});
    const auto [low, high] = std::ranges::minmax(own_values(mesh.attributes.front()));
    const double iso = item.has("iso") ? item.number("iso") : .5 * (low + high);
    const int cubes = item.whole("resolution");
    result.metrics = {{"kernels", static_cast<double>(volume.size())},
                      {"l1", errors.l1},
                      {"l2", errors.l2},
                      {"linf", errors.linf},
                      {"gradient_rmse", errors.gradient_rmse},
                      {"uncovered", static_cast<double>(errors.uncovered)},
                      {"mass_error", mass_error(kernels.view(), limit.view(), cubes).relative},
                      {"iso", iso},
                      {"hausdorff", isosurface_distance(kernels.view(), limit.view(), iso, cubes).distance}};
    return result;
}

double bytes_of(const detail::TemporaryFile& file) {
    return static_cast<double>(std::filesystem::file_size(file.path()));
}

CaseResult voxels_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    const VdbGrid made = study_grid(item, mesh, result);
    const detail::TemporaryFile file("grid.vdb");
    vdb().write_vdb(file.path(), std::span(&made, 1), VdbCompression::Blosc);
    const std::vector<VdbGrid> read = vdb().read_vdb(file.path());  // half of the bits may be gone
    const FieldDifference errors =
        compare_field({.value = [&](const Vec3& x) { return read.front().value(x); }}, places_of(item, mesh));
    put_errors(errors.l2, errors.linf, errors.uncovered, mesh, result);
    result.metrics["file_bytes"] = bytes_of(file);
    return result;
}

/// The error of the limit of another mesh's first field.
void put_limit_errors(const StudyCase& item, const HexMesh& mesh, const HexMesh& other, CaseResult& result) {
    constexpr double kPart = 1e-4;  // of the diagonal and of the range: the floor of the errors
    const LimitField limit(other, other.attributes.front().name, {},
                           LimitCellsOptions{.position_world = kPart * bounds(mesh).diagonal(), .value_of_range = kPart});
    const FieldDifference errors = compare_field(view_of(limit), places_of(item, mesh));
    put_errors(errors.l2, errors.linf, errors.uncovered, mesh, result);
}

/// A control mesh with its values: its control points, the bytes of its file, the error of its limit.
CaseResult control_mesh_case(const StudyCase& item, const HexMesh& mesh, const HexMesh& control) {
    CaseResult result;
    put_limit_errors(item, mesh, control, result);
    result.metrics["kernels"] = static_cast<double>(control.points.size());
    const detail::TemporaryFile file("mesh.vtu");
    write_mesh(file.path(), control);
    result.metrics["file_bytes"] = bytes_of(file);
    return result;
}

CaseResult mesh_case(const StudyCase& item, const HexMesh& mesh) {
    return control_mesh_case(item, mesh, mesh);
}

HexMesh coarser_mesh(const StudyCase& item, const HexMesh& mesh) {
    if (item.has("onto")) return without_unused_points(read_mesh(item.text("onto")).mesh);
    const int levels = item.whole("coarser");
    MeshHierarchy hierarchy = find_hierarchy(mesh, {.levels = levels});
    if (hierarchy.levels == levels) return std::move(hierarchy.coarse);
    throw Error(ErrorCode::InvalidInput, "the mesh cannot be made so much coarser", "coarser",
                "at most " + std::to_string(hierarchy.levels));
}

CaseResult approximate_case(const StudyCase& item, const HexMesh& mesh) {
    ApproximateOptions options;
    set_options(item, options_of(options));
    return control_mesh_case(item, mesh, approximate(coarser_mesh(item, mesh), mesh, options).mesh);
}

CaseResult wavelets_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    WaveletFileOptions options;
    set_options(item, options_of(options));
    const detail::TemporaryFile file("mesh.svw");
    const WaveletFileReport report = write_wavelet_file(file.path(), mesh, options);
    put_limit_errors(item, mesh, read_mesh(file.path()).mesh, result);
    result.metrics["kernels"] = static_cast<double>(report.arrays.back().kept);
    result.metrics["file_bytes"] = bytes_of(file);
    return result;
}

CaseResult reduce_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    ReduceOptions options;
    set_options(item, options_of(options));
    const Range range = field_range(mesh);
    options.rmse = item.number("target") * (range.max - range.min);
    RbfVolume volume = reduce_rbf(mesh, mesh.attributes.front().name, options).volume;
    const ErrorAtSamples error = error_at_samples(volume, places_of(item, mesh));
    put_errors(error.rmse, error.max_abs, error.uncovered, mesh, result);
    result.metrics["kernels"] = static_cast<double>(volume.size());
    volume.boundary = {};  // not counted
    const detail::TemporaryFile file("kernels.ply");
    write_points(file.path(), volume);
    result.metrics["file_bytes"] = bytes_of(file);
    return result;
}

double rmse_between(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// The paper's table 2: the error of a value rule at the points that one refinement adds. Most points of a model lie in
/// constant parts and have no error; `solid_rmse` relates the error to the points of the solid, which makes models comparable.
CaseResult values_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    const Attribute& density = mesh.attributes.front();
    const auto exact = values_at_new_points(mesh, density.name, ValueRule::Scheme, Kernel{});
    std::vector<double> ours;
    if (item.text("rule") == "samples") {
        const RbfVolume points = sample_rbf_points(mesh, {.per_edge = 2}).volume;
        const auto& values = points.channels.front().values;
        ours.assign(values.begin() + static_cast<std::ptrdiff_t>(mesh.points.size()), values.end());
    } else {
        ours = values_at_new_points(mesh, density.name, named<ValueRule>(item.text("rule"), "rule"),
                                    study_kernel(item.text("kernel")));
    }
    // Densities are signed; where they are not positive the volume is empty, as in the paper.
    const auto positive = [](std::span<const double> values) {
        return std::ranges::count_if(values, [](double v) { return v > 0; });
    };
    const auto all = static_cast<double>(mesh.points.size() + exact.size());
    const auto solid = static_cast<double>(positive(density.values) + positive(exact));
    result.metrics["sampled"] = all;
    result.metrics["rendered"] = solid;
    result.metrics["rmse"] = rmse_between(ours, exact);
    if (solid > 0) result.metrics["solid_rmse"] = result.metrics["rmse"] * std::sqrt(all / solid);
    return result;
}

/// The numbers of kernels and of tetrahedra for the same number of intervals per cell edge.
CaseResult counts_case(const StudyCase& item, const HexMesh& mesh) {
    CaseResult result;
    const int n = item.whole("per_edge");
    const double small = static_cast<double>(mesh.cells.size()) * n * n * n;
    result.metrics["kernels"] = static_cast<double>(sample_rbf_points(mesh, {.per_edge = n}).report.points);
    result.metrics["tets5"] = 5 * small;
    result.metrics["tets6"] = 6 * small;
    result.metrics["ratio5"] = result.metrics["kernels"] / result.metrics["tets5"];
    result.metrics["ratio6"] = result.metrics["kernels"] / result.metrics["tets6"];
    return result;
}

using FieldCase = CaseResult (*)(const StudyCase&, const HexMesh&);

const std::map<std::string, FieldCase> kFieldCases{
    {"field", field_case},       {"volume", volume_case}, {"voxels", voxels_case}, {"approximate", approximate_case},
    {"wavelets", wavelets_case}, {"reduce", reduce_case}, {"mesh", mesh_case},     {"values", values_case},
    {"counts", counts_case}};

}  // namespace

CaseResult run_field_case(const StudyCase& item) {
    const auto found = kFieldCases.find(item.text("method"));
    assert(found != kFieldCases.end());
    const HexMesh mesh = study_mesh(item);
    CaseResult result = found->second(item, mesh);
    result.metrics["points"] = static_cast<double>(mesh.points.size());
    result.metrics["cells"] = static_cast<double>(mesh.cells.size());
    return result;
}

}  // namespace subvol::cli
