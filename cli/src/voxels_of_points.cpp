#include "voxels_of_points.h"

#include "subvol/error.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"

namespace subvol::cli {

std::vector<VdbGrid> kernel_sums(const HexMesh& mesh, const RasterizeOptions& options, int per_edge, Report& report) {
    std::vector<std::string> names;
    for (const Attribute& field : mesh.attributes) {
        if (field.channels != 1) {
            throw Error(ErrorCode::InvalidInput, "has three components; kernels carry one", "field " + field.name);
        }
        names.push_back(field.name);
    }
    auto grids = report.timed("rasterize", [&] { return rasterize(mesh, names, options); });
    const SampleOptions sampling{.scheme = options.refine.scheme, .tension = options.refine.tension, .per_edge = per_edge};
    const RbfVolume volume = report.timed("sample", [&] { return sample_rbf_points(mesh, sampling).volume; });
    report["points"] = volume.size();
    for (std::size_t f = 0; f < names.size(); ++f) {
        VdbGrid sums = report.timed("kernel sums", [&] {
            const RbfField field(volume, {.channel = f, .least_weight = 0});
            return sample_at_voxels(grids[f], names[f], [&](std::span<const Vec3> x) { return field.evaluate(x); });
        });
        const GridDifference difference = compare_voxels(grids[f], sums);
        report["against_mesh"].push_back(
            {{"name", names[f]}, {"l2", difference.rms}, {"linf", difference.max}, {"voxels", difference.voxels}});
        grids[f] = std::move(sums);
    }
    return grids;
}

}  // namespace subvol::cli
