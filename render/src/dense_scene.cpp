#include "dense_scene.h"

#include <embree3/rtcore.h>

#include <string>

#include "subvol/error.h"

namespace subvol {

namespace {

constexpr double kReach = 1.1;    // the volume lies in a ball of radius 1; the rest is for rounding
constexpr double kMargin = 1e-5;  // about a box, for single precision

void check(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw Error(ErrorCode::MissingCapability, error == RTC_ERROR_OUT_OF_MEMORY
                                                  ? "Embree has not enough memory"
                                                  : "Embree failed with error " + std::to_string(static_cast<int>(error)));
}

// Embree hands the context through to the callback.
struct Query {
    RTCIntersectContext context;
    std::vector<std::uint32_t>* grids;
};

// Records every grid and hits none, so that the traversal goes on to the next.
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
    check(embree_->device);
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
    check(embree_->device);
}

DenseScene::~DenseScene() = default;

void DenseScene::find_met(const Ray& ray, std::vector<std::uint32_t>& grids) const {
    const Vec3 d = glm::normalize(ray.direction);
    Vec3 nearest = scale_ * (ray.origin - center_);
    nearest -= dot(nearest, d) * d;
    if (!(dot(nearest, nearest) <= kReach)) return;
    const Vec3 origin = nearest - kReach * d;

    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x);
    query.ray.org_y = static_cast<float>(origin.y);
    query.ray.org_z = static_cast<float>(origin.z);
    query.ray.dir_x = static_cast<float>(d.x);
    query.ray.dir_y = static_cast<float>(d.y);
    query.ray.dir_z = static_cast<float>(d.z);
    query.ray.tfar = static_cast<float>(2 * kReach);
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    Query context{{}, &grids};
    rtcInitIntersectContext(&context.context);
    rtcIntersect1(embree_->scene, &context.context, &query);
}

}  // namespace subvol
