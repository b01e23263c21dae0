#include "boundary_scene.h"

#include <embree3/rtcore.h>

#include <string>

#include "subvol/error.h"

namespace subvol {

namespace {

constexpr double kReach = 1.1;  // the volume lies in a ball of radius 1; the rest is for rounding

void check(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw Error(ErrorCode::MissingCapability, error == RTC_ERROR_OUT_OF_MEMORY
                                                  ? "Embree has not enough memory"
                                                  : "Embree failed with error " + std::to_string(static_cast<int>(error)));
}

// Embree hands the context through to the filter.
struct Query {
    RTCIntersectContext context;
    std::span<const TetFace> boundary;
    std::vector<TetFace>* faces;
};

// Records every hit and rejects it, so that the traversal goes on to the next.
void record_hit(const RTCFilterFunctionNArguments* arguments) {
    const auto* query = reinterpret_cast<const Query*>(arguments->context);
    query->faces->push_back(query->boundary[RTCHitN_primID(arguments->hit, arguments->N, 0)]);
    arguments->valid[0] = 0;
}

IndexRows faces_at_points(const TetMesh& mesh) {
    IndexRows rows;
    rows.offsets.assign(mesh.points.size() + 1, 0);
    for (const TetFace face : mesh.boundary) {
        for (const Index p : mesh.corners(face)) ++rows.offsets[p + 1];
    }
    for (std::size_t p = 0; p < mesh.points.size(); ++p) rows.offsets[p + 1] += rows.offsets[p];
    rows.values.resize(rows.offsets.back());
    auto next = rows.offsets;
    for (const TetFace face : mesh.boundary) {
        for (const Index p : mesh.corners(face)) rows.values[next[p]++] = face;
    }
    return rows;
}

}  // namespace

struct BoundaryScene::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

BoundaryScene::BoundaryScene(const TetMesh& mesh, const Box& box)
    : embree_(std::make_unique<Embree>()),
      boundary_(mesh.boundary),
      faces_at_points_(faces_at_points(mesh)),
      center_(box.center()),
      scale_(box.diagonal() > 0 ? 2 / box.diagonal() : 1) {
    embree_->device = rtcNewDevice(nullptr);
    check(embree_->device);
    const RTCDevice device = embree_->device;
    embree_->scene = rtcNewScene(device);
    rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);

    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    auto* triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                          3 * sizeof(std::uint32_t), mesh.boundary.size()));
    if (vertices && triangles) {
        for (const auto& point : mesh.points) {
            const Vec3 p = scale_ * (point.position - center_);
            for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k]);
        }
        for (const TetFace face : mesh.boundary) {
            for (const Index p : mesh.corners(face)) *triangles++ = static_cast<std::uint32_t>(p);  // Embree has 32 bits
        }
        rtcSetGeometryIntersectFilterFunction(geometry, record_hit);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree_->scene, geometry);
        rtcCommitScene(embree_->scene);
    }
    rtcReleaseGeometry(geometry);
    check(device);
}

BoundaryScene::~BoundaryScene() = default;

void BoundaryScene::find_crossed(const Ray& ray, std::vector<TetFace>& faces) const {
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
    Query context{{}, boundary_, &faces};
    rtcInitIntersectContext(&context.context);
    rtcIntersect1(embree_->scene, &context.context, &query);
}

}  // namespace subvol
