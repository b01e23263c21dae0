// SPDX-License-Identifier: Apache-2.0
// The twisted block by each of our methods: CPU-seconds of the first and of a later frame, and the error against the exact
// picture, with the smooth transfer function. Writes the exact picture for the other programs: size² RGB floats, rows from the
// top.
//
//   peers_ours [N = 40] [exact.f32] [size = 512]
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "subvol/error.h"
#include "subvol/image_metrics.h"
#include "subvol/model.h"
#include "subvol/render_dense.h"
#include "subvol/render_field.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/sample.h"
#include "subvol/splat.h"
#ifdef SUBVOL_PEERS_VDB
#include "subvol/rasterize.h"
#include "subvol/render_grid.h"
#endif

namespace {

using namespace subvol;

constexpr int kFrames = 3;

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Image exact_picture(const HexMesh& mesh, const View& view, const Optics& optics) {
    Box box = bounds(mesh);
    const Vec3 margin(0.1 * box.diagonal());
    box.add(box.lower - margin);
    box.add(box.upper + margin);
    return render_field([](const Vec3& x) { return TwistField{}.value(x); }, box, view, optics, {.step_world = 0.002});
}

void write_floats(const std::string& path, const Image& image) {
    std::ofstream out(path, std::ios::binary);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        out.write(reinterpret_cast<const char*>(&image.rgba[i]), 3 * sizeof(float));
    }
    if (!out) throw Error(ErrorCode::Io, "cannot be written", path);
}

/// start: the work that is done once; it returns the function that draws a frame.
void measure(const std::string& name, const Image& exact, const std::function<std::function<Image()>()>& start) {
    const double begin = cpu_seconds();
    const auto draw = start();
    Image image = draw();
    const double first = cpu_seconds() - begin;
    double later = 1e30;
    for (int i = 1; i < kFrames; ++i) {
        const double before = cpu_seconds();
        image = draw();
        later = std::min(later, cpu_seconds() - before);
    }
    std::printf("%s\t%.2f\t%.2f\t%.5f\n", name.c_str(), first, later, compare_images(image, exact).rmse);
    std::fflush(stdout);
}

void measure_all(int n, const std::string& exact_file, int size) {
    const HexMesh mesh = make_model("twist", n);
    const View view({{2.6, -4.2, 2.0}, {-.55, 0, 0}, {0, 0, 1}, 40, 0}, size, size);
    const Optics optics({.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                         .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
                        0.1);
    const Image exact = exact_picture(mesh, view, optics);
    if (!exact_file.empty()) write_floats(exact_file, exact);

    const auto points = sample_rbf_points(mesh, {.per_edge = 1});
    measure("subvol splat, a kernel a control vertex (CPU)", exact, [&] {
        auto splatter = std::make_shared<Splatter>(points.volume, SplatOptions{.method = SplatMethod::Cpu});
        return [&, splatter] {
            splatter->set_kernels(points.volume);  // so that nothing is kept from the picture before
            return splatter->draw(view, optics).image;
        };
    });
    for (const int level : {0, 1}) {
        const HexMesh fine = refine(mesh, {.levels = level});
        const std::string of_level = ", level " + std::to_string(level);
        measure("subvol tets by ray" + of_level, exact, [&] {
            auto renderer = std::make_shared<TetsRenderer>(fine);
            return [&, renderer] { return renderer->draw(view, optics).image; };
        });
        if (gl_devices().empty()) continue;
        measure("subvol projected tets" + of_level, exact,
                [&] { return [&] { return render_projected(fine, {}, view, optics).image; }; });
    }
    for (const int level : {1, 2}) {
        measure("subvol dense, level " + std::to_string(level), exact,
                [&] { return [&, level] { return render_dense(mesh, {}, view, optics, {.levels = level}).image; }; });
    }
#ifdef SUBVOL_PEERS_VDB
    const std::vector<std::string> fields{mesh.attributes[0].name};
    const auto voxels = rasterize(refine(mesh, {.levels = 1}), fields, {.resolution = 200}).front().voxels();
    measure("subvol grid by ray, 200 voxels", exact, [&] { return [&] { return render_grid(*voxels, view, optics).image; }; });
#endif
}

}  // namespace

int main(int argc, char** argv) try {
    measure_all(argc > 1 ? std::atoi(argv[1]) : 40, argc > 2 ? argv[2] : "", argc > 3 ? std::atoi(argv[3]) : 512);
} catch (const std::exception& error) {
    std::fprintf(stderr, "peers_ours: %s\n", error.what());
    return 1;
}
