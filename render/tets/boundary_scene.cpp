// SPDX-License-Identifier: Apache-2.0
#include "boundary_scene.h"

#include "embree_line.h"
#include "subvol/detail/counted_rows.h"

namespace subvol::detail {

namespace {

// Embree passes a pointer to the context to the filter: what follows it in memory comes along.
struct Query {
    EmbreeContext context;
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
    return counted_rows<Index>(mesh.points.size(), [&](const auto& put) {
        for (const TetFace face : mesh.boundary) {
            for (const Index p : mesh.corners(face)) put(p, face);
        }
    });
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
    check_embree(embree_->device);
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
    check_embree(device);
}

BoundaryScene::~BoundaryScene() = default;

void BoundaryScene::find_crossed(const Ray& ray, std::vector<TetFace>& faces) const {
    auto query = embree_line(ray, center_, scale_);
    if (!query) return;
    Query context{{}, boundary_, &faces};
    intersect(embree_->scene, context.context, *query);
}

}  // namespace subvol::detail
