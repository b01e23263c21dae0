// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "boundary_scene.h"
#include "pixel_tiles.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "tet_mesh.h"
#include "tet_packet.h"
#include "tet_tracer.h"
#include "tet_walk.h"

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

/// Tetrahedra, and the boundary at which rays enter them.
class TetScene {
public:
    /// mesh:   a valid one, perhaps a part of a larger one
    /// values: one for each point
    /// box:    of the whole mesh
    /// throws: as build_tet_mesh and BoundaryScene
    TetScene(const HexMesh& mesh, std::span<const double> values, const Box& box, Progress* progress = nullptr);
    TetScene(TetMesh tets, const Box& box, Progress* progress = nullptr);
    TetScene(TetScene&&) = delete;

    [[nodiscard]] const TetMesh& tets() const { return tets_; }
    /// The memory of points, tetrahedra and boundary.
    [[nodiscard]] std::size_t bytes() const;

    /// Draws a part of a picture.
    TraceCounts draw(const View& view, const Optics& optics, int samples, const RayClip& clip, const PixelRect& part,
                     Progress* progress, Image& image) const;

private:
    TetMesh tets_;
    BoundaryScene boundary_;
};

}  // namespace subvol::detail
