// SPDX-License-Identifier: Apache-2.0
// Do pictures pop while the camera moves? Changes from frame to frame of a turntable, for splats and for the tetrahedra
// reference. Kernels enter and leave sheets and tiles from frame to frame; if that were visible, splats would change more.
//
//   popping [frames = 72] [size = 256]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "subvol/image_metrics.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/render_tets.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;

/// Root mean square and largest change between neighbouring frames.
void print(const char* name, const std::string& method, const std::vector<Image>& frames) {
    double most_rmse = 0, mean_rmse = 0, most = 0, jerk = 0, last = -1;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const auto change = compare_images(frames[i], frames[(i + 1) % frames.size()]);
        most_rmse = std::max(most_rmse, change.rmse);
        mean_rmse += change.rmse / static_cast<double>(frames.size());
        most = std::max(most, change.max);
        if (last >= 0) jerk = std::max(jerk, std::abs(change.rmse - last));
        last = change.rmse;
    }
    std::printf("%-6s %-6s rmse from frame to frame: mean %.5f  most %.5f  its largest jump %.5f  a pixel's largest %.3f\n",
                name, method.c_str(), mean_rmse, most_rmse, jerk, most);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 72, size = argc > 2 ? std::atoi(argv[2]) : 256;
    for (const char* name : {"ball", "twist", "pawn"}) {
        const HexMesh mesh = make_model(name, std::string(name) == "twist" ? 20 : 0), fine = refine(mesh, {.levels = 1});
        const RbfVolume volume = sample_rbf_points(mesh).volume;
        const auto [low, high] = std::ranges::minmax(mesh.attributes[0].values);
        const double mid = 0.5 * (low + high), peak = 0.05 * (high - low);
        const Optics optics({.color = {{low, {.1, .2, .9}}, {mid, {.9, .9, .9}}, {high, {.9, .2, .1}}},
                             .opacity = {{low, 0}, {mid - peak, 0}, {mid, .8}, {mid + peak, .02}, {high, .1}}},
                            volume.bounds.diagonal() / 100);
        std::vector<Image> splats, tets;
        Splatter splatter(volume, {.method = SplatMethod::Cpu});
        const Camera first = fit_turntable(fit_camera(volume.bounds, Vec3(-1, 1, -.6)), volume.bounds, count);
        for (const Camera& camera : turntable(first, volume.bounds.center(), count)) {
            const View view(camera, size, size);
            splats.push_back(splatter.draw(view, optics).image);
            tets.push_back(render_tets(fine, {}, view, optics).image);
        }
        print(name, "splats", splats);
        print(name, "tets", tets);
    }
}
