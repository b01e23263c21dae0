// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_grid.h"

#include <openvdb/tools/Count.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <utility>

#include "subvol/detail/printable.h"
#include "subvol/detail/vdb_file.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

/// The range of a function of the active values.
template <class Grid, class Measure>
void set_range(const Grid& grid, const Measure& measure, GridReport& report) {
    auto at = grid.cbeginValueOn();
    if (!at) return;
    report.min = report.max = measure(*at);
    for (; at; ++at) {
        const double value = measure(*at);
        report.min = std::min(report.min, value);
        report.max = std::max(report.max, value);
    }
}

void set_kind_and_range(const openvdb::GridBase& grid, GridReport& report) {
    if (const auto* floats = dynamic_cast<const openvdb::FloatGrid*>(&grid)) {
        report.kind = "float";
        if (report.active_voxels == 0) return;
        const auto range = openvdb::tools::minMax(floats->constTree());
        report.min = static_cast<double>(range.min());
        report.max = static_cast<double>(range.max());
    } else if (const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(&grid)) {
        report.kind = "vector";
        set_range(
            *vectors, [](const openvdb::Vec3s& v) { return openvdb::Vec3d(v).length(); }, report);
    } else if (const auto* integers = dynamic_cast<const openvdb::Int32Grid*>(&grid)) {
        report.kind = "integer";
        set_range(
            *integers, [](std::int32_t v) { return static_cast<double>(v); }, report);
    } else if (const auto* wide = dynamic_cast<const openvdb::Int64Grid*>(&grid)) {
        report.kind = "integer";
        set_range(
            *wide, [](std::int64_t v) { return static_cast<double>(v); }, report);
    } else {
        report.kind = grid.isType<openvdb::MaskGrid>() ? "mask" : grid.valueType();
    }
}

constexpr const char *kFrameLower = "subvol_frame_lower", *kFrameUpper = "subvol_frame_upper";

/// The stored frame; empty if there is none, or if its numbers do not make a box.
Box stored_frame(const openvdb::GridBase& grid) {
    const auto lower = grid.getMetadata<openvdb::Vec3DMetadata>(kFrameLower);
    const auto upper = grid.getMetadata<openvdb::Vec3DMetadata>(kFrameUpper);
    if (!lower || !upper) return {};
    Box frame;
    for (const openvdb::Vec3d& corner : {lower->value(), upper->value()}) {
        for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(corner[k])) return {};
        }
        frame.add({corner[0], corner[1], corner[2]});
    }
    return frame;
}

}  // namespace

void detail::set_frame(openvdb::GridBase& grid, const Box& frame) {
    grid.insertMeta(kFrameLower, openvdb::Vec3DMetadata({frame.lower.x, frame.lower.y, frame.lower.z}));
    grid.insertMeta(kFrameUpper, openvdb::Vec3DMetadata({frame.upper.x, frame.upper.y, frame.upper.z}));
}

namespace {

/// Frees a grid that nobody else holds. OpenVDB allocates when it frees a tree, in a destructor, from which no exception may
/// come: without memory it would end the program, and Python's interpreter with it. Therefore the tree is emptied before. If
/// that fails, its nodes are in no order, and it is never freed.
struct FreesGrid {
    openvdb::GridBase::Ptr grid;

    void operator()(openvdb::GridBase* /*same*/) noexcept {
        constexpr long kOnlyHere = 1, kHereAndByGrid = 2;
        if (grid.use_count() > kOnlyHere || grid->baseTreePtr().use_count() > kHereAndByGrid) return;
        try {
            grid->clear();
        } catch (const std::bad_alloc&) {
            alignas(openvdb::GridBase::Ptr) std::array<std::byte, sizeof(openvdb::GridBase::Ptr)> never_freed;
            new (never_freed.data()) openvdb::GridBase::Ptr(std::move(grid));
        }
    }
};

}  // namespace

detail::VdbData::VdbData(const openvdb::GridBase::Ptr& from)
    : grid(from.get(), FreesGrid{from}),
      floats(openvdb::gridPtrCast<openvdb::FloatGrid>(grid)),
      is_level_set(floats && floats->getGridClass() == openvdb::GRID_LEVEL_SET),
      report_{.name = printable(grid->getName()),
              .kind = {},
              .level_set = is_level_set,
              .active_voxels = grid->activeVoxelCount(),
              .voxel_size_world = grid->voxelSize()[0],
              .bytes = grid->memUsage()} {
    set_kind_and_range(*grid, report_);
    if (is_level_set) report_.outside = std::max(0.0, static_cast<double>(floats->background()));
    if (report_.active_voxels == 0) return;
    const openvdb::CoordBBox voxels = grid->evalActiveVoxelBoundingBox();
    const auto box = grid->transform().indexToWorld(openvdb::BBoxd(voxels.min().asVec3d(), voxels.max().asVec3d()));
    report_.bounds = {{box.min()[0], box.min()[1], box.min()[2]}, {box.max()[0], box.max()[1], box.max()[2]}};
    report_.frame = stored_frame(*grid);
    if (!report_.frame.empty()) return;
    const double half = 0.5 * report_.voxel_size_world;
    report_.frame = {report_.bounds.lower - half, report_.bounds.upper + half};
}

VdbGrid detail::make_vdb_grid(const openvdb::GridBase::Ptr& grid) {
    return VdbGrid(std::make_unique<VdbData>(grid));
}

VdbGrid detail::shared_grid(const VdbGrid& grid) {
    return VdbGrid(std::make_unique<VdbData>(VdbData::of(grid)));
}

std::optional<double> detail::VdbData::value(const Vec3& x) const {
    if (!floats) return std::nullopt;
    const auto index = grid->transform().worldToIndex({x.x, x.y, x.z});
    constexpr double kReach = 1 << 30;
    if (!(std::max({std::abs(index[0]), std::abs(index[1]), std::abs(index[2])}) < kReach)) return std::nullopt;

    // Not registered with the tree, hence cheap to make; safe in many threads as long as the tree does not change.
    const openvdb::FloatGrid::ConstUnsafeAccessor accessor(floats->constTree());
    float nearest = 0;
    const bool active = accessor.probeValue(openvdb::Coord::round(index), nearest);
    if (!active && !(is_level_set && nearest < 0)) return std::nullopt;
    const auto lower = openvdb::Coord::floor(index);
    const auto beyond = index - lower.asVec3d();
    double sum = 0, weights = 0;
    for (int k = 0; k < 8; ++k) {
        const openvdb::Coord step(k & 1, k >> 1 & 1, k >> 2);
        float voxel = 0;
        if (!accessor.probeValue(lower + step, voxel) && !is_level_set) continue;
        double weight = 1;
        for (int d = 0; d < 3; ++d) weight *= (k >> d & 1) ? beyond[d] : 1.0 - beyond[d];
        sum += weight * static_cast<double>(voxel);
        weights += weight;
    }
    return sum / weights;  // the voxel that contains x has a weight of at least 1/8
}

}  // namespace subvol
