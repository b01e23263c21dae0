// SPDX-License-Identifier: Apache-2.0
#include "vdb_frames.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "frame_velocity.h"
#include "subvol/detail/number_text.h"
#include "subvol/mesh_motion.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr double kMostCellsOfTables = 8e6;  // refined cells, about 200 bytes each

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
    const int levels = options_.limit ? finest_level(*options_.limit) : options_.refine.levels;
    if (!options_.refine.scheme.crease_angle_deg &&
        std::ldexp(static_cast<double>(first_.cells.size()), 3 * levels) <= kMostCellsOfTables) {
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
    if (velocity) add_velocity(std::move(*velocity), mesh, frames_.times.empty() ? frames_per_second : 1);
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
