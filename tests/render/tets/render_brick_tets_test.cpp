// SPDX-License-Identifier: Apache-2.0
// Pictures of a mesh in bricks have the bits of those of the mesh in one piece.
#include "subvol/render_brick_tets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "pixel_wedge.h"
#include "render/hex_meshes.h"
#include "subvol/limit.h"
#include "subvol/refine.h"
#include "subvol/split.h"
#include "subvol/topology.h"

namespace subvol {
namespace render_brick_tets_test {

using detail::PixelRect;
using detail::PixelWedge;

/// A body with an edge that turns inwards, with sharp edges, with a sharp face inside, and with points in no special place.
HexMesh body() {
    HexMesh mesh = test::l_shape(12);
    for (const auto& cell : mesh.cells) {
        const std::array<Index, 4> face{cell[0], cell[1], cell[2], cell[3]};
        if (std::ranges::all_of(face, [&](Index p) { return mesh.points[p].z == 0.25; })) mesh.sharp_faces.push_back(face);
    }
    for (Vec3& p : mesh.points) p += 0.02 * Vec3(std::sin(9 * p.y), std::sin(8 * p.z + 1), std::sin(7 * p.x + 2));
    std::vector<double> values;
    for (const Vec3& p : mesh.points) values.push_back(0.5 + 0.4 * std::sin(5 * p.x + 3 * p.y) * std::cos(4 * p.z));
    mesh.attributes.push_back({"f", 1, std::move(values)});
    return mesh;
}

Optics optics() {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}}, {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {1, 0.8}}}, 1.0};
}

std::vector<View> views() {
    return {{{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .fovy_deg = 35}, 40, 32},
            {{.eye = {0.5, 0.4, 0.3}, .target = {0.9, 0.5, 0.2}, .up = {0, 0, 1}, .fovy_deg = 100}, 40, 32},  // from within
            {{.eye = {3, 0.5, 0.5}, .target = {0.5, 0.5, 0.5}, .up = {0, 0, 1}, .ortho_height = 1.2}, 40, 32}};
}

class RenderBrickTets : public test::TempFolder {
protected:
    void expect_same(const HexMesh& mesh, const SplitOptions& split, const BrickTetsOptions& options) const {
        const TetsRenderer renderer(on_limit(refine(mesh, options.refine), options.refine.scheme.kind));
        const Bricks bricks = split_mesh(path("m.bricks"), mesh, split).bricks;
        expect_same(renderer, bricks, bricks.bricks.size(), options);
        expect_same(renderer, mesh, 1, options);  // in memory: one piece
    }

    static void expect_same(const TetsRenderer& renderer, const MeshSource& source, std::size_t count,
                            const BrickTetsOptions& options) {
        BrickTets all = measure_tets(source, options, 0, count / 2);
        all.add(measure_tets(source, options, count / 2, count));
        EXPECT_LT(all.overhang, 0.5);  // of cells that are nearly cubes
        if (interpolates(options.refine.scheme.kind)) {
            EXPECT_EQ(all.overhang > 0, options.refine.levels > 0 && options.refine.scheme.kind == Scheme::Mcq);
        }
        for (const View& view : views()) {
            const TetsResult whole = renderer.draw(view, optics(), options.tets);
            const TetsResult found = render_tets(source, all, view, optics(), options);
            EXPECT_EQ(found.image.rgba, whole.image.rgba);
            EXPECT_GT(whole.report.rays, 100u);
            EXPECT_EQ(found.report.rays, whole.report.rays);
            EXPECT_EQ(found.report.segments, whole.report.segments);
            EXPECT_EQ(found.report.lost_rays, whole.report.lost_rays);
            EXPECT_EQ(found.report.tets, whole.report.tets);
            EXPECT_EQ(found.report.degenerate_tets, whole.report.degenerate_tets);
            EXPECT_EQ(found.report.inverted_tets, whole.report.inverted_tets);
        }
    }
};

TEST_F(RenderBrickTets, HasTheBitsOfTheWhole) {
    const HexMesh mesh = body();
    constexpr std::uint64_t kSmall = 4 << 20;  // several parts of the picture
    for (const SplitOptions& split : {SplitOptions{.bricks = 1}, SplitOptions{.bricks = 5, .shape = BrickShape::Slabs},
                                      SplitOptions{.bricks = 8}, SplitOptions{.bricks = 5, .shape = BrickShape::Random}}) {
        expect_same(mesh, split, {.memory_bytes = kSmall});
    }
    const SplitOptions split{.bricks = 6};
    expect_same(mesh, split, {});
    expect_same(mesh, split, {.refine = {.levels = 0}, .memory_bytes = kSmall});
    expect_same(mesh, split, {.refine = {.levels = 2}, .tets = {.samples = 2}, .memory_bytes = 6 * kSmall});
    expect_same(mesh, split, {.refine = {.scheme = {.kind = Scheme::Linear}}, .memory_bytes = kSmall});
    const Clip clip{.planes = {{{0.5, 0.5, 0.5}, {1, 0.2, 0}}}, .box = Box{{0.1, 0.2, -9}, {9, 0.8, 0.9}}};
    expect_same(mesh, split, {.tets = {.clip = clip, .rows = {8, 24}}, .memory_bytes = kSmall});
}

TEST_F(RenderBrickTets, HasTheBitsOfTheLimitOfSplines) {
    HexMesh creased = body();
    tag_creases(creased, 40);
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw}) {
        for (const SplitOptions& split : {SplitOptions{.bricks = 5, .shape = BrickShape::Slabs}, SplitOptions{.bricks = 8},
                                          SplitOptions{.bricks = 5, .shape = BrickShape::Random}}) {
            expect_same(body(), split, {.refine = {.scheme = {scheme}}, .memory_bytes = 4 << 20});
        }
        for (const int levels : {0, 2}) expect_same(creased, {.bricks = 6}, {.refine = {.scheme = {scheme}, .levels = levels}});
    }
}

TEST_F(RenderBrickTets, KeepsSharpEdges) {
    HexMesh mesh = body();
    tag_creases(mesh, 40);
    EXPECT_FALSE(mesh.creases.empty());
    expect_same(mesh, {.bricks = 8}, {.refine = {.levels = 2}});
    // By their angle, which must not be measured where a brick ends.
    mesh.creases.clear();

    for (const BrickShape shape : {BrickShape::Blocks, BrickShape::Random}) {
        expect_same(mesh, {.bricks = 8, .shape = shape}, {.refine = {.scheme = {.crease_angle_deg = 40}}});
    }
}

// The crests of a wave with two points each: their rows meet no control cell.
TEST_F(RenderBrickTets, HasWhatLeavesTheControlCells) {
    HexMesh mesh = test::lattice({16, 4, 1});
    for (Vec3& p : mesh.points) p.z = 0.2 * p.z + 0.2 * std::sin(25.1327 * p.x + 0.785398);
    mesh.attributes.push_back({"f", 1, std::vector<double>(mesh.points.size(), 0.5)});
    const View view({.eye = {0.5, -3, 0.1}, .target = {0.5, 0, 0.1}, .up = {0, 0, 1}, .ortho_height = 1}, 64, 64);
    const Bricks bricks = split_mesh(path("b"), mesh, {.bricks = 3}).bricks;
    BrickTetsOptions options{.refine = {.levels = 3}};
    const BrickTets all = measure_tets(bricks, options, 0, 3);
    EXPECT_GT(all.overhang, 0.05);
    const Image whole = render_tets(refine(mesh, options.refine), "f", view, optics()).image;
    for (int y = 10; y < 20; ++y) {  // about the crests
        options.tets.rows = {y, y + 1};
        const Image row = render_tets(bricks, all, view, optics(), options).image;
        for (int x = 0; x < 64; ++x) EXPECT_TRUE(std::ranges::equal(row.pixel(x, y), whole.pixel(x, y))) << x << ' ' << y;
    }
}

TEST_F(RenderBrickTets, SaysWhatItCannotDo) {
    const Bricks bricks = split_mesh(path("b"), body(), {.bricks = 2}).bricks;
    const auto measured = [&](const BrickTetsOptions& options) { return measure_tets(bricks, options, 0, 2); };
    test::expect_error(ErrorCode::InvalidInput, "0 to 10", [&] { (void)measured({.refine = {.levels = 11}}); });
    test::expect_error(ErrorCode::InvalidInput, "a larger --memory", [&] { (void)measured({.refine = {.levels = 10}}); });
    const BrickTets all = measured({});
    const auto draw = [&](const BrickTetsOptions& options) {
        return render_tets(bricks, all, views().front(), optics(), options);
    };
    test::expect_error(ErrorCode::InvalidInput, "a larger --memory", [&] { (void)draw({.memory_bytes = 1 << 14}); });
    test::expect_error(ErrorCode::InvalidInput, "samples is 0", [&] { (void)draw({.tets = {.samples = 0}}); });
    const Bricks thin = split_mesh(path("thin"), body(), {.bricks = 2, .halo_layers = 2}).bricks;
    test::expect_error(ErrorCode::InvalidInput, "split with --halo 3", [&] { (void)measure_tets(thin, {}, 0, 2); });
}

TEST_F(RenderBrickTets, CanBeCancelled) {
    struct Stop : Progress {
        void report(std::string_view, double fraction) override {
            EXPECT_GE(fraction, last);
            EXPECT_LE(fraction, 1);
            last = fraction;
        }
        [[nodiscard]] bool cancelled() const override { return last > 0.2; }
        double last = 0;
    } stop;
    const Bricks bricks = split_mesh(path("b"), body(), {.bricks = 5}).bricks;
    const BrickTets all = measure_tets(bricks, {}, 0, 5);
    const BrickTetsOptions options{.tets = {.progress = &stop}, .memory_bytes = 4 << 20};
    test::expect_error(ErrorCode::Cancelled, "", [&] { (void)render_tets(bricks, all, views().front(), optics(), options); });
}

// Every line through a pixel of the part is in the wedge, before and behind the eye; far from the part nothing is.
TEST(PixelWedge, HasTheLinesOfItsPixels) {
    const PixelRect part{5, 3, 9, 6};
    for (const View& view : views()) {
        const PixelWedge wedge(view, part, 0);
        for (int y = 0; y < view.height(); ++y) {
            for (int x = 0; x < view.width(); ++x) {
                const Ray ray = view.ray(x + 0.5, y + 0.5);
                const bool within = x >= part.x0 && x < part.x1 && y >= part.y0 && y < part.y1;
                for (const double t : {-4.0, -0.3, 0.2, 1.0, 7.0}) {
                    const Vec3 p = ray.origin + t * ray.direction;
                    EXPECT_EQ(wedge.may_touch({p, p}), within) << x << ' ' << y << ' ' << t;
                }
            }
        }
    }
}

}  // namespace render_brick_tets_test
}  // namespace subvol
