// SPDX-License-Identifier: Apache-2.0
#include "voxels_of_points.h"

#include "points_input.h"
#include "subvol/error.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"
#include "vdb_functions.h"

namespace subvol::cli {

WithFacts<std::vector<VdbGrid>> kernel_sums(const HexMesh& mesh, const RasterizeOptions& options, int per_edge) {
    Facts facts;
    std::vector<std::string> names;
    for (const Attribute& field : mesh.attributes) {
        if (field.channels != 1) {
            throw Error(ErrorCode::InvalidInput, "has three components; kernels carry one", "field " + field.name);
        }
        names.push_back(field.name);
    }
    auto grids = facts.timed(options.progress, "rasterize", [&] { return vdb().rasterize(mesh, names, options); });
    const SampleOptions sampling{.scheme = options.refine.scheme, .per_edge = per_edge};
    const RbfVolume volume = facts.timed(options.progress, "sample", [&] { return sample_rbf_points(mesh, sampling).volume; });
    facts["points"] = volume.size();
    FactValue::List differences;
    for (std::size_t f = 0; f < names.size(); ++f) {
        VdbGrid sums = facts.timed(options.progress, "kernel sums", [&] {
            const RbfField field(volume, {.channel = f, .least_weight = 0});
            return vdb().sample_at_voxels(grids[f], names[f], [&](std::span<const Vec3> x) { return field.evaluate(x); });
        });
        const GridDifference difference = vdb().compare_voxels(grids[f], sums);
        Facts against;
        against["name"] = names[f];
        against["l2"] = difference.rms;
        against["linf"] = difference.max;
        against["voxels"] = difference.voxels;
        differences.emplace_back(std::move(against));
        grids[f] = std::move(sums);
    }
    facts["against_mesh"] = std::move(differences);
    return {std::move(grids), std::move(facts)};
}

WithFacts<std::vector<VdbGrid>> grids_of_points(const std::string& input, std::vector<std::string> fields,
                                                const CommonOptions& common, const CLI::App& app,
                                                const RasterizeOptions& options) {
    Facts facts;
    refuse_mesh_options(app, "needs a mesh; these are points that have been sampled already");
    refuse_options(app,
                   {"--scheme", "--tension", "--levels", "--crease-angle", "--per-edge", "--cell-ids", "--coverage", "--budget",
                    "--memory"},
                   "needs a mesh; these are points that have been sampled already");
    const RbfVolume volume = facts.unpack(read_points_input(input, options.progress));
    if (fields.empty()) fields.push_back(common.field.value_or(volume.channels.front().name));
    std::vector<std::size_t> channels;
    for (const std::string& field : fields) channels.push_back(find_channel(volume, field, input));
    auto grids =
        facts.timed(options.progress, "kernel sums", [&] { return vdb().rasterize_points(volume, channels, options); });
    return {std::move(grids), std::move(facts)};
}

}  // namespace subvol::cli
