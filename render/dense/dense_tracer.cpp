// SPDX-License-Identifier: Apache-2.0
// A ray through the dense grids of many control cells that share sides but have no common numbering.
//
//       cell A     cell B      Each grid finds the triangles of its own boundary that the ray crosses (|). Within a grid the
//     +--------+--------+      ray walks from one of them to its partner, as in a single mesh. Edge signs are bitwise the
//  ---|--------|--------|-->   same in both grids (points are ranked by position), so a ray that leaves A through a side
//     +--------+--------+      enters B through the same triangle, and nothing is lost or counted twice between them.
//       a1   a2 b1    b2
//
// All ends are sorted by depth. The first one that no walk has used yet starts a walk, which marks its own end at the other
// side as used: a1 -> a2, then b1 -> b2. Light is composited in this order, and each depth once even where cells fold over
// each other (RayWalker). A grid whose ends all lie behind the eye is left out. docs/adr/0012 gives the reasons.
#include "dense_tracer.h"

#include <algorithm>
#include <tuple>

#include "embree_line.h"

namespace subvol::detail {

namespace {

constexpr double kMargin = 1e-5;  // around a box, for single precision

// Embree passes a pointer to the context to the callback: what follows it in memory comes along.
struct Query {
    RTCIntersectContext context;
    std::vector<std::uint32_t>* grids;
};

// Records every grid but reports no hit, so that the traversal goes on to the next.
void record_grid(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    reinterpret_cast<const Query*>(arguments->context)->grids->push_back(arguments->primID);
}

}  // namespace

struct DenseScene::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<RTCBounds> bounds;

    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

DenseScene::DenseScene(const std::vector<DenseGrid>& grids) : embree_(std::make_unique<Embree>()), grids_(grids) {
    Box all;
    for (const DenseGrid& grid : grids) {
        all.add(grid.box().lower);
        all.add(grid.box().upper);
    }
    center_ = all.center();
    if (all.diagonal() > 0) scale_ = 2 / all.diagonal();
    for (const DenseGrid& grid : grids) {
        const Vec3 low = scale_ * (grid.box().lower - center_) - kMargin,
                   high = scale_ * (grid.box().upper - center_) + kMargin;
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
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(grids.size()));
    rtcSetGeometryUserData(geometry, embree_.get());
    const auto bounds_of = [](const RTCBoundsFunctionArguments* arguments) {
        *arguments->bounds_o = static_cast<const Embree*>(arguments->geometryUserPtr)->bounds[arguments->primID];
    };
    rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(geometry, record_grid);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcCommitScene(embree_->scene);
    rtcReleaseGeometry(geometry);
    check_embree(embree_->device);
}

DenseScene::~DenseScene() = default;

void DenseScene::find_met(const Ray& ray, std::vector<std::uint32_t>& grids) const {
    auto query = embree_line(ray, center_, scale_);
    if (!query) return;
    Query context{{}, &grids};
    rtcInitIntersectContext(&context.context);
    rtcIntersect1(embree_->scene, &context.context, &*query);
}

void DenseTracer::find_ends(const RayPlane& plane, const Ray& ray) {
    met_.clear();
    ends_.clear();
    scene_.find_met(ray, met_);
    for (const std::uint32_t g : met_) {
        const DenseGrid& grid = scene_.grids()[g];
        faces_.clear();
        grid.find_crossed(plane, faces_);
        const std::size_t before = ends_.size();
        bool in_front = false;
        for (const TetFace face : faces_) {
            const double t = cross_face(grid, plane, face)->crossing().t;
            in_front |= t > 0;
            ends_.push_back({t, grid.cell(), g, face, false});
        }
        if (!in_front) ends_.resize(before);
    }
    // By cell, not by the number of the grid, which depends on which other grids are in memory.
    std::sort(ends_.begin(), ends_.end(),
              [](const End& a, const End& b) { return std::tie(a.t, a.cell, a.face) < std::tie(b.t, b.cell, b.face); });
}

bool DenseTracer::mark_walked(std::uint32_t grid, TetFace face) {
    const auto found =
        std::find_if(ends_.begin(), ends_.end(), [&](const End& end) { return end.grid == grid && end.face == face; });
    if (found == ends_.end()) return false;
    found->walked = true;
    return true;
}

Segment DenseTracer::trace(const Ray& ray) {
    clip_.cut(ray, cut_.ray);
    if (cut_.ray.empty()) return {};
    const RayPlane plane(ray);
    find_ends(plane, ray);
    if (ends_.empty()) return {};
    ++counts_.rays;
    RayWalker walker(ray, plane, cut_, compositor_, counts_);
    for (End& end : ends_) {
        if (end.walked) continue;
        end.walked = true;
        const Walk walk = walker.between(scene_.grids()[end.grid], end.face);
        if (walk.outcome == WalkOutcome::Opaque) break;
        if (walk.outcome == WalkOutcome::Lost || !mark_walked(end.grid, walk.end)) {
            ++counts_.lost_rays;
            break;
        }
    }
    return walker.light(optics_);
}

}  // namespace subvol::detail
