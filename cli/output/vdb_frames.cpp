// SPDX-License-Identifier: Apache-2.0
#include "vdb_frames.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/mesh_motion.h"
#include "subvol/spread_vectors.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr double kMostCellsOfTables = 8e6;  // refined cells, about 200 bytes each
constexpr double kMostOfPieces = 1.5;       // cells of tables for each piece of the limit
// Velocities are written beyond the volume as far as it moves in this time: renderers open the shutter for a frame at most,
// usually centred on the frame's time.
constexpr double kShutter_frames = 0.5;
// In voxels. With more, the grid of a volume 200 voxels wide would have more voxels outside the volume than inside.
constexpr int kMostVelocityLayers = 64;

/// Whether tables of one level for all cells make the frames cheaper: they refine each cell as far as the finest one.
bool tables_pay(const HexMesh& mesh, const RasterizeOptions& options) {
    if (options.refine.scheme.crease_angle_deg) return false;
    const int levels = options.limit ? finest_level(*options.limit) : options.refine.levels;
    const double cells = std::ldexp(static_cast<double>(mesh.cells.size()), 3 * levels);
    if (cells > kMostCellsOfTables) return false;
    // A curved piece is a cell of the level before, and is worked on as long as one.
    return !options.limit || cells / 8 <= kMostOfPieces * static_cast<double>(options.limit->piece_count);
}

/// Adds the velocity of a mesh to its fields. Where the mesh stands still, that of the flow in it stays, if it has one.
///
/// factor: the values are multiplied with it
/// named:  whether the user has named a field so
/// throws: Error(InvalidInput) if that is so and the mesh moves
void add_velocity(Attribute velocity, HexMesh& mesh, double factor, bool named) {
    const auto flow = std::ranges::find(mesh.attributes, velocity.name, &Attribute::name);
    const bool moves = std::ranges::any_of(velocity.values, [](double v) { return v != 0; });
    if (flow != mesh.attributes.end() && !moves) return;
    if (named)
        throw Error(ErrorCode::InvalidInput, "the mesh moves, and a field has this name", kVelocity, "--fields without it");
    for (double& v : velocity.values) v *= factor;
    if (flow != mesh.attributes.end()) mesh.attributes.erase(flow);
    mesh.attributes.push_back(std::move(velocity));
}

/// Extends the velocities, if they are among the grids, beyond the volume, to where it is at other times while a shutter is
/// open.
///
/// frame: for messages
Facts spread_velocity(int frame, double frames_per_second, std::vector<VdbGrid>& grids, Progress* progress) {
    Facts facts;
    const auto velocity = std::ranges::find(grids, kVelocity, [](const VdbGrid& grid) { return grid.report().name; });
    if (velocity == grids.end() || velocity->report().kind != "vector" || velocity->report().max == 0) return facts;
    const GridReport& about = velocity->report();
    const double way_voxels = kShutter_frames * about.max / frames_per_second / about.voxel_size_world;
    if (way_voxels > kMostVelocityLayers) {
        facts.warn(text("frame ", frame, ": in half a frame something moves by ", way_voxels, " voxels; the velocities reach ",
                        kMostVelocityLayers, " voxels beyond the volume, and blur is cut off there"));
    }
    const int layers = static_cast<int>(std::min(std::ceil(way_voxels) + 1, double(kMostVelocityLayers)));
    facts.timed(progress, "spread", [&] { *velocity = vdb().spread_vectors(*velocity, layers); });
    return facts;
}

}  // namespace

FrameWriter::FrameWriter(MeshGrids& maker, const FramesToGrids& frames, const VdbArguments& asked, VdbOutput output,
                         Progress* progress)
    : maker_(maker),
      frames_(frames),
      asked_(asked),
      output_(std::move(output)),
      progress_(progress),
      first_(frames_.frames.mesh(frames_.all.first)),
      options_(facts_.unpack(maker.set_up(first_, progress))) {
    if (tables_pay(first_, options_)) {
        tables_ = facts_.timed(progress, "tables", [&] { return vdb().rasterization_tables(first_, options_); });
    }
}

WithFacts<Facts> FrameWriter::write(int frame) {
    Facts facts;
    HexMesh mesh = frames_.frames.mesh(frame);
    std::optional<Attribute> velocity;
    if (asked_.velocity) velocity = frames_.frames.velocity(frame);
    RasterizeOptions options = options_;
    options.tables = tables_ && same_cells(first_, mesh) ? &*tables_ : nullptr;
    double frames_per_second = asked_.frames_per_second;
    if (const std::vector<double>& times = frames_.times; !times.empty()) {
        const auto step = static_cast<std::size_t>(frame);
        options.metadata.emplace_back("subvol_step", std::to_string(frame));
        options.metadata.emplace_back("subvol_time", detail::number_text(times[step], 12));
        const std::size_t other = step == 0 ? 1 : step - 1;
        if (asked_.velocity) frames_per_second = 1 / std::abs(times[step] - times.at(other));
    }
    const bool named = std::ranges::find(maker_.fields().asked(), kVelocity, &GridField::name) != maker_.fields().asked().end();
    if (velocity) add_velocity(std::move(*velocity), mesh, frames_.times.empty() ? frames_per_second : 1, named);
    LimitCells limit;  // with tables the first limit serves all meshes with the same cells
    if (options_.limit && !options.tables && (asked_.velocity || frame > frames_.all.first)) {
        vdb().check_voxels(mesh, options);
        limit = facts.unpack(reported_limit(mesh, options.refine, options.voxel_size_world));
        options.limit = &limit;
    }
    VdbOutput output = output_;
    output.path = with_number(output_.path, frame);
    std::vector<VdbGrid> grids = facts.unpack(maker_.make(mesh, options));
    if (asked_.velocity) facts.merge(spread_velocity(frame, frames_per_second, grids, progress_));
    facts["voxel_size"] = grids.front().report().voxel_size_world;
    facts["active_voxels"] = active_voxels_ += grids.front().report().active_voxels;
    if (!has_voxels(grids)) {
        facts.warn(text("frame ", frame, ": no voxel centre lies inside: ", finer_voxels(mesh)));
    }
    Facts entry = facts.unpack(write_frame(frame, grids, output, progress_));
    return {std::move(entry), std::move(facts)};
}

}  // namespace subvol::cli
