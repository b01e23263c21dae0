// SPDX-License-Identifier: Apache-2.0
#include "dense_scene.h"

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

}  // namespace subvol::detail
