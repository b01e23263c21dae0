// SPDX-License-Identifier: Apache-2.0
// Frames per second of the splatter: the models at two picture sizes, the twisted block from 30 thousand to 4 million points,
// and the cost of overlaps: kernels are widened, so that only the number of kernel–pixel–sheet triples changes.
//
// On a GPU a second line has the time of each stage as the device measures it.
//
//   render_speed [cpu|gl|sheets] [models|sweep|overlaps]
#include <ctime>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "measure.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;

constexpr int kSheets = 200;

int frames = 8;

/// The pixels of all sections of kernels with sheets.
double overlaps(const RbfVolume& volume, const View& view) {
    double z_min = 1e300, z_max = -1e300;
    for (const Vec3& p : volume.boundary.points) {
        z_min = std::min(z_min, view.to_eye(p).z);
        z_max = std::max(z_max, view.to_eye(p).z);
    }
    double sum = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const double det = glm::determinant(matrix(volume.frames[i]));
        const double pixel = view.pixel() * view.to_eye(volume.centers[i]).z;
        sum += 4.0 / 3 * std::numbers::pi * std::sqrt(std::max(det, 0.0)) / (pixel * pixel);
    }
    return sum * (kSheets - 1) / (z_max - z_min);
}

struct Measured {
    double wall = 1e30, cpu = 1e30;
    std::vector<StageTime> stages;  // of the GPU, in the fastest frame
};

/// The best of several frames, each from another side.
Measured draw(Splatter& splatter, const Camera& camera, int size, const Vec3& center, const Optics& optics) {
    Measured best;
    for (int i = 0; i < frames; ++i) {
        Camera turned = camera;
        const double a = 0.02 * i;
        const Vec3 d = camera.eye - center;
        turned.eye = center + Vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
        const View view(turned, size, size);
        const auto cpu = std::clock();
        SplatReport report;
        const double wall = bench::seconds_of([&] { report = splatter.draw(view, optics).report; }, 1);
        if (wall < best.wall) best.stages = report.stages;
        best.wall = std::min(best.wall, wall);
        best.cpu = std::min(best.cpu, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    }
    return best;
}

void print(const std::string& name, int size, const RbfVolume& volume, const Measured& m) {
    std::printf("%-8s %4d²  %8zu points  %7.2f frames/s  %6.3f s  %6.3f CPU-s  peak %5.0f MB\n", name.c_str(), size,
                volume.size(), 1 / m.wall, m.wall, m.cpu, bench::peak_bytes() * 1e-6);
    for (const StageTime& stage : m.stages) std::printf("  %s %.2f ms", stage.stage.c_str(), 1e3 * stage.seconds);
    if (!m.stages.empty()) std::printf("\n");
    std::fflush(stdout);
}

void models(const SplatOptions& options) {
    for (const std::string name : {"pawn", "alien", "train1", "car", "fan", "nozzle", "train2"}) {
        const RbfVolume volume = sample_rbf_points(make_model(name)).volume;
        const Box box = box_of(volume);
        const Optics optics(
            {.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .05}, {0, .02}, {1, .3}}},
            box.diagonal() / 100);
        Splatter splatter(volume, options);
        const Camera camera = fit_camera(box, Vec3(-1, 1, -1));
        for (const int size : {512, 1024}) print(name, size, volume, draw(splatter, camera, size, box.center(), optics));
    }
}

void sweep(const SplatOptions& options) {
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                         .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
                        0.1);
    const Camera camera{{2.6, -4.2, 2.0}, {-.55, 0, 0}, {0, 0, 1}, 40, 0};
    for (const int n : {30, 44, 60, 99, 158}) {
        const RbfVolume volume = sample_rbf_points(make_model("twist", n)).volume;
        Splatter splatter(volume, options);
        for (const int size : {512, 1024}) {
            print("twist" + std::to_string(n), size, volume, draw(splatter, camera, size, Vec3(-.55, 0, 0), optics));
        }
    }
}

/// A least-squares line through the costs, and the part of their variance that it leaves.
void print_slope(const std::vector<std::pair<double, double>>& costs) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (const auto& [overlap, cost] : costs) {
        n += 1;
        x += overlap;
        y += cost;
        xx += overlap * overlap;
        xy += overlap * cost;
        yy += cost * cost;
    }
    const double slope = (n * xy - x * y) / (n * xx - x * x), base = (y - slope * x) / n;
    const double left = 1 - std::pow(n * xy - x * y, 2) / ((n * xx - x * x) * (n * yy - y * y));
    std::printf("slope %.3f ns an overlap, %.3f s without any, variance left %.4f\n", slope * 1e9, base, left);
}

void cost_of_overlaps(const SplatOptions& options) {
    const RbfVolume volume = sample_rbf_points(make_model("twist", 40)).volume;
    const Camera camera{{2.6, -4.2, 2.0}, {-.55, 0, 0}, {0, 0, 1}, 40, 0};
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .02}, {1, .04}}}, 0.1);
    std::vector<std::pair<double, double>> costs;
    for (const double wider : {1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0}) {
        RbfVolume wide = volume;
        for (auto& frame : wide.frames) {
            for (float& f : frame) f *= static_cast<float>(wider * wider);
        }
        Splatter splatter(wide, options);
        const Measured m = draw(splatter, camera, 512, Vec3(-.55, 0, 0), optics);
        costs.emplace_back(overlaps(wide, View(camera, 512, 512)), m.cpu);
        std::printf("kernels %.2f times as wide: %6.0f M overlaps, %.3f CPU-s\n", wider, costs.back().first * 1e-6, m.cpu);
        std::fflush(stdout);
    }
    print_slope(costs);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string backend = argc > 1 ? argv[1] : "cpu", what = argc > 2 ? argv[2] : "";
    SplatOptions options{.method = backend == "cpu" ? SplatMethod::Cpu : SplatMethod::Gl, .sheets = kSheets};
    if (backend == "sheets") options.method = SplatMethod::Sheets;
    try {
        const auto device = backend == "cpu" ? std::nullopt : find_gl_device();
        if (device && !device->hardware) frames = 1;  // software takes seconds per frame
        std::printf("%s %s\n", backend.c_str(), device ? device->renderer.c_str() : "");
        if (what.empty() || what == "models") models(options);
        if (what.empty() || what == "sweep") sweep(options);
        if (what.empty() || what == "overlaps") cost_of_overlaps(options);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    }
}
