// SPDX-License-Identifier: Apache-2.0
// Convergence over levels: pictures of dense grids, and of the tetrahedra of refined meshes, converge to that of the limit with
// the second order of trilinear cells.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "reference_methods.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace level_order_test {

struct Sequence {
    const char* model;
    int resolution;
    double part_of_view;  // < 1 for the ball: without the silhouette, which crosses pixel centres and is of lower order
};
void PrintTo(const Sequence& sequence, std::ostream* out) {
    *out << sequence.model;
}

class Levels : public testing::TestWithParam<Sequence> {};

TEST_P(Levels, AreOfTheSecondOrderByDenseGridsAndByTetrahedra) {
    constexpr int kFinest = 4, kCompared = 3;
    const HexMesh mesh = make_model(GetParam().model, GetParam().resolution);
    const Box box = bounds(mesh);
    Camera camera = fit_camera(box, {-1, 1.3, -0.8});
    camera.fovy_deg *= GetParam().part_of_view;
    const View view(camera, 96, 96);
    const Optics optics(transfer_function_preset("viridis", -1, 1), box.diagonal() / 30);
    const auto dense = [&](int levels) { return render_dense(mesh, {}, view, optics, {.levels = levels}).image; };
    const auto tets = [&](int levels) {
        const HexMesh fine = on_limit(refine(mesh, {.levels = levels}), Scheme::Mcq);
        return render_tets(fine, {}, view, optics).image;
    };
    Image limit = dense(kFinest);
    const Image before = dense(kFinest - 1);
    for (std::size_t i = 0; i < limit.rgba.size(); ++i) limit.rgba[i] += (limit.rgba[i] - before.rgba[i]) / 3;
    const auto order = [&](const std::string& name, const std::function<Image(int)>& draw) {
        std::vector<double> errors;
        for (int l = 1; l <= kCompared; ++l) {
            errors.push_back(test::rmse(draw(l), limit));
            RecordProperty(name + "_rms_1e6_level_" + std::to_string(l), std::to_string(1e6 * errors.back()));
        }
        return std::log2(errors.front() / errors.back()) / (kCompared - 1);
    };
    EXPECT_NEAR(order("dense", dense), 2, 0.25);
    EXPECT_NEAR(order("tets", tets), 2, 0.25);
}

INSTANTIATE_TEST_SUITE_P(Models, Levels, testing::Values(Sequence{"twist", 4, 1}, Sequence{"ball", 2, 0.4}),
                         [](const auto& sequence) { return std::string(sequence.param.model); });

}  // namespace level_order_test
}  // namespace subvol
