// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/comma_locale.h"
#include "lib/test_meshes.h"
#include "projected_scenes.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"

namespace subvol {
namespace render_havs_test {

using namespace test;

using RenderHavs = ProjectedTest;

constexpr int kAll = 4096;  // entries: more than any pixel here has faces

double rms_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

/// Flat cells of all lengths, seen from a slant: the order of centroids is not that of the cells.
HexMesh flat_box() {
    HexMesh mesh = box(8);
    for (Vec3& p : mesh.points) p = Vec3(p.x * p.x * p.x, p.y, 0.1 * p.z);
    return mesh;
}
View flat_view() {
    return {{.eye = {2.5, 2.1, 0.9}, .target = {0.5, 0.5, 0}, .up = {0, 0, 1}, .fovy_deg = 30}, 64, 48};
}

/// A mesh of two slabs with a gap between them.
HexMesh two_slabs() {
    return lattice({4, 4, 5}, [](Index, Index, Index k) { return k == 0 || k == 4; });
}

TEST_F(RenderHavs, WithManyEntriesItIsLikeLists) {
    const Optics optics = ramp_optics(0.1);
    for (const HexMesh& mesh : {jittered_box(6, 0.3, 5), ball(6), l_shape(6), flat_box(), two_slabs()}) {
        const auto values = evaluate(mesh, waves);
        for (const View& view : {slanted_view(64), orthographic_view(61, 47)}) {
            const auto havs =
                render_projected(valued(mesh, values), {}, view, optics, {.order = ProjectedOrder::Havs, .kbuffer = kAll});
            const auto lists = render_projected(valued(mesh, values), {}, view, optics, {.order = ProjectedOrder::Lists});
            EXPECT_EQ(havs.report.late_faces, 0u);
            EXPECT_EQ(havs.report.violations, 0u);
            EXPECT_EQ(havs.report.faces_drawn, havs.report.faces);
            EXPECT_GT(havs.report.fragments, lists.report.fragments) << "a ray meets one more face than tetrahedra, or two";
            EXPECT_LT(largest_difference(havs.image, lists.image), kFewTol);
        }
    }
}

TEST_F(RenderHavs, SixEntriesAreEnoughForWellShapedCells) {
    for (const HexMesh& mesh : {box(6), jittered_box(8, 0.2, 5), ball(8)}) {
        const auto values = evaluate(mesh, waves);
        for (const View& view : {slanted_view(64), ball_view(80, 64), orthographic_view(61, 47)}) {
            const auto havs =
                render_projected(valued(mesh, values), {}, view, ramp_optics(0.1), {.order = ProjectedOrder::Havs});
            const auto rays = render_tets(valued(mesh, values), {}, view, ramp_optics(0.1));
            // In a corner of a picture a face may be one place too late; its neighbour is so near that this is not visible.
            EXPECT_LT(havs.report.late_faces, 1e-4 * static_cast<double>(havs.report.fragments));
            EXPECT_LT(largest_difference(havs.image, rays.image), kGlTol);
        }
    }
}

TEST_F(RenderHavs, MoreEntriesAreNeverWorse) {
    const HexMesh mesh = flat_box();
    const auto values = evaluate(mesh, waves);
    const Optics optics = ramp_optics(0.05);
    const auto rays = render_tets(valued(mesh, values), {}, flat_view(), optics);
    std::size_t late = 0;
    double error = 0;
    for (const int k : {1, 2, 3, 4, 6, 8, 12, 16, 32, 64}) {
        const auto havs =
            render_projected(valued(mesh, values), {}, flat_view(), optics, {.order = ProjectedOrder::Havs, .kbuffer = k});
        const double rms = rms_difference(havs.image, rays.image);
        EXPECT_EQ(havs.report.late_faces == 0, havs.report.violations == 0u);
        EXPECT_LE(*havs.report.violations, havs.report.late_faces);
        if (k == 1) {
            EXPECT_GT(havs.report.late_faces, 1000u);
            EXPECT_GT(rms, 1e-2);
        } else {
            EXPECT_LE(havs.report.late_faces, late) << k;
            EXPECT_LE(rms, error + kFewTol) << k;
        }
        late = havs.report.late_faces;
        error = rms;
    }
    EXPECT_EQ(late, 0u);
    EXPECT_LT(error, kGlTol);
}

TEST_F(RenderHavs, GapsBetweenPartsStayEmpty) {
    const HexMesh slabs = two_slabs();
    const View along({.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = 0.99}, 40, 40);
    const View across({.eye = {4, 0.4, 0.6}, .target = {0.5, 0.4, 0.5}, .up = {0, 0, 1}, .fovy_deg = 15}, 64, 64);
    for (const double lod : {0.0, 0.5, 1.0}) {
        const ProjectedOptions havs{.order = ProjectedOrder::Havs, .lod = lod};
        // Two fifths of a unit, with an opacity of one half for each unit.
        const auto drawn = render_projected(valued(slabs, 1.0), {}, along, constant_optics(), havs);
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 40; ++x) ASSERT_NEAR(drawn.image.pixel(x, y)[3], 1 - std::pow(0.5, 0.4), kFewTol) << lod;
        }
        for (const HexMesh& mesh : {slabs, l_shape(6)}) {
            const std::vector<double> ones(mesh.points.size(), 1.0);
            for (const View& view : {across, slanted_view(64)})
                EXPECT_LT(difference_from_rays(mesh, ones, view, constant_optics(), havs), kFewTol) << lod;
        }
    }
    const HexMesh corner = l_shape(6);
    EXPECT_LT(difference_from_rays(corner, evaluate(corner, waves), slanted_view(64), ramp_optics(0.1),
                                   {.order = ProjectedOrder::Havs}),
              kGlTol);
}

TEST_F(RenderHavs, PartsThatTouchKeepTheirValues) {
    // Two boxes side by side without common points; the second is numbered backwards, so diagonals differ on the faces between.
    HexMesh mesh = box(3);
    const auto count = static_cast<Index>(mesh.points.size());
    const std::size_t cells = mesh.cells.size();
    mesh.points.resize(2 * std::size_t{count});
    for (Index p = 0; p < count; ++p) mesh.points[2 * std::size_t{count} - 1 - p] = mesh.points[p] + Vec3(1, 0, 0);
    for (std::size_t c = 0; c < cells; ++c) {
        auto cell = mesh.cells[c];
        for (Index& p : cell) p = 2 * count - 1 - p;
        mesh.cells.push_back(cell);
    }
    const auto values = evaluate(mesh, waves);
    for (const View& view : {slanted_view(64), orthographic_view(61, 47)})
        EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1), {.order = ProjectedOrder::Havs}), kGlTol);
}

TEST_F(RenderHavs, EyeInsideSeesOnlyWhatIsInFront) {
    const HexMesh mesh = jittered_box(4, 0.2, 3);
    const auto values = evaluate(mesh, waves);
    const Camera inside{.eye = {0.43, 0.37, 0.52}, .target = {0.9, 0.8, 0.3}, .up = {0, 0, 1}, .fovy_deg = 80};
    Camera flat = inside;
    flat.ortho_height = 1.1;
    for (const Camera& camera : {inside, flat}) {
        const View view(camera, 48, 40);
        EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1), {.order = ProjectedOrder::Havs}), kGlTol);
        // A constant field stays constant where faces are left out.
        EXPECT_LT(difference_from_rays(mesh, std::vector<double>(values.size(), 1.0), view, constant_optics(),
                                       {.order = ProjectedOrder::Havs, .lod = 0}),
                  kFewTol);
    }
}

TEST_F(RenderHavs, EveryDepthCountsOnceWhereCellsFoldOver) {
    const HexMesh mesh = jittered_box(5, 0.9, 4);
    const auto havs = render_projected(valued(mesh, 1.0), {}, slanted_view(64), constant_optics(),
                                       {.order = ProjectedOrder::Havs, .kbuffer = kAll});
    EXPECT_GT(havs.report.inverted_tets, 0u);
    const auto whole = render_tets(valued(box(1), 1.0), {}, slanted_view(64), constant_optics());
    EXPECT_LT(largest_difference(havs.image, whole.image), kFewTol);
}

TEST_F(RenderHavs, ErrorFallsWithTheFractionOfFaces) {
    const HexMesh mesh = jittered_box(10, 0.2, 5);
    const auto values = evaluate(mesh, waves);
    const Optics optics = ramp_optics(0.2);
    ProjectedRenderer renderer(valued(mesh, values));
    const auto all = renderer.draw(slanted_view(96), optics, {.order = ProjectedOrder::Havs});
    // Squares of the errors of single faces that are left out add up. Where neighbours are left out, each costs more, as the
    // field is further from a line on a longer stretch: the square falls faster than the number of faces left out.
    double last = std::numeric_limits<double>::infinity();
    std::size_t faces = 0;
    for (const double lod : {0.0, 0.02, 0.1, 0.3, 0.6, 0.9}) {
        const auto part = renderer.draw(slanted_view(96), optics, {.order = ProjectedOrder::Havs, .lod = lod});
        const double error = rms_difference(part.image, all.image);
        const double of_each = error * error / static_cast<double>(all.report.faces - part.report.faces_drawn);
        EXPECT_LT(of_each, last) << lod;
        EXPECT_GT(error, 0) << lod;
        EXPECT_GT(part.report.faces_drawn, faces);
        last = of_each;
        faces = part.report.faces_drawn;
    }
    EXPECT_LT(faces, all.report.faces);
    EXPECT_EQ(renderer.draw(slanted_view(96), optics, {.order = ProjectedOrder::Havs, .lod = 1}).image.rgba, all.image.rgba);
}

TEST_F(RenderHavs, InPartsItIsTheSame) {
    const HexMesh mesh = ball(5);
    const auto values = evaluate(mesh, waves);
    const auto draw = [&](std::size_t bytes) {
        return render_projected(valued(mesh, values), {}, ball_view(50, 40), ramp_optics(0.1),
                                {.order = ProjectedOrder::Havs, .kbuffer = 2, .list_bytes = bytes});
    };
    const auto whole = draw(1 << 28), parts = draw(12 * 2000);
    EXPECT_EQ(whole.report.parts, 1u);
    EXPECT_GT(parts.report.parts, 2u);
    EXPECT_EQ(parts.image.rgba, whole.image.rgba);
    EXPECT_EQ(parts.report.late_faces, whole.report.late_faces);
}

TEST_F(RenderHavs, IsTheSameInEveryLocale) {
    const HexMesh mesh = box(3);
    const auto values = evaluate(mesh, waves);
    const auto draw = [&](ProjectedOrder order) {
        return render_projected(valued(mesh, values), {}, slanted_view(64), ramp_optics(0.1), {.order = order}).image.rgba;
    };
    const auto havs = draw(ProjectedOrder::Havs), lists = draw(ProjectedOrder::Lists);
    const CommaLocale comma;  // the shaders' texts have numbers in them
    EXPECT_EQ(draw(ProjectedOrder::Havs), havs);
    EXPECT_EQ(draw(ProjectedOrder::Lists), lists);
}

TEST_F(RenderHavs, RealMeshesAreLikeRays) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    expect_real_meshes_like_rays(*data, {.order = ProjectedOrder::Havs, .kbuffer = kAll});
}

TEST_F(RenderHavs, RefusesWrongOptions) {
    const HexMesh mesh = box(1);
    ProjectedRenderer renderer(valued(mesh, 1.0));
    for (const ProjectedOptions& options : {ProjectedOptions{.order = ProjectedOrder::Havs, .kbuffer = 0},
                                            {.order = ProjectedOrder::Havs, .lod = -0.1},
                                            {.order = ProjectedOrder::Havs, .lod = 1.1},
                                            {.order = ProjectedOrder::Lists, .lod = 0.5},
                                            {.samples = 0},
                                            {.samples = 17}}) {
        EXPECT_THROW((void)renderer.draw(slanted_view(4), constant_optics(), options), Error);
    }
}

}  // namespace render_havs_test
}  // namespace subvol
