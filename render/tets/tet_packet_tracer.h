// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tet_packet.h"
#include "tet_tracer.h"

namespace subvol::detail {

/// Integrates many rays, some of them side by side in vectors. Those for which vectors do not do, at ties of edge signs and in
/// meshes that fold over their boundary, go one by one: what comes out for a ray is in any case what TetTracer gives, to the
/// last bit. Keeps scratch memory: one for each thread or tile.
class TetPacketTracer {
public:
    TetPacketTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics);

    /// The parts of the rays in front of their origins.
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
    TetTracer one_by_one_;
    TraceCounts counts_;
    std::vector<Lane> lanes_;
    TetPacket packet_;
    std::uint32_t walking_ = 0;  // lanes, bit by bit
    std::span<const Ray> rays_;
    std::span<Segment> seen_;
    std::size_t next_ = 0;
};

}  // namespace subvol::detail
