// SPDX-License-Identifier: Apache-2.0
// Levels of detail of tetrahedra by edge collapses [cfm2004], for comparison with those of kernels (lod.cpp): tetrahedra drawn,
// CPU seconds and PSNR against all tetrahedra at three distances, over the pixels that the body covers.
//
//   tet_lod MODEL|FILE [size = 512]
#include <cmath>
#include <cstdio>

#include "collapse_hierarchy.h"
#include "lod_scene.h"
#include "subvol/image_metrics.h"
#include "subvol/render_tets.h"

int main(int argc, char** argv) {
    using namespace subvol;
    using namespace subvol::bench;
    if (argc < 2) return std::puts("tet_lod MODEL|FILE [size]"), 2;
    const int size = argc > 2 ? std::atoi(argv[2]) : 512;
    HexMesh hexes = mesh_named(argv[1]);
    hexes.attributes.resize(1);
    hexes.creases.clear();
    hexes.sharp_faces.clear();
    const Box box = bounds(hexes);
    const Optics optics = optics_with_peak(hexes);
    const MixedMesh mesh = in_tetrahedra(make_mixed_mesh(hexes, {}));
    std::optional<CollapseHierarchy> hierarchy;
    const double built = cpu_seconds_of([&] { hierarchy.emplace(mesh); }, 1);
    std::printf("%s: %zu points, %zu tets; hierarchy: %.1f s, %zu collapses, %zu tets of all levels\n", argv[1],
                mesh.points.size(), mesh.tets.size(), built, hierarchy->collapses(), hierarchy->tets());
    const double volume = measure_cells(mesh).volume;
    std::optional<TetsRenderer> renderer;
    const double build_all = cpu_seconds_of([&] { renderer.emplace(mesh); }, 1);
    for (const double distance : {1.0, 4.0, 16.0}) {
        const View view = view_at(box, distance, size);
        Image all;
        const double draw_all = cpu_seconds_of([&] { all = renderer->draw(view, optics).image; }, 2);
        PixelMask seen;
        for (std::size_t i = 3; i < all.rgba.size(); i += 4) seen.push_back(all.rgba[i] > 0 ? 1 : 0);
        std::printf("  distance %2.0f: all %8zu tets  build %.2f s  draw %.3f s\n", distance, mesh.tets.size(), build_all,
                    draw_all);
        for (const double pixels : {1.0, 2.0, 4.0}) {
            for (const double error : {0.0, 0.003}) {
                MixedMesh few;
                const double choose = cpu_seconds_of([&] { few = hierarchy->cut(view, pixels, error); }, 2);
                std::optional<TetsRenderer> of_view;
                const double build = cpu_seconds_of([&] { of_view.emplace(few); }, 2);
                Image image;
                const double draw = cpu_seconds_of([&] { image = of_view->draw(view, optics).image; }, 2);
                const ImageMetrics off = compare_images(image, all, seen);
                std::printf(
                    "    lod %1.0f, error %.3f: %8zu tets  choose %.3f  build %.3f  draw %.3f s  psnr %5.1f  volume %+.1e\n",
                    pixels, error, few.tets.size(), choose, build, draw, off.psnr, measure_cells(few).volume / volume - 1);
                std::fflush(stdout);
            }
        }
    }
}
