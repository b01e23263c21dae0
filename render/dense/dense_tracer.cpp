// SPDX-License-Identifier: Apache-2.0
// A ray through the dense grids of many control cells that share sides but have no common numbering.
//
//       cell A     cell B      A ray enters the volume through an open side, one without another grid behind it, and walks from
//     +--------+--------+      triangle to triangle as in a single mesh. Edge signs are bitwise the same in both grids (points
//  ---|--------|--------|-->   are ranked by position), so a ray that leaves A through a triangle enters B through the same
//  one,
//     +--------+--------+      and nothing is lost or counted twice between them. Sides meet if their four control vertices are
//       a1   link    b2        the same; then the triangle's place in B follows from its place in A.
//
// All ends at open sides are sorted by depth. The first one that no walk has used yet starts a walk, which marks its own end at
// the other side as used: a1 -> b2. Light is composited in this order, and each depth once even where cells fold over each
// other (RayWalker). A ray whose ends all lie behind the eye meets nothing. docs/adr/0012 gives the reasons.
#include "dense_tracer.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "embree_line.h"

namespace subvol::detail {

namespace {

constexpr double kMargin = 1e-5;  // around a box, for single precision

// Embree passes a pointer to the context to the callback: what follows it in memory comes along.
struct Query {
    EmbreeContext context;
    std::vector<std::uint32_t>* parts;
};

// Records every part but reports no hit, so that the traversal goes on to the next.
void record_part(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    reinterpret_cast<const Query*>(arguments->context)->parts->push_back(arguments->primID);
}

}  // namespace

struct DenseScene::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<RTCBounds> bounds;  // of the parts

    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

DenseScene::DenseScene(const std::vector<DenseGrid>& grids, const CellSides& sides, Absent absent)
    : embree_(std::make_unique<Embree>()), grids_(grids), sides_(sides), absent_(absent), next_(grids.size()) {
    link_grids();
    Box all;
    for (const DenseGrid& grid : grids) {
        all.add(grid.box().lower);
        all.add(grid.box().upper);
        most_doors_ += std::size_t{12} * grid.quads_along() * grid.quads_along();
    }
    center_ = all.center();
    if (all.diagonal() > 0) scale_ = 2 / all.diagonal();
    find_parts();
    for (const OpenPart& part : parts_) {
        const Box box = grids[part.grid].box_of(part.part);
        const Vec3 low = scale_ * (box.lower - center_) - kMargin, high = scale_ * (box.upper - center_) + kMargin;
        RTCBounds bounds{};
        bounds.lower_x = static_cast<float>(low.x);
        bounds.lower_y = static_cast<float>(low.y);
        bounds.lower_z = static_cast<float>(low.z);
        bounds.upper_x = static_cast<float>(high.x);
        bounds.upper_y = static_cast<float>(high.y);
        bounds.upper_z = static_cast<float>(high.z);
        embree_->bounds.push_back(bounds);
    }
    embree_->device = rtcNewDevice(nullptr);
    check_embree(embree_->device);
    embree_->scene = rtcNewScene(embree_->device);
    rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(parts_.size()));
    rtcSetGeometryUserData(geometry, embree_.get());
    const auto bounds_of = [](const RTCBoundsFunctionArguments* arguments) {
        *arguments->bounds_o = static_cast<const Embree*>(arguments->geometryUserPtr)->bounds[arguments->primID];
    };
    rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(geometry, record_part);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcCommitScene(embree_->scene);
    rtcReleaseGeometry(geometry);
    check_embree(embree_->device);
}

DenseScene::~DenseScene() = default;

void DenseScene::link_grids() {
    std::vector<std::uint32_t> grid_of(sides_.size(), kNone);
    for (std::uint32_t g = 0; g < grids_.size(); ++g) grid_of[grids_[g].cell()] = g;
    for (std::size_t g = 0; g < grids_.size(); ++g) {
        for (std::size_t side = 0; side < 6; ++side) {
            const Index cell = sides_.link(grids_[g].cell(), side).cell;
            next_[g][side] = cell == kNone ? kNone : grid_of[cell];
        }
    }
}

bool DenseScene::is_open(std::uint32_t grid, std::size_t side) const {
    return absent_ == Absent::NotYet ? sides_.open(grids_[grid].cell(), side) : next_[grid][side] == kNone;
}

/// The smaller the boxes, the fewer of them a ray meets in vain; more than half a million take longer to be sorted than they
/// save.
void DenseScene::find_parts() {
    constexpr std::size_t kMostParts = std::size_t{1} << 19;
    constexpr int kFinest = 2;
    std::vector<std::pair<std::uint32_t, std::size_t>> open;
    for (std::uint32_t g = 0; g < grids_.size(); ++g) {
        for (std::size_t side = 0; side < 6; ++side) {
            if (is_open(g, side)) open.emplace_back(g, side);
        }
    }
    int finest = kFinest;
    while (finest > 0 && open.size() << (2 * finest) > kMostParts) --finest;
    for (const auto& [g, side] : open) {
        const int level = std::min(finest, std::countr_zero(grids_[g].quads_along()));
        for (Index k = 0; k < Index{1} << (2 * level); ++k) {
            parts_.push_back({g, {side, level, k & ((Index{1} << level) - 1), k >> level}});
        }
    }
}

std::optional<DenseScene::Door> DenseScene::behind(const Door& door) const {
    DenseGrid::SideTriangle triangle = grids_[door.grid].on_side(door.face);
    const std::uint32_t next = next_[door.grid][triangle.side];
    if (next == kNone) return std::nullopt;
    const SideLink& link = sides_.link(grids_[door.grid].cell(), triangle.side);
    triangle.side = link.side;
    if (link.swapped) {
        std::swap(triangle.quad[0], triangle.quad[1]);
        std::swap(triangle.missing[0], triangle.missing[1]);
    }
    for (std::size_t k = 0; k < 2; ++k) {
        if (!link.backwards[k]) continue;
        triangle.quad[k] = grids_[next].quads_along() - 1 - triangle.quad[k];
        triangle.missing[k] = 1 - triangle.missing[k];
    }
    const auto face = grids_[next].face_of(triangle);
    return face ? std::optional(Door{next, *face}) : std::nullopt;
}

Index DenseScene::awaited_behind(const Door& door) const {
    if (absent_ == Absent::Nothing) return kNone;
    const std::size_t side = grids_[door.grid].on_side(door.face).side;
    return next_[door.grid][side] == kNone ? sides_.link(grids_[door.grid].cell(), side).cell : kNone;
}

void DenseScene::find_met(const Ray& ray, std::vector<std::uint32_t>& parts) const {
    auto query = embree_line(ray, center_, scale_);
    if (!query) return;
    Query context{{}, &parts};
    intersect(embree_->scene, context.context, *query);
}

void DenseTracer::find_ends(const RayPlane& plane, const Ray& ray) {
    met_.clear();
    ends_.clear();
    scene_.find_met(ray, met_);
    bool in_front = false;
    for (const std::uint32_t number : met_) {
        const auto& [g, part] = scene_.part(number);
        const DenseGrid& grid = scene_.grids()[g];
        faces_.clear();
        grid.find_crossed(plane, part, faces_);
        for (const TetFace face : faces_) {
            const double t = cross_face(grid, plane, face)->crossing().t;
            in_front |= t > 0;
            ends_.push_back({t, grid.cell(), {g, face}, false});
        }
    }
    if (!in_front) ends_.clear();
    // By cell, not by the number of the grid, which depends on which other grids are in memory.
    std::sort(ends_.begin(), ends_.end(), [](const BoundaryCrossing& a, const BoundaryCrossing& b) {
        return std::tie(a.t, a.cell, a.door.face) < std::tie(b.t, b.cell, b.door.face);
    });
}

bool DenseTracer::mark_walked(const DenseScene::Door& door) {
    const auto found = std::ranges::find_if(
        ends_, [&](const BoundaryCrossing& end) { return end.door.grid == door.grid && end.door.face == door.face; });
    if (found == ends_.end()) return false;
    found->walked = true;
    return true;
}

/// Walks from grid to grid until an open side, or until a cell without a grid, which is then `awaited`.
WalkOutcome DenseTracer::walk_from(DenseScene::Door door, RayWalker& walker) {
    const std::size_t most = scene_.most_doors();
    for (std::size_t step = 0; step < most; ++step) {
        const Walk walk = walker.between(scene_.grids()[door.grid], door.face);
        if (walk.outcome == WalkOutcome::Opaque || walk.outcome == WalkOutcome::Lost) return walk.outcome;
        door.face = walk.end;
        const auto next = scene_.behind(door);
        if (next) {
            door = *next;
            continue;
        }
        awaited_ = scene_.awaited_behind(door);
        if (awaited_ != kNone) return WalkOutcome::Opaque;
        return mark_walked(door) ? WalkOutcome::Through : WalkOutcome::Lost;
    }
    return WalkOutcome::Lost;
}

Segment DenseTracer::trace(const Ray& ray) {
    awaited_ = kNone;
    clip_.cut(ray, cut_.ray);
    if (cut_.ray.empty()) return {};
    const RayPlane plane(ray);
    find_ends(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    RayWalker walker(ray, plane, cut_, compositor_, counts_);
    for (BoundaryCrossing& end : ends_) {
        if (end.walked) continue;
        end.walked = true;
        const WalkOutcome outcome = walk_from(end.door, walker);
        if (outcome == WalkOutcome::Opaque) break;
        if (outcome == WalkOutcome::Lost) {
            ++counts_.lost_rays;
            break;
        }
    }
    return walker.light(optics_);
}

}  // namespace subvol::detail
