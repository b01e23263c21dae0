// SPDX-License-Identifier: Apache-2.0
// The twisted block, of which the exact picture is known: the errors of the methods.
#include <gtest/gtest.h>

#include <cmath>

#include "subvol/model.h"
#include "subvol/reduce.h"
#include "subvol/refine.h"
#include "subvol/render_field.h"
#include "subvol/render_tets.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace twist_test {

constexpr int kCells = 20, kSize_px = 96;

class TwistedBlock : public testing::TestWithParam<bool> {
protected:
    [[nodiscard]] static Optics optics(bool sharp) {
        TransferFunction f{.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                           .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}};
        if (sharp) f.opacity = {{-1, 0}, {.27, 0}, {.30, .9}, {.33, 0}, {1, 0}};
        return {f, 0.1};
    }

    [[nodiscard]] static double rmse(const Image& a, const Image& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.rgba.size(); ++i) {
            if (i % 4 != 3) sum += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2);
        }
        return std::sqrt(sum / (0.75 * double(a.rgba.size())));
    }
};

TEST_P(TwistedBlock, SecondOrderSplatsBeatPlainOnesAndTheTrilinearMesh) {
    const bool sharp = GetParam();
    const Optics optics_used = optics(sharp);
    const View view({.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}}, kSize_px, kSize_px);
    const HexMesh mesh = make_model("twist", kCells);
    Box box = bounds(mesh);
    box.add(box.lower - Vec3(.2));  // the curved block reaches beyond its points
    box.add(box.upper + Vec3(.2));
    const auto exact =
        render_field([](const Vec3& x) { return TwistField{}.value(x); }, box, view, optics_used, {.step_world = .004});

    const auto splat = [&](Correction correction) {
        const auto volume = sample_rbf_points(mesh, {.correction = correction}).volume;
        return rmse(render_splats(volume, view, optics_used, {.method = SplatMethod::Cpu, .sheets = 400}).image, exact);
    };
    const double plain = splat(Correction::None), second = splat(Correction::Second);
    const double trilinear = rmse(render_tets(mesh, {}, view, optics_used).image, exact);
    // At 40 cells and 512² the ratio of plain to second order is 8; with cells twice as large higher orders reduce it.
    EXPECT_LT(second, plain / 3);
    EXPECT_LT(second, trilinear / 3);
    // The second-order error is .0002 and .0014 at 40 cells and grows with the square of the cell size, with room for the third
    // order. It is not 0, so the pictures are not of the same method.
    EXPECT_LT(second, sharp ? .016 : .0024);
    EXPECT_GT(second, 1e-6);
}

TEST_P(TwistedBlock, FewKernelsShowWhatManyShow) {
    const Optics optics_used = optics(GetParam());
    const View view({.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}}, kSize_px, kSize_px);
    const HexMesh mesh = make_model("twist", kCells);
    const auto full = sample_rbf_points(mesh).volume, reduced = reduce_rbf(mesh, {}, {.rmse = .005}).volume;
    EXPECT_LT(reduced.size(), full.size() / 3);
    const auto draw = [&](const RbfVolume& volume) {
        return render_splats(volume, view, optics_used, {.method = SplatMethod::Cpu, .sheets = 400}).image;
    };
    // An error of .005 in values moves the sharp function's opacity, .9 over .03, by up to a sixth: 36 dB where nothing
    // cancels. The smooth one, .3 over .3, hardly changes.
    EXPECT_LT(rmse(draw(reduced), draw(full)), GetParam() ? .016 : .002);
}

INSTANTIATE_TEST_SUITE_P(TransferFunctions, TwistedBlock, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Sharp" : "Smooth"; });

}  // namespace twist_test
}  // namespace subvol
