// SPDX-License-Identifier: Apache-2.0
#include "subvol/lines_in_volume.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/boundary_values.h"
#include "subvol/picture_maker.h"
#include "subvol/shell_scene.h"

namespace subvol {
namespace lines_in_volume_test {

constexpr int kSize = 32;
constexpr double kSide = 2;  // of the box
const Vec3 kWhite(1.0);

/// A box of side 2 about the origin, of the value 1, whose limit by the linear scheme is the box.
HexMesh box() {
    HexMesh mesh = test::make_box(2, 2, 2);
    for (Vec3& p : mesh.points) p -= Vec3(1.0);
    mesh.attributes = {{"one", 1, std::vector<double>(mesh.points.size(), 1.0)}};
    return mesh;
}

/// From +x, at the depth 5 of the box's middle.
View view() {
    return {{.eye = {5, 0, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, kSize, kSize};
}

/// Black, of the same extinction everywhere: alpha after the unit length.
Optics black(double alpha) {
    return {TransferFunction{.color = {{0, Vec3(0.0)}, {2, Vec3(0.0)}}, .opacity = {{0, alpha}, {2, alpha}}}, 1.0};
}

PictureMaker maker_of(const HexMesh& mesh, Method method) {
    MethodOptions options;
    options.style = {.method = method, .look = {.look = Look::Volume}};
    options.kernels.sample.scheme.kind = Scheme::Linear;
    return {{.mesh = mesh}, options};
}

/// A bar across the picture at a depth, half of whose upper row of pixels is covered.
std::vector<LineSample> bar_at(double depth) {
    std::vector<LineSample> bar;
    for (const auto& [row, cover] : {std::pair{15U, .5F}, {16U, 1.0F}}) {
        for (std::uint32_t x = 8; x < 24; ++x) bar.push_back({row * kSize + x, true, static_cast<float>(depth), 0, cover});
    }
    return bar;
}

float red(const Image& image, int y) {
    return image.pixel(kSize / 2, y)[0];
}

Image drawn(PictureMaker& maker, const Optics& optics, const HexMesh& mesh, std::span<const LineSample> lines) {
    Image image = maker.draw(view(), optics).image;
    const Surface boundary = boundary_of(mesh, {.scheme = {.kind = Scheme::Linear}}, 0);
    const SortedLines sorted = sort_lines(lines, boundary, view());
    std::vector<Image> ended;
    for (const LineLayer& layer : sorted.within) ended.push_back(maker.draw(ended_at(layer, view()), optics).image);
    draw_lines(image, sorted, ended, kWhite);
    return image;
}

class LinesInVolume : public testing::TestWithParam<Method> {};

// White lines in black smoke: a pixel is as bright as the smoke before the line lets through, (1 − alpha)^length.
TEST_P(LinesInVolume, AreSeenThroughWhatIsBeforeThem) {
    constexpr double kTol = 4e-3;  // of kernels on sheets
    const HexMesh mesh = box();
    for (const double alpha : {.3, .8}) {
        PictureMaker maker = maker_of(mesh, GetParam());
        const Optics optics = black(alpha);
        for (const double length : {-1.0, 0.0, .5, 1.0, 1.6, kSide, 3.0}) {
            const double inside = std::clamp(length, 0.0, kSide);
            const Image image = drawn(maker, optics, mesh, bar_at(4 + length));
            const double seen = std::pow(1 - alpha, inside);
            EXPECT_NEAR(red(image, 16), seen, kTol) << length;
            EXPECT_NEAR(red(image, 15), .5 * seen, kTol) << "a pixel that is covered in part has no seam, at " << length;
            const double through = std::pow(1 - alpha, kSide);
            EXPECT_NEAR(image.pixel(kSize / 2, 15)[3], 1 - .5 * through, kTol) << length;
        }
    }
}

TEST_P(LinesInVolume, AreHiddenByADenseBodyAndWholeBeforeIt) {
    const HexMesh mesh = box();
    PictureMaker maker = maker_of(mesh, GetParam());
    const Optics optics = black(.99999);
    EXPECT_NEAR(red(drawn(maker, optics, mesh, bar_at(3.5)), 16), 1, 1e-6);
    EXPECT_LT(red(drawn(maker, optics, mesh, bar_at(5.5)), 16), 1e-3);
    EXPECT_LT(red(drawn(maker, optics, mesh, bar_at(7)), 16), 1e-3);
}

TEST_P(LinesInVolume, LieOneBehindTheOther) {
    const HexMesh mesh = box();
    PictureMaker maker = maker_of(mesh, GetParam());
    std::vector<LineSample> both = bar_at(5.5);
    for (LineSample line : bar_at(4.5)) {
        line.cover *= .5F;
        both.push_back(line);
    }
    const double near = std::pow(.7, .5), far = std::pow(.7, 1.5);
    EXPECT_NEAR(red(drawn(maker, black(.3), mesh, both), 16), .5 * near + .5 * far, 4e-3);
    EXPECT_NEAR(red(drawn(maker, black(.3), mesh, both), 15), .25 * near + .75 * .5 * far, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(Methods, LinesInVolume, testing::Values(Method::Splat, Method::Tets, Method::Dense),
                         [](const auto& method) { return std::string(name_of(method.param)); });

TEST(SortLines, ThoseWithinTheirSlackAreOnTheBoundary) {
    const HexMesh mesh = box();
    const Surface boundary = boundary_of(mesh, {.scheme = {.kind = Scheme::Linear}}, 0);
    const auto sorted = [&](float depth, float slack, bool faces_eye) {
        const std::vector<LineSample> line{{16 * kSize + 16, faces_eye, depth, slack, 1}};
        const SortedLines lines = sort_lines(line, boundary, view());
        return std::array{lines.before.size(), lines.within.size(), lines.behind.size()};
    };
    using Counts = std::array<std::size_t, 3>;
    EXPECT_EQ(sorted(4.1F, .2F, true), (Counts{1, 0, 0}));
    EXPECT_EQ(sorted(4.3F, .2F, true), (Counts{0, 1, 0}));
    EXPECT_EQ(sorted(4.1F, .2F, false), (Counts{0, 1, 0})) << "a line at the back of the body";
    EXPECT_EQ(sorted(5.9F, .2F, false), (Counts{0, 0, 1}));
    const std::vector<LineSample> beside{{0, true, 5, 0, 1}};
    EXPECT_EQ(sort_lines(beside, boundary, view()).before.size(), 1U) << "nothing is before it";
    View ended = view();
    ended.end_rays(std::vector<float>(kSize * kSize, 4.5F));
    EXPECT_TRUE(sort_lines(bar_at(5), boundary, ended).empty()) << "behind something opaque";
}

// A plate within the body: rays end there, so that it is seen through what is before it.
TEST(ShellsInVolume, AreSeenThroughWhatIsBeforeThem) {
    const HexMesh mesh = box();
    for (const Method method : {Method::Splat, Method::Tets, Method::Dense}) {
        PictureMaker maker = maker_of(mesh, method);
        for (const double x : {-1.5, -.5, .25, 1.5}) {
            ColoredSurface plate;
            plate.surface.points = {{x, -3, -3}, {x, 3, -3}, {x, 3, 3}, {x, -3, 3}};
            plate.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
            plate.values.assign(4, 1.0);
            const Optics light{TransferFunction{.color = {{0, kWhite}, {2, kWhite}}, .opacity = {{0, 1}, {2, 1}}}, 1.0};
            const ShellScene scene = make_opaque_scene(mesh, plate, {.scheme = {.kind = Scheme::Linear}}, 0, light, 1, Clip{});
            Image alone(kSize, kSize), image = maker.draw(ended_at(scene, view()), black(.6)).image;
            draw_shells(alone, {}, plate, {}, view(), light, {.shading = shading_for(light.function())});
            scene.draw_into(image, {}, view());
            const double before = std::clamp(1 - x, 0.0, kSide);
            EXPECT_NEAR(red(image, 16), std::pow(.4, before) * double{red(alone, 16)}, 4e-3) << x;
        }
    }
}

TEST(DrawLines, RefusePicturesThatDoNotFit) {
    Image image(kSize, kSize);
    SortedLines lines;
    lines.within.resize(1);
    test::expect_error(ErrorCode::InvalidInput, "one picture for each layer", [&] { draw_lines(image, lines, {}, kWhite); });
}

}  // namespace lines_in_volume_test
}  // namespace subvol
