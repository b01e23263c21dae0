// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_kernels.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "subvol/clamp_channel.h"
#include "subvol/detail/refined_memory.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit.h"
#include "subvol/reduce.h"
#include "subvol/sample_mixed.h"
#include "subvol/visible_points.h"

namespace subvol {
namespace {

template <class... Parts>
std::string sentence(const Parts&... parts) {
    std::ostringstream stream;
    (stream << ... << parts);
    return stream.str();
}

/// The kernels lie at the points of the mesh, whatever they carry.
bool are_at_points(const KernelOptions& options) {
    const SampleOptions& sample = options.sample;
    return sample.per_edge == 1 && !sample.centers && sample.spacing_world == 0 && !sample.footprint && sample.tolerance == 0 &&
           sample.values == ValueRule::Scheme && options.reduce_rmse == 0;
}

void warn_of_flat_cells(std::size_t points, Facts& facts) {
    if (points > 0) facts.warn(sentence(points, " points lie where cells are flat; their kernels were thickened"));
}

RbfVolume reduced(const HexMesh& mesh, const KernelOptions& options, const SchemeOptions& scheme, Facts& facts) {
    const ReduceOptions reduce{
        .rmse = options.reduce_rmse,
        .kernel = options.sample.kernel,
        .move = options.move,
        .limit = {.scheme = scheme, .tolerance = ReduceOptions{}.limit.tolerance, .progress = options.progress},
        .progress = options.progress};
    ReduceResult result = facts.timed(options.progress, "reduce", [&] { return reduce_rbf(mesh, {}, reduce); });
    const double rmse = result.report.validation.rmse;
    facts["points_before"] = mesh.points.size();
    facts["field_rmse"] = rmse;
    if (result.report.points > mesh.points.size()) {
        facts.warn("these are more kernels than control points; --per-edge 1 has fewer, perhaps with no larger error");
    }
    if (!result.report.reached) {
        facts.warn(sentence("the field's error is ", rmse, ", not ", options.reduce_rmse,
                            ": the samples of the volume are too far apart for more kernels"));
    }
    return std::move(result.volume);
}

RbfVolume sampled(HexMesh mesh, const SampleOptions& options, Facts& facts) {
    SampleResult result = facts.timed(options.progress, "sample", [&] { return sample_rbf_points(std::move(mesh), options); });
    if (options.tolerance > 0) {
        facts["largest_error"] = result.report.largest_error;
        if (result.report.largest_error > options.tolerance)
            facts.warn("the tolerance was not reached with 64 samples per cell edge");
    }
    warn_of_flat_cells(result.report.flat_frames, facts);
    return std::move(result.volume);
}

RbfVolume sampled_tets(const HexMesh& mesh, const KernelOptions& options, Facts& facts) {
    if (!are_at_points(options)) {
        throw Error(ErrorCode::InvalidInput, "the schemes of tetrahedra have one kernel at each point of a level", "--scheme",
                    "--levels makes more of them");
    }
    SampleResult result = facts.timed(options.progress, "sample", [&] {
        return sample_rbf_points(
            join_split_cells(mesh),
            {.correction = options.sample.correction, .kernel = options.sample.kernel, .progress = options.progress});
    });
    warn_of_flat_cells(result.report.flat_frames, facts);
    return std::move(result.volume);
}

}  // namespace

bool KernelOptions::are_plain() const {
    return are_at_points(*this) && sample.correction == Correction::Second && !visible && !levels &&
           to_json(sample.kernel) == to_json(Kernel{});
}

WithFacts<RbfVolume> visible_kernels(const RbfVolume& volume, const TransferFunction& function, Progress* progress) {
    Facts facts;
    VisibleVolume visible = facts.timed(progress, "threshold", [&] { return drop_invisible(volume, 0, function); });
    facts["dropped"] = visible.dropped;
    if (visible.volume.size() == 0) {
        throw Error(ErrorCode::InvalidInput, "leaves no point: nothing of the field can be seen", "--threshold");
    }
    return {std::move(visible.volume), std::move(facts)};
}

WithFacts<HexMesh> refined_on_limit(const HexMesh& mesh, const RefineOptions& options, const std::string& option) {
    constexpr int kMostLevels = 10;  // `refine` refuses more
    if (options.levels <= kMostLevels) {
        detail::check_memory(options.levels, static_cast<double>(mesh.cells.size()) * std::pow(8.0, options.levels),
                             detail::kBytesOfRefinedCell, option);
    }
    Facts facts;
    HexMesh fine =
        facts.timed(options.progress, "refine", [&] { return on_limit(refine(mesh, options), options.scheme.kind); });
    facts["levels"] = options.levels;
    facts["cells"] = fine.cells.size();
    return {std::move(fine), std::move(facts)};
}

namespace {

/// Names and bounds alone.
std::vector<Attribute> without_numbers(const std::vector<Attribute>& fields) {
    std::vector<Attribute> bare;
    for (const Attribute& field : fields)
        bare.push_back({.name = field.name, .channels = field.channels, .values = {}, .bounds = field.bounds});
    return bare;
}

/// Keeps the values of kernels within the bounds of their fields, as the limit is.
void keep_within_bounds(RbfVolume& volume, const std::vector<Attribute>& fields, Facts& facts) {
    for (RbfChannel& channel : volume.channels) {
        const auto field = std::ranges::find(fields, channel.name, &Attribute::name);
        if (field == fields.end() || field->channels != 1) continue;
        if (const auto bounds = bounds_of(*field)) facts["clamped"] = clamp_channel(channel, bounds->min[0], bounds->max[0]);
    }
}

}  // namespace

WithFacts<RbfVolume> make_mesh_kernels(HexMesh mesh, const KernelOptions& options) {
    Facts facts;
    for (const Attribute& field : mesh.attributes) facts.warn(rounding_warning(field));
    const std::vector<Attribute> fields = without_numbers(mesh.attributes);
    RbfVolume volume;
    SampleOptions sample = options.sample;
    sample.progress = options.progress;
    if (options.tets) {
        volume = sampled_tets(mesh, options, facts);
    } else {
        // A kernel at a control point would have the mean of the cells there. Those of the next level are inside of cells, too.
        const bool constant = std::ranges::any_of(mesh.attributes, &Attribute::constant) && options.reduce_rmse == 0;
        if (const std::optional<int> levels = constant && !options.levels ? std::optional(1) : options.levels) {
            const RefineOptions refine{.scheme = sample.scheme, .levels = *levels, .progress = options.progress};
            mesh = facts.unpack(refined_on_limit(mesh, refine, options.levels_option));
            sample.scheme.kind = Scheme::Linear;
            sample.boundary_levels = 0;
        }
        volume =
            options.reduce_rmse > 0 ? reduced(mesh, options, sample.scheme, facts) : sampled(std::move(mesh), sample, facts);
    }
    keep_within_bounds(volume, fields, facts);
    if (options.visible) volume = facts.unpack(visible_kernels(volume, *options.visible, options.progress));
    facts["points"] = volume.size();
    return {std::move(volume), std::move(facts)};
}

}  // namespace subvol
