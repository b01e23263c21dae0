// SPDX-License-Identifier: Apache-2.0
// The splatter on a GPU by how its work is divided: tiles, batches of sheets, iterations of a dispatch. Times of a later
// picture of several, by the device; the picture is the same whatever the division.
//
//   gl_splats [MODEL[:N]=pawn] [SIZE=512] [SHEETS=200]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "gl_splatter.h"
#include "measure.h"
#include "splat_scene.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;
using namespace subvol::detail;

void measure(const SplatScene& scene, const View& view, const Classification& classification, int sheets,
             const GlTuning& tuning) {
    GlSplatter splatter(scene, {}, tuning);
    double wall = 1e30;
    GlSplatReport report;
    for (int i = 0; i < 12; ++i) {
        const double seconds = bench::seconds_of([&] { (void)splatter.draw(view, classification, sheets, nullptr); }, 1);
        if (seconds < wall) report = splatter.report();
        wall = std::min(wall, seconds);
    }
    std::printf("tile %2d, batch %2d, 2^%.0f steps: %6.2f ms,", tuning.tile_px, tuning.batch, std::log2(tuning.most_steps),
                1e3 * wall);
    for (const StageTime& stage : report.stages) std::printf(" %s %.2f", stage.stage.c_str(), 1e3 * stage.seconds);
    std::printf("; %zu entries, %zu dispatches\n", report.bin_entries, report.dispatches);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string name = argc > 1 ? argv[1] : "pawn";
    const int size = argc > 2 ? std::atoi(argv[2]) : 512, sheets = argc > 3 ? std::atoi(argv[3]) : 200;
    try {
        const std::size_t colon = name.find(':');
        const int n = colon == std::string::npos ? 0 : std::atoi(name.c_str() + colon + 1);
        const RbfVolume volume = sample_rbf_points(make_model(name.substr(0, colon), n)).volume;
        const Box box = box_of(volume);
        const Optics optics(
            {.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .05}, {0, .02}, {1, .3}}},
            box.diagonal() / 100);
        const SplatScene scene = make_scene(volume, {});
        const View view(fit_camera(box, Vec3(-1, 1, -1)), size, size);
        const Classification classification = classify(scene, optics);
        std::printf("%s, %zu kernels, %d², %d sheets, %s\n", name.c_str(), volume.size(), size, sheets,
                    find_gl_device() ? find_gl_device()->renderer.c_str() : "no device");
        for (const int tile : {16, 8}) {
            for (const int batch : {2, 4, 8}) measure(scene, view, classification, sheets, {.tile_px = tile, .batch = batch});
        }
        for (const std::uint32_t steps : {1U << 14, 1U << 16, 1U << 20})
            measure(scene, view, classification, sheets, {.tile_px = 8, .batch = 4, .most_steps = steps});
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    }
}
