// SPDX-License-Identifier: Apache-2.0
// Rays per second through the tetrahedra of the twisted block, with one thread and with all, at 512²; only rays that hit the
// volume count.
//
//   tets_speed [resolution…]
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "measure.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/render_tets.h"

namespace {

using namespace subvol;

constexpr int kSize = 512;
constexpr int kFrames = 5;

/// The best of several frames; wall clock.
double seconds_a_frame(const TetsRenderer& renderer, const View& view, const Optics& optics, int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    double cpu = 1e30;
    const double wall = bench::seconds_of(
        [&] {
            const auto start = std::clock();
            (void)renderer.draw(view, optics);
            cpu = std::min(cpu, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        },
        kFrames);
    std::printf("  %d threads: %.3f s, %.3f CPU-s", threads, wall, cpu);
    return wall;
}

void measure(int resolution) {
    const HexMesh mesh = make_model("twist", resolution);
    const View view({{2.6, -4.2, 2.0}, {-.55, 0, 0}, {0, 0, 1}, 40, 0}, kSize, kSize);
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                         .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
                        0.1);
    const TetsRenderer renderer(mesh);
    const TetsReport report = renderer.draw(view, optics).report;
    const auto rays = static_cast<double>(report.rays);
    std::printf("twist %d: %zu tets, %.0f bytes a tet, built in %.2f s, %zu rays, %.1f tets a ray, %zu lost\n", resolution,
                report.tets, static_cast<double>(report.bytes) / static_cast<double>(report.tets), report.seconds_build,
                report.rays, static_cast<double>(report.segments) / rays, report.lost_rays);
    double one = 0;
    for (const int threads : {1, tbb::info::default_concurrency()}) {
        const double seconds = seconds_a_frame(renderer, view, optics, threads);
        if (threads == 1) one = seconds;
        std::printf(", %.3f M rays/s, %.2f times one thread\n", rays / seconds * 1e-6, one / seconds);
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<int> resolutions;
    for (int i = 1; i < argc; ++i) resolutions.push_back(std::atoi(argv[i]));
    if (resolutions.empty()) resolutions = {40, 64};
    try {
        for (const int resolution : resolutions) measure(resolution);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
