// SPDX-License-Identifier: Apache-2.0
// Rays side by side give the same bits as rays one by one: through points and along edges, in folded and flat meshes too.
#include "tet_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "render/hex_meshes.h"
#include "subvol/model.h"

namespace subvol {

using namespace detail;
namespace tet_packet_test {

const detail::RayClip kNoClip;

// Knots among the values, a stretch without opacity, and one that stops most rays.
Optics sharp_optics(double unit) {
    return {{{{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
             {{-1, .3}, {-.3, .05}, {-.1, 0}, {0, 0}, {.2, .6}, {.25, .01}, {1, .9}}},
            unit};
}

class Packets {
public:
    explicit Packets(const HexMesh& mesh, double unit = .1)
        : box_(bounds(mesh)),
          tets_(
              build_tet_mesh(mesh, test::evaluate(mesh, [](const Vec3& p) { return std::sin(7 * p.x + 5 * p.y - 3 * p.z); }))),
          scene_(tets_, box_),
          optics_(sharp_optics(unit * box_.diagonal())) {}

    /// Rays from all sides: through points, middles of edges and other places, along axes and not; some miss the mesh.
    [[nodiscard]] std::vector<Ray> rays(std::size_t count) {
        std::vector<Ray> all;
        for (std::size_t i = 0; i < count; ++i) {
            const auto& tet = tets_.tets[std::uniform_int_distribution<std::size_t>(0, tets_.tets.size() - 1)(random_)];
            const auto p = [&](std::size_t k) { return tets_.points[tet.corner[k]].position; };
            Vec3 through = i % 3 == 0 ? p(0) : i % 3 == 1 ? 0.5 * (p(0) + p(1)) : anywhere();
            Vec3 direction = normalize(anywhere() - anywhere());
            if (i % 4 == 0) direction = Vec3(i / 4 % 3 == 0, i / 4 % 3 == 1, i / 4 % 3 == 2);
            if (i % 17 == 0) through += 3.0 * box_.size();
            all.push_back({through - (i % 5 == 0 ? 0.1 : 2.0) * box_.diagonal() * direction, direction});
        }
        return all;
    }

    void expect_same(std::size_t count, std::size_t at_once) {
        const std::vector<Ray> all = rays(count);
        TetTracer one(tets_, scene_, optics_, kNoClip);
        TetPacketTracer many(tets_, scene_, optics_, kNoClip);
        std::vector<Segment> seen(count);
        for (std::size_t i = 0; i < count; i += at_once) {
            const std::size_t size = std::min(at_once, count - i);
            many.trace(std::span(all).subspan(i, size), std::span(seen).subspan(i, size));
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Segment expected = one.trace(all[i]);
            ASSERT_EQ(std::memcmp(&seen[i], &expected, sizeof(Segment)), 0)
                << "ray " << i << ": " << seen[i].transmittance - expected.transmittance;
        }
        EXPECT_GT(one.counts().rays, 0u);
        EXPECT_EQ(many.counts().rays, one.counts().rays);
        EXPECT_EQ(many.counts().segments, one.counts().segments);
        EXPECT_EQ(many.counts().lost_rays, one.counts().lost_rays);
    }

private:
    Vec3 anywhere() { return box_.lower + Vec3(part(), part(), part()) * box_.size(); }
    double part() { return std::uniform_real_distribution<double>(0, 1)(random_); }

    std::mt19937 random_{11};
    Box box_;
    TetMesh tets_;
    BoundaryScene scene_;
    Optics optics_;
};

TEST(TetPackets, AreRaysOneByOne) {
    for (const std::size_t at_once : {1u, 3u, 16u, 500u}) Packets(test::jittered_box(7, 0.3, 11)).expect_same(500, at_once);
    Packets(test::box(5)).expect_same(1000, 256);
    Packets(test::ball(8)).expect_same(1000, 256);
    Packets(test::l_shape(4)).expect_same(1000, 256);
    for (const char* name : {"twist", "pawn", "fan"}) Packets(make_model(name, 10)).expect_same(1000, 256);
}

TEST(TetPackets, AreRaysOneByOneInFoldedAndFlatMeshes) {
    Packets(test::jittered_box(6, 0.9, 99)).expect_same(1000, 256);
    HexMesh flat = test::box(4);
    for (Vec3& p : flat.points) {
        if (p.z == 0.5) p.z = 0.25;
    }
    Packets(flat).expect_same(1000, 256);
    HexMesh inside_out = test::box(3);
    inside_out.points[inside_out.cells.back()[6]] = Vec3(-0.3, -0.2, -0.4);
    Packets(inside_out).expect_same(1000, 256);
    HexMesh far = test::jittered_box(6, 0.3, 5);
    for (Vec3& p : far.points) p += Vec3(1e6, -7e5, 3e5);
    Packets(far).expect_same(1000, 256);
}

TEST(TetPackets, StopWhereTheLightIsUsedUp) {
    Packets(test::jittered_box(12, 0.3, 4), 1e-4).expect_same(600, 200);
}

}  // namespace tet_packet_test
}  // namespace subvol
