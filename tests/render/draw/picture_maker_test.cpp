// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_maker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/boundary_shading.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/render_tets.h"
#include "subvol/split.h"

namespace subvol {
namespace picture_maker_test {

const HexMesh& ball() {
    static const HexMesh mesh = make_model("ball", 3);
    return mesh;
}

Optics optics_of(Look look) {
    return picture_optics({.look = look}, bounds(ball()), {0, 1}, {0, 1});
}

View view_of(const Box& box) {
    return {fit_camera(box, {0.3, 1, -0.4}), 32, 24};
}

MethodOptions solid_by(Method method) {
    return {.style = {.method = method, .look = {.look = Look::Solid}}, .splat = {.method = SplatMethod::Cpu}};
}

GivenOptions given(const std::set<std::pair<std::string, std::string>>& words) {
    return [words](std::string_view name) -> std::optional<std::string> {
        for (const auto& [option, value] : words) {
            if (option == name) return value;
        }
        return std::nullopt;
    };
}

TEST(OptionUses, NameEveryOptionOnceAndSayWhyOthersDoNotReadIt) {
    std::set<std::string_view> names;
    for (const OptionUse& use : option_uses()) {
        EXPECT_TRUE(names.insert(use.name).second) << use.name;
        EXPECT_NE(use.methods, 0U) << use.name;
        EXPECT_NE(use.bodies, 0U) << use.name;
        const bool by_all = use.methods == (1U << std::size(NameTable<Method>::rows)) - 1;
        EXPECT_NE(use.reason.empty(), !by_all) << use.name;
    }
}

TEST(OptionUses, AnOptionWithoutEffectIsRefusedByItsName) {
    const auto refusal = [](Method method, BodyKind body, const GivenOptions& options, OptionNames names) -> std::string {
        try {
            check_options(bit(method), body, options, names);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    const auto order = given({{"order", "havs"}});
    EXPECT_EQ(refusal(Method::Projected, BodyKind::Mesh, order, OptionNames::Flags), "");
    EXPECT_EQ(refusal(Method::Tets, BodyKind::Mesh, order, OptionNames::Flags),
              "--order: has no effect with method 'tets': it does not sort tetrahedra (methods that use it: pt)");
    EXPECT_EQ(refusal(Method::Splat, BodyKind::Kernels, given({{"per-edge", "2"}}), OptionNames::Keywords),
              "per_edge: has no effect on points");
}

TEST(PictureSettings, EachOptionIsDescribedAndSaysWithWhichOthersItHasAnEffect) {
    PictureSettings settings;
    const auto refusal = [&](const GivenOptions& options) -> std::string {
        try {
            check_needs(options_of(settings), options, OptionNames::Flags);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(given({{"tolerance-image", ".1"}, {"levels", "1"}})),
              "--tolerance-image: has no effect with --levels (leave one of them out)");
    EXPECT_EQ(refusal(given({{"kbuffer", "3"}})), "--kbuffer: has no effect without --order havs");
    EXPECT_EQ(refusal(given({{"kbuffer", "3"}, {"seconds", "1"}})), "");
    EXPECT_EQ(refusal(given({{"device", "0"}, {"backend", "cpu"}})),
              "--device: has no effect with --backend cpu (leave one of them out)");
}

TEST(PictureSettings, AMethodHasTheOptionsThatItReadsFromAMesh) {
    PictureSettings settings;
    const auto has = [&](Method method, const char* name) {
        return std::ranges::any_of(options_of(settings, method), [&](const Option& option) { return option.name == name; });
    };
    EXPECT_TRUE(has(Method::Splat, "per-edge"));
    EXPECT_FALSE(has(Method::Tets, "per-edge"));
    EXPECT_TRUE(has(Method::Tets, "levels"));
    EXPECT_FALSE(has(Method::Splat, "memory"));  // of bricks
}

TEST(OptionUses, WithSeveralMethodsOneThatReadsAnOptionIsEnough) {
    const Methods able = methods_of(BodyKind::Mesh);
    EXPECT_NO_THROW(check_options(able, BodyKind::Mesh, given({{"per-edge", "2"}})));
    EXPECT_THROW(check_options(able, BodyKind::Tets, given({{"per-edge", "2"}})), Error);
}

TEST(PictureMaker, ASolidByTetrahedraIsTheirPictureWithTheLightOfTheBoundary) {
    const View view = view_of(bounds(ball()));
    const Optics optics = optics_of(Look::Solid);
    Image expected =
        TetsRenderer(on_limit(refine(ball(), {.levels = 1}), Scheme::Mcq)).draw(view, optics, {.samples = 2}).image;
    const BoundaryValues skin = boundary_values(ball(), {.levels = picture_levels(ball())});
    light_boundary(expected, skin.surface, view, Shading{}, 2);
    Picture picture = PictureMaker({.mesh = ball()}, solid_by(Method::Tets)).draw(view, optics);
    EXPECT_EQ(picture.image.rgba, expected.rgba);
    ASSERT_NE(picture.facts.find("tets"), nullptr);
    EXPECT_EQ(std::get<std::uint64_t>(picture.facts.find("tets")->value), ball().cells.size() * 8 * 6);
}

std::uint64_t number_in(const Facts& facts, const char* key) {
    return std::get<std::uint64_t>(facts.find(key)->value);
}

TEST(PictureMaker, AnOpaqueSolidIsDrawnByItsFirstHitsAsItsKernelsAndItsBoundaryShowIt) {
    const View view = view_of(bounds(ball()));
    const Optics optics = optics_of(Look::Solid);
    MethodOptions through_kernels = solid_by(Method::Splat);
    through_kernels.image_tolerance = 1e-3;
    const Picture drawn = PictureMaker({.mesh = ball()}, solid_by(Method::Splat)).draw(view, optics);
    const Picture expected = PictureMaker({.mesh = ball()}, through_kernels).draw(view, optics);
    EXPECT_EQ(number_in(drawn.facts, "sheets"), 0U);
    EXPECT_NE(expected.facts.find("sheets"), nullptr);
    EXPECT_EQ(expected.facts.find("triangles"), nullptr);
    std::size_t inside = 0, differ = 0;
    for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
        const float *a = &drawn.image.rgba[4 * i], *b = &expected.image.rgba[4 * i];
        if (a[3] < 1 || b[3] < 0.9999F) {
            differ += std::abs(a[3] - b[3]) > 0.5F;  // two of four rays, at the outline
            continue;
        }
        ++inside;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-3) << i;
        EXPECT_NEAR(drawn.depth[i], expected.depth[i], 2e-2 * bounds(ball()).diagonal()) << i << ": light ends a little behind";
    }
    EXPECT_GT(inside, 100U);
    EXPECT_EQ(differ, 0U);
}

TEST(PictureMaker, ASolidThatIsCutOpenIsDrawnByItsFirstHitsAsItsKernelsShowIt) {
    HexMesh mesh = ball();
    mesh.attributes = {{.name = "p", .values = {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(.5 + .3 * std::sin(2 * p.x + p.y) * p.z);
    const View view({.eye = {0, 0, 9}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 14}, 48, 48);
    for (const double mean : {0.0, 101325.0}) {  // kernels are relative to large means
        HexMesh shown = mesh;
        for (double& value : shown.attributes[0].values) value = mean + (mean > 0 ? .01 * value : value);
        const double half = mean > 0 ? .01 : 1;
        const Optics colors = picture_optics({.look = Look::Solid}, bounds(mesh), {mean, mean + half}, {mean, mean + half});
        MethodOptions cut = solid_by(Method::Splat);
        cut.style.clip.planes.push_back({.point = {0, 0, .2}, .normal = {0, .1, 1}});
        MethodOptions through_kernels = cut;
        through_kernels.image_tolerance = 1e-4;
        const Picture drawn = PictureMaker({.mesh = shown}, cut).draw(view, colors);
        const Picture expected = PictureMaker({.mesh = shown}, through_kernels).draw(view, colors);
        EXPECT_EQ(number_in(drawn.facts, "sheets"), 0U);
        for (int y = 12; y < 36; ++y) {  // the edge of the cut lies outside
            for (int x = 12; x < 36; ++x) {
                for (std::size_t c = 0; c < 4; ++c)
                    EXPECT_NEAR(drawn.image.pixel(x, y)[c], expected.image.pixel(x, y)[c], 2e-3)
                        << mean << ' ' << x << ' ' << y;
            }
        }
        // Another cut of the same maker, and none
        PictureMaker kept({.mesh = shown}, cut);
        (void)kept.draw(view, colors);
        MethodOptions other = cut;
        other.style.clip.planes[0].point.z = -.1;
        kept.set_style(other.style);
        EXPECT_EQ(kept.draw(view, colors).image.rgba, PictureMaker({.mesh = shown}, other).draw(view, colors).image.rgba);
        other.style.clip = {};
        kept.set_style(other.style);
        EXPECT_EQ(kept.draw(view, colors).image.rgba, PictureMaker({.mesh = shown}, other).draw(view, colors).image.rgba);
    }
}

TEST(PictureMaker, WhereTheEyeIsInsideASolidItsKernelsAreDrawn) {
    const Optics optics = optics_of(Look::Solid);
    const View inside({.eye = {0, 0, 0}, .target = {1, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 40}, 32, 32);
    const Picture picture = PictureMaker({.mesh = ball()}, solid_by(Method::Splat)).draw(inside, optics);
    EXPECT_EQ(picture.facts.find("triangles"), nullptr);
    EXPECT_GT(picture.image.pixel(16, 16)[3], 0.99F) << "the material around the eye";
}

// The faces of a cube in one colour: linear light of the brightest face for that of the darkest one.
double contrast_of_cube(Method method, bool clipped) {
    HexMesh cube = test::make_box(2, 2, 2);
    cube.attributes.push_back({.name = "density", .values = std::vector<double>(cube.points.size(), 1.0)});
    const Box box = bounds(cube);
    MethodOptions options = solid_by(method);
    if (clipped) options.style.clip.planes.push_back({.point = {1, 1, 1.9}, .normal = {0, 0, 1}});
    const Optics optics = picture_optics({.look = Look::Solid}, box, {1, 1}, {1, 1});
    const Image image = PictureMaker({.mesh = cube}, options).draw({fit_camera(box, {-1, 1, -1.3}), 60, 60}, optics).image;
    std::vector<float> greens;
    for (std::size_t pixel = 0; pixel < image.rgba.size(); pixel += 4) {
        if (image.rgba[pixel + 3] > 0.999F) greens.push_back(image.rgba[pixel + 1]);
    }
    std::ranges::sort(greens);
    return double{greens[greens.size() * 19 / 20]} / double{greens[greens.size() / 20]};
}

TEST(PictureMaker, FacesOfABodyInOneColourDifferByEveryMethod) {
    for (const Method method : {Method::Splat, Method::Tets, Method::Dense}) {
        EXPECT_GT(contrast_of_cube(method, false), 2) << name_of(method);
        EXPECT_GT(contrast_of_cube(method, true), 2) << name_of(method);
    }
}

TEST(PictureMaker, LightFollowsWhenTheColoursBecomeOne) {
    const View view = view_of(bounds(ball()));
    const Optics colored = optics_of(Look::Solid);
    const Optics plain = picture_optics({.look = Look::Solid}, bounds(ball()), {1, 1}, {1, 1});
    const auto fresh = [&](const Optics& optics) {
        return PictureMaker({.mesh = ball()}, solid_by(Method::Splat)).draw(view, optics).image.rgba;
    };
    PictureMaker kept({.mesh = ball()}, solid_by(Method::Splat));
    for (const Optics& optics : {colored, plain, colored}) EXPECT_EQ(kept.draw(view, optics).image.rgba, fresh(optics));
}

/// The root of the mean square of the differences of colours and opacities.
double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

TEST(PictureMaker, AFieldWithALargeMeanLooksLikeTheFieldLessItsMean) {
    constexpr double kMean = 101325, kHalf = .01;
    HexMesh small = ball();
    small.attributes = {{.name = "p", .values = {}}};
    for (const Vec3& p : small.points) small.attributes[0].values.push_back(kHalf * std::sin(3 * p.x + p.y));
    HexMesh large = small;
    for (double& value : large.attributes[0].values) value += kMean;
    const Box box = bounds(ball());
    const View view = view_of(box);
    const auto draw = [&](const HexMesh& mesh, Look look, double mean, SplatMethod backend, bool occlusion = false) {
        MethodOptions options = solid_by(Method::Splat);
        options.style.look.look = look;
        options.splat.method = backend;
        options.splat.ambient_occlusion = occlusion ? .1 : 0;
        const Optics optics = picture_optics({.look = look}, box, {mean - kHalf, mean + kHalf}, {mean - kHalf, mean + kHalf});
        return PictureMaker({.mesh = mesh}, options).draw(view, optics).image;
    };
    std::vector<SplatMethod> backends{SplatMethod::Cpu};
    if (find_gl_device()) backends.push_back(SplatMethod::Gl);
    for (const SplatMethod backend : backends) {
        for (const Look look : {Look::Solid, Look::Volume, Look::Isosurface}) {
            // A double holds 101325 to 1.5e-11, which is 1e-9 of the range; knots are 1e-9 of it apart where they are a jump.
            EXPECT_LT(rms(draw(small, look, 0, backend), draw(large, look, kMean, backend)), 1e-5) << name_of(look);
        }
        EXPECT_LT(rms(draw(small, Look::Solid, 0, backend, true), draw(large, Look::Solid, kMean, backend, true)), 1e-5);
    }
}

TEST(PictureMaker, OriginsFollowTheRangeOfTheColours) {
    HexMesh mesh = ball();
    mesh.attributes = {{.name = "p", .values = {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(1e6 + p.x);
    const View view = view_of(bounds(ball()));
    const auto optics = [&](double min, double max) {
        return picture_optics({.look = Look::Volume, .range = ValueRange{min, max}, .stretch = true}, bounds(ball()),
                              {min, max}, {min, max});
    };
    MethodOptions options = solid_by(Method::Splat);
    options.style.look.look = Look::Volume;
    PictureMaker kept({.mesh = mesh}, options);
    EXPECT_TRUE(kept.keeps_kernels(optics(0, 2e6)));
    EXPECT_FALSE(kept.keeps_kernels(optics(1e6 - .5, 1e6 + .5)));
    for (const double half : {1e6, .5, .01, 1e6, .5}) {
        const Optics one = optics(1e6 - half, 1e6 + half);
        EXPECT_EQ(kept.draw(view, one).image.rgba, PictureMaker({.mesh = mesh}, options).draw(view, one).image.rgba) << half;
    }
}

TEST(PictureMaker, BodiesBelowAPixelAreSaid) {
    HexMesh mesh = test::make_box(1, 1, 1);
    const auto add_box = [&](const Vec3& at, double size) {
        const HexMesh box = test::make_box(1, 1, 1);
        const auto first = static_cast<Index>(mesh.points.size());
        for (const Vec3& p : box.points) mesh.points.push_back(at + size * p);
        auto cell = box.cells[0];
        for (Index& corner : cell) corner += first;
        mesh.cells.push_back(cell);
    };
    const auto warnings = [&] {
        mesh.attributes = {{.name = "f", .values = std::vector<double>(mesh.points.size(), 1.0)}};
        const Optics optics = picture_optics({.look = Look::Solid}, bounds(mesh), {1, 1}, {1, 1});
        const View view({.eye = {.5, -20, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = 12}, 60,
                        60);  // 5 pixels a unit
        const Facts facts = PictureMaker({.mesh = mesh}, solid_by(Method::Tets)).draw(view, optics).facts;
        std::string all;
        if (const FactValue* found = facts.find("warnings")) {
            for (const FactValue& one : std::get<FactValue::List>(found->value)) all += std::get<std::string>(one.value) + "\n";
        }
        return all;
    };
    EXPECT_EQ(warnings().find("pixel"), std::string::npos);
    add_box({4, 0, 4}, .1);     // half a pixel
    add_box({-4, 0, -4}, .19);  // a little less than one
    add_box({3, 0, -3}, .21);   // a little more
    add_box({90, 0, 0}, .1);    // beside the picture
    EXPECT_NE(warnings().find("2 of 5 bodies in the picture are smaller than a pixel"), std::string::npos) << warnings();
    for (int i = 0; i < 20; ++i) {
        for (int k = 0; k < 20; ++k) add_box({-3 + .1 * i, 0, .1 * k}, .1);  // cells side by side that share no points
    }
    EXPECT_NE(warnings().find("2 of 405 bodies"), std::string::npos) << warnings();
}

TEST(PictureMaker, StylesAndBodiesChangeBetweenPictures) {
    const View view = view_of(bounds(ball()));
    PictureMaker maker({.mesh = ball()}, solid_by(Method::Splat));
    const Picture first = maker.draw(view, optics_of(Look::Solid));
    maker.set_style({.method = Method::Splat, .look = {.look = Look::Volume}});
    const Picture volume = maker.draw(view, optics_of(Look::Volume));
    EXPECT_NE(volume.image.rgba, first.image.rgba);
    const HexMesh twist = make_model("twist", 3);
    maker.set_body({.mesh = twist});
    EXPECT_NE(maker.draw(view, optics_of(Look::Volume)).image.rgba, volume.image.rgba);
    maker.set_body({.mesh = ball()});
    maker.set_style(solid_by(Method::Splat).style);
    EXPECT_EQ(maker.draw(view, optics_of(Look::Solid)).image.rgba, first.image.rgba);
}

class PictureMakerOfBricks : public test::TempFolder {};

TEST_F(PictureMakerOfBricks, StylesChangeBetweenPictures) {
    const Bricks bricks = split_mesh(path("ball.bricks"), ball(), {.bricks = 3}).bricks;
    const View view = view_of(bounds(ball()));
    const PictureBody body{.mesh = source_of(bricks)};
    for (const Method method : {Method::Splat, Method::Tets}) {
        const auto alone = [&](Look look) {
            MethodOptions options = solid_by(method);
            options.style.look.look = look;
            return PictureMaker(body, options).draw(view, optics_of(look)).image.rgba;
        };
        MethodOptions options = solid_by(method);
        options.style.look.look = Look::Volume;
        PictureMaker maker(body, options);
        for (const Look look : {Look::Volume, Look::Solid, Look::Volume}) {
            options.style.look.look = look;
            maker.set_style(options.style);
            EXPECT_EQ(maker.draw(view, optics_of(look)).image.rgba, alone(look)) << name_of(method) << " " << name_of(look);
        }
    }
}

TEST(PictureMaker, OptionsOutOfRangeAreRefusedByTheirNames) {
    const auto refuses = [](const char* name, const auto& change) {
        MethodOptions options = solid_by(Method::Splat);
        change(options);
        test::expect_error(ErrorCode::InvalidInput, name, [&] { validate(options); });
    };
    refuses("samples: 17 is out of range (1 to 16)", [](MethodOptions& o) { o.style.samples = 17; });
    refuses("sheets: 1 is out of range", [](MethodOptions& o) { o.splat.sheets = 1; });
    refuses("kbuffer: 0 is out of range", [](MethodOptions& o) { o.kbuffer = 0; });
    refuses("--threshold: has no effect with --seconds", [](MethodOptions& o) {
        o.seconds = 1;
        o.drop_invisible = true;
    });
    refuses("--levels: has no effect with --seconds", [](MethodOptions& o) {
        o.seconds = 1;
        o.kernels.levels = 1;
    });
}

TEST(PictureMaker, WhatAnOptionIsDecidesWhetherTheBoundaryIsPainted) {
    const auto painted = [](const MethodOptions& options) { return PictureMaker({.mesh = ball()}, options).paints_boundary(); };
    MethodOptions options = solid_by(Method::Splat);
    EXPECT_TRUE(painted(options));
    options.kernels.sample.per_edge = 1;
    EXPECT_TRUE(painted(options)) << "as without the option";
    options.kernels.sample.per_edge = 2;
    EXPECT_FALSE(painted(options));
    options = solid_by(Method::Splat);
    options.style.look.opacity = {{0, 0.5}};
    EXPECT_FALSE(painted(options));
    options = solid_by(Method::Splat);
    options.kernels.sample.kernel = GaussianKernel{};
    EXPECT_FALSE(painted(options));
}

TEST(PictureMaker, WhatAMethodCannotDrawIsRefusedBeforeAnyWork) {
    EXPECT_THROW(PictureMaker({.mesh = ball()}, solid_by(Method::Grid)), Error);
    MethodOptions lit = solid_by(Method::Dense);
    lit.style.look.look = Look::Isosurface;
    EXPECT_THROW(PictureMaker({.mesh = ball()}, lit), Error);
    MethodOptions lod = solid_by(Method::Projected);
    lod.lod = 0.5;
    EXPECT_THROW(PictureMaker({.mesh = ball()}, lod), Error);
}

}  // namespace picture_maker_test
}  // namespace subvol
