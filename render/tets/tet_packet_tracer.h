// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tet_packet.h"
#include "tet_tracer.h"

namespace subvol::detail {

/// Integrates many rays, side by side in vectors. Rays with ties of edge signs, and rays through meshes that fold over their
/// boundary, are traced one by one instead, and so are rays that a clip cuts. In any case a ray gets the same bits as from
/// TetTracer. Keeps scratch memory, so each thread or tile needs its own.
class TetPacketTracer {
public:
    /// Keeps references to all of them.
    TetPacketTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics, const RayClip& clip);

    /// seen: the light along each ray, from its origin on
    void trace(std::span<const Ray> rays, std::span<Segment> seen);
    [[nodiscard]] TraceCounts counts() const;

private:
    struct Lane {
        Lane(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics)
            : plane(Ray{Vec3(0.0), Vec3(0.0, 0.0, 1.0)}), ends(mesh, scene), compositor(optics, kRayCutoff) {}
        std::size_t ray = 0;
        RayPlane plane;
        RayEnds ends;
        Compositor compositor;
        LitDepth state;
        TetFace start = kNone;
        double first_t = 0;
        std::size_t steps = 0;     // of this walk
        std::size_t segments = 0;  // of the ray
    };
    void next_ray(std::size_t lane);
    [[nodiscard]] bool begin_walk(std::size_t lane);
    void end_walk(std::size_t lane);
    void finish(std::size_t lane);
    void trace_alone(std::size_t lane);

    const TetMesh& mesh_;
    const RayClip& clip_;
    RayCut cut_;
    TetTracer one_by_one_;
    TraceCounts counts_;
    std::vector<Lane> lanes_;
    TetPacket packet_;
    std::uint32_t walking_ = 0;  // a bit for each lane
    std::span<const Ray> rays_;
    std::span<Segment> seen_;
    std::size_t next_ = 0;
};

}  // namespace subvol::detail
