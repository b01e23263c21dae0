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

namespace subvol::cli {
namespace {

constexpr double kMostCellsOfTables = 8e6;  // refined cells, about 200 bytes each

}  // namespace

void write_frames(MeshGrids& maker, const FramesToGrids& what, const VdbArguments& asked, const VdbOutput& into,
                  Report& report) {
    MeshFrames& frames = what.frames;
    const std::vector<double>& times = what.times;
    const FrameRange range = frames_of(what.share, what.all);
    const HexMesh first = frames.mesh(what.all.first);
    RasterizeOptions options = maker.set_up(first, report);
    const auto metadata = options.metadata;
    std::optional<RefinementTables> tables;
    const LimitCells* const of_first = options.limit;
    const int levels = of_first ? finest_level(*of_first) : options.refine.levels;
    if (!options.refine.scheme.crease_angle_deg &&
        std::ldexp(static_cast<double>(first.cells.size()), 3 * levels) <= kMostCellsOfTables) {
        tables = report.timed("tables", [&] { return rasterization_tables(first, options); });
    }
    double frames_per_second = asked.frames_per_second;
    std::size_t active_voxels = 0;
    report["frames"] = Json::array();
    for (int frame = range.first; frame <= range.last; ++frame) {
        report.begin_part(text("frame ", frame - range.first + 1, " of ", range.count()),
                          static_cast<std::size_t>(frame - range.first), static_cast<std::size_t>(range.count()));
        HexMesh mesh = frames.mesh(frame);
        std::optional<Attribute> velocity;
        if (asked.velocity) velocity = frames.velocity(frame);
        const bool same = same_cells(first, mesh);
        options.tables = tables && same ? &*tables : nullptr;
        if (!times.empty()) {
            const auto step = static_cast<std::size_t>(frame);
            options.metadata = metadata;
            options.metadata.emplace_back("subvol_step", std::to_string(frame));
            options.metadata.emplace_back("subvol_time", detail::number_text(times[step], 12));
            const std::size_t other = step == 0 ? 1 : step - 1;
            if (asked.velocity) frames_per_second = 1 / std::abs(times[step] - times.at(other));
        }
        if (velocity) add_velocity(std::move(*velocity), mesh, times.empty() ? frames_per_second : 1);
        LimitCells of_this;  // with tables the first limit serves all meshes with the same cells
        if (of_first && !options.tables && (asked.velocity || frame > what.all.first)) {
            check_voxels(mesh, options);
            of_this = reported_limit(mesh, options.refine, options.voxel_size_world, report);
            options.limit = &of_this;
        } else {
            options.limit = of_first;
        }
        VdbOutput output = into;
        output.path = with_number(into.path, frame);
        std::vector<VdbGrid> grids = maker.make(mesh, options, report);
        if (asked.velocity) spread_velocity(frame, frames_per_second, grids, report);
        report["voxel_size"] = grids.front().report().voxel_size_world;
        report["active_voxels"] = active_voxels += grids.front().report().active_voxels;
        if (!has_voxels(grids)) {
            report.warn(text("frame ", frame, ": no voxel centre lies inside: ", finer_voxels(mesh)));
        }
        write_frame(frame, grids, output, report);
    }
}

}  // namespace subvol::cli
