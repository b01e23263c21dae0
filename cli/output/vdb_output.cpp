// SPDX-License-Identifier: Apache-2.0
#include "vdb_output.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <optional>

#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/mesh_report.h"
#include "subvol/nanovdb.h"
#include "text.h"
#include "vdb_functions.h"
#include "vdb_parts.h"

namespace subvol::cli {
namespace {

/// The number that a renderer multiplies the values with for a density at which something is seen: the largest value then has
/// an optical depth of 5 across the grid. Nothing for other grids than of floats, and where there is no value.
std::optional<double> seen_density(const GridReport& grid) {
    constexpr double kDepth = 5;
    if (grid.kind != "float" || grid.active_voxels == 0) return std::nullopt;
    const Vec3 size = grid.bounds.size();
    const double across = std::max({size.x, size.y, size.z, grid.voxel_size_world}), most = std::max(grid.max, -grid.min);
    if (!(most > 0)) return std::nullopt;
    return kDepth / (most * across);
}

Facts contents_of(const GridReport& grid) {
    Facts facts;
    facts["name"] = grid.name;
    facts["kind"] = grid.kind;
    facts["active_voxels"] = grid.active_voxels;
    facts["min"] = grid.min;
    facts["max"] = grid.max;
    facts["bytes"] = grid.bytes;
    return facts;
}

Facts about(const GridReport& grid, const VdbOutput& output) {
    Facts facts = contents_of(grid);
    if (grid.name == output.level_set) {
        facts["level_set"] = true;  // distances: a renderer that took them for a density would show a shell around the body
    } else if (const auto density = seen_density(grid)) {
        facts["density"] = *density;
    }
    return facts;
}

FactValue::List about(std::span<const VdbGrid> grids, const VdbOutput& output) {
    FactValue::List all;
    for (const VdbGrid& grid : grids) all.emplace_back(about(grid.report(), output));
    return all;
}

void write_files(std::span<const VdbGrid> grids, const VdbOutput& output) {
    vdb().write_vdb(output.path, grids, output.compression);
    if (output.nano) vdb().write_nanovdb(std::filesystem::path(output.path).replace_extension(".nvdb"), grids);
}

}  // namespace

bool has_voxels(std::span<const VdbGrid> grids) {
    return std::ranges::any_of(grids, [](const VdbGrid& grid) { return grid.report().active_voxels > 0; });
}

std::string finer_voxels(const MeshSource& source) {
    if (source.mesh() == nullptr) return "try a smaller --voxel-size";
    const HexMesh& mesh = *source.mesh();
    constexpr double kMostVoxels = 2e9;  // of `rasterize`
    constexpr double kAcross = 2;        // voxels across the mean thickness
    const Vec3 size = bounds(mesh).size();
    const double widest = std::max({size.x * size.y, size.y * size.z, size.z * size.x});
    const double voxel = std::abs(measure_cells(mesh).volume) / widest / kAcross;
    const double voxels = std::ceil(size.x / voxel) * std::ceil(size.y / voxel) * std::ceil(size.z / voxel);
    if (voxels < kMostVoxels) return text("try --voxel-size ", std::setprecision(3), voxel);
    return "it is thinner than the voxels of any grid of its size; stretch it, or cut it into parts";
}

Error no_voxels(const std::string& input, const std::string& hint) {
    return {ErrorCode::InvalidInput, "no voxel centre lies inside", input, hint};
}

Facts write_share(std::span<const VdbGrid> grids, const VdbOutput& output, Progress* progress) {
    Facts facts;
    const GridReport& first = grids.front().report();
    facts.timed(progress, "write", [&] { write_files(grids, output); });
    facts["output"] = output.path;
    facts["active_voxels"] = first.active_voxels;
    facts["voxel_size"] = first.voxel_size_world;
    facts["grids"] = about(grids, output);
    return facts;
}

Facts write_reported(std::span<const VdbGrid> grids, const VdbOutput& output, Progress* progress) {
    const GridReport& first = grids.front().report();
    Facts facts;
    if (first.active_voxels == 0) facts.warn("the grid \"" + first.name + "\" is empty: no voxel centre lies inside");
    facts.merge(write_share(grids, output, progress));
    if (const auto density = seen_density(first)) {
        facts.note(text(first.name, " is ", detail::number_text(first.min, 5), " to ", detail::number_text(first.max, 5),
                        "; a renderer shows it with a density of ", detail::number_text(*density, 2), " times the value"));
    }
    const auto is_density = [](const VdbGrid& grid) { return grid.report().name == "density"; };
    if (output.level_set.empty() && std::ranges::none_of(grids, is_density)) {
        facts.note(text("no grid is called density, which Blender's volume material looks for: --fields \"density=", first.name,
                        "\" writes one"));
    }
    if (!output.level_set.empty()) {
        facts.note(text(output.level_set, " is a level set: distances have no density; a renderer makes a surface of it at 0"));
    }
    return facts;
}

WithFacts<Facts> write_frame(int frame, std::span<const VdbGrid> grids, const VdbOutput& output, Progress* progress) {
    WithFacts<Facts> written;
    written.facts.timed(progress, "write", [&] { write_files(grids, output); });
    Facts& entry = written.value;
    entry["frame"] = frame;
    entry["output"] = output.path;
    entry["active_voxels"] = grids.front().report().active_voxels;
    entry["grids"] = about(grids, output);
    return written;
}

Facts facts_of(const PartsReport& parts) {
    Facts facts;
    if (!parts.converged) facts.warn("the limit is coarser than its tolerance in some cells");
    if (parts.folded > 0) facts.note(text("cells fold over in ", parts.folded, " of ", parts.blocks, " blocks of voxels"));
    return facts;
}

namespace {

/// Adds up what is in the grids of all parts.
class GridSums {
public:
    void add(std::span<const VdbGrid> grids) {
        for (std::size_t g = 0; g < grids.size(); ++g) {
            const GridReport& grid = grids[g].report();
            if (sums_.size() <= g) sums_.push_back({.name = grid.name, .kind = grid.kind, .min = grid.min, .max = grid.max});
            GridReport& sum = sums_[g];
            sum.active_voxels += grid.active_voxels;
            sum.bytes += grid.bytes;
            sum.min = std::min(sum.min, grid.min);
            sum.max = std::max(sum.max, grid.max);
        }
    }

    [[nodiscard]] FactValue::List list() const {
        FactValue::List list;
        for (const GridReport& sum : sums_) list.emplace_back(contents_of(sum));
        return list;
    }

private:
    std::vector<GridReport> sums_;
};

}  // namespace

Facts write_parts(const std::string& input, const MeshSource& source, std::span<const std::string> fields,
                  const RasterizeOptions& options, const VdbOutput& output,
                  const std::function<void(std::vector<VdbGrid>&)>& prepare) {
    const std::size_t memory_bytes = output.memory_bytes > 0 ? output.memory_bytes : options.block_bytes;
    VdbParts parts(output, memory_bytes);
    GridSums sums;
    double voxel_size_world = options.voxel_size_world;
    // The parts are written between the stages of the rasterizer, whose own time is what is left.
    const detail::Stopwatch whole;
    double writing = 0;
    const PartsReport report = vdb().rasterize_parts(source, fields, options, memory_bytes, [&](GridPart part) {
        if (prepare) prepare(part.grids);
        voxel_size_world = part.grids.front().report().voxel_size_world;
        sums.add(part.grids);
        Facts grids;
        grids["grids"] = about(part.grids, output);
        const detail::Stopwatch one;
        parts.write(part.grids, static_cast<std::size_t>(part.number), json_of(grids));
        writing += one.seconds();
    });
    if (parts.active_voxels() == 0) throw no_voxels(input, finer_voxels(source));
    Facts facts;
    facts.add_seconds("rasterize", whole.seconds() - writing);
    facts.add_seconds("write", writing);
    facts.merge(facts_of(report));
    facts.merge(parts.finish(input, voxel_size_world, options.progress));
    if (facts.find("grids") == nullptr) facts["grids"] = sums.list();
    return facts;
}

}  // namespace subvol::cli
