// Frames a second of the splatter: the models at two picture sizes, and the twisted block from 30 thousand to 4 million points.
// The line that follows the sweep is the cost of an overlap: seconds against kernel–pixel–sheet triples.
//
//   render_speed [cpu|gl|sheets] [models|sweep]
#include <ctime>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "measure.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/render.h"
#include "subvol/sample.h"

namespace {

using namespace subvol;

constexpr int kSheets = 200, kFrames = 8;

/// Pixels of all sections of all kernels by all sheets.
double overlaps(const RbfVolume& volume, const View& view) {
    double z_min = 1e300, z_max = -1e300;
    for (const Vec3& p : volume.boundary.points) {
        z_min = std::min(z_min, view.to_eye(p).z);
        z_max = std::max(z_max, view.to_eye(p).z);
    }
    double sum = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const auto& f = volume.frames[i];
        const double det = glm::determinant(Mat3(Vec3(f[0], f[1], f[2]), Vec3(f[1], f[3], f[4]), Vec3(f[2], f[4], f[5])));
        const double pixel = view.pixel() * view.to_eye(volume.centers[i]).z;
        sum += 4.0 / 3 * std::numbers::pi * std::sqrt(std::max(det, 0.0)) / (pixel * pixel);
    }
    return sum * (kSheets - 1) / (z_max - z_min);
}

struct Measured {
    double wall = 1e30, cpu = 1e30;
};

/// The best of some frames, each from another side.
Measured draw(Splatter& splatter, const Camera& camera, int size, const Vec3& center, const Optics& optics) {
    Measured best;
    for (int i = 0; i < kFrames; ++i) {
        Camera turned = camera;
        const double a = 0.02 * i;
        const Vec3 d = camera.eye - center;
        turned.eye = center + Vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
        const View view(turned, size, size);
        const auto cpu = std::clock();
        best.wall = std::min(best.wall, bench::seconds_of([&] { (void)splatter.draw(view, optics); }, 1));
        best.cpu = std::min(best.cpu, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    }
    return best;
}

void print(const std::string& name, int size, const RbfVolume& volume, const Measured& m) {
    std::printf("%-8s %4d²  %8zu points  %7.2f frames/s  %6.3f s  %6.3f CPU-s  peak %5.0f MB\n", name.c_str(), size,
                volume.size(), 1 / m.wall, m.wall, m.cpu, bench::peak_bytes() * 1e-6);
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
    std::vector<std::pair<double, double>> costs;  // overlaps, CPU seconds
    for (const int n : {30, 44, 60, 99, 158}) {
        const RbfVolume volume = sample_rbf_points(make_model("twist", n)).volume;
        Splatter splatter(volume, options);
        for (const int size : {512, 1024}) {
            const Measured m = draw(splatter, camera, size, Vec3(-.55, 0, 0), optics);
            print("twist" + std::to_string(n), size, volume, m);
            costs.emplace_back(overlaps(volume, View(camera, size, size)), m.cpu);
            std::printf("                %.0f M overlaps, %.2f ns each\n", costs.back().first * 1e-6,
                        costs.back().second / costs.back().first * 1e9);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string backend = argc > 1 ? argv[1] : "cpu", what = argc > 2 ? argv[2] : "";
    SplatOptions options{.backend = backend == "cpu" ? Backend::Cpu : Backend::Gl, .sheets = kSheets};
    try {
        std::printf("%s\n", backend.c_str());
        if (what != "sweep") models(options);
        if (what != "models") sweep(options);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    }
}
