// SPDX-License-Identifier: Apache-2.0
// Error and cost on the twisted block, whose exact picture is known: splats (per interval count and correction), the
// tetrahedra reference and the dense grids against the exact picture, with the smooth and the sharp transfer function.
//
//   twist_error [N = 40] [size = 512] [folder for the pictures]
#include <ctime>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/render_dense.h"
#include "subvol/render_field.h"
#include "subvol/render_tets.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

TransferFunction transfer_function(bool sharp) {
    TransferFunction f;
    f.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}};
    f.opacity = sharp ? std::vector<TransferFunction::OpacityKnot>{{-1, 0}, {.27, 0}, {.30, .9}, {.33, 0}, {1, 0}}
                      : std::vector<TransferFunction::OpacityKnot>{{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}};
    return f;
}

const char* name(Correction c) {
    return c == Correction::None       ? "none"
           : c == Correction::Gradient ? "gradient"
           : c == Correction::Second   ? "second"
                                       : "full";
}

void print(const char* method, const std::string& detail, bool sharp, const Image& image, const Image& exact, double cpu,
           double wall) {
    const auto m = compare_images(image, exact);
    std::printf("%-6s %-22s %-6s rmse %.5f  max %.4f  psnr %5.1f dB  cpu %6.2f s  wall %6.2f s\n", method, detail.c_str(),
                sharp ? "sharp" : "smooth", m.rmse, m.max, m.psnr, cpu, wall);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const int n = argc > 1 ? std::atoi(argv[1]) : 40, size = argc > 2 ? std::atoi(argv[2]) : 512;
    const std::filesystem::path folder = argc > 3 ? argv[3] : "";
    const Camera camera{{2.6, -4.2, 2.0}, {-.55, 0, 0}, {0, 0, 1}, 40, 0};
    const View view(camera, size, size);
    const HexMesh mesh = make_model("twist", n);
    Box box = bounds(mesh);
    const Vec3 margin(0.1 * box.diagonal());
    box.add(box.lower - margin);
    box.add(box.upper + margin);

    for (const bool sharp : {false, true}) {
        const Optics optics(transfer_function(sharp), 0.1);
        const int sheets = sharp ? 400 : 200;
        const TwistField field;
        const Image exact =
            render_field([&](const Vec3& x) { return field.value(x); }, box, view, optics, {.step_world = 0.002});
        const auto keep = [&](const std::string& file, const Image& image) {
            if (!folder.empty()) write_image(folder / (file + (sharp ? "_sharp.exr" : "_smooth.exr")), image);
        };
        keep("exact", exact);
        for (const int levels : {0, 1}) {
            const HexMesh refined = refine(mesh, {.levels = levels});
            const double start = cpu_seconds();
            const auto tets = render_tets(refined, {}, view, optics);
            print("tets", "level " + std::to_string(levels), sharp, tets.image, exact, cpu_seconds() - start,
                  tets.report.seconds_build + tets.report.seconds_draw);
            keep("tets_" + std::to_string(levels), tets.image);
        }
        for (const int levels : {1, 2}) {
            const double start = cpu_seconds();
            const auto dense = render_dense(mesh, {}, view, optics, {.levels = levels});
            print("dense", "level " + std::to_string(levels), sharp, dense.image, exact, cpu_seconds() - start,
                  dense.report.seconds_build + dense.report.seconds_draw);
            keep("dense_" + std::to_string(levels), dense.image);
        }
        for (const int per_edge : {1, 2}) {
            for (const bool centers : {false, true}) {
                for (const Correction correction :
                     {Correction::None, Correction::Gradient, Correction::Second, Correction::Full}) {
                    const auto points =
                        sample_rbf_points(mesh, {.per_edge = per_edge, .centers = centers, .correction = correction});
                    const double start = cpu_seconds();
                    const auto splat =
                        render_splats(points.volume, view, optics, {.method = SplatMethod::Cpu, .sheets = sheets});
                    const std::string detail =
                        "n=" + std::to_string(per_edge) + (centers ? " centres " : " ") + name(correction);
                    print("splat", detail, sharp, splat.image, exact, cpu_seconds() - start,
                          splat.report.seconds_prepare + splat.report.seconds_draw);
                    keep("splat_" + std::to_string(per_edge) + (centers ? "c_" : "_") + name(correction), splat.image);
                }
            }
        }
    }
}
