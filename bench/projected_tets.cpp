// Projected tetrahedra on the twisted block: seconds a frame by order, and the difference from rays through the same
// tetrahedra.
//
//   projected_tets [resolution…]
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "measure.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/render.h"
#include "subvol/render_pt.h"

namespace {

using namespace subvol;

constexpr int kSize = 512;
constexpr int kFrames = 3;

double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i)
        largest = std::max(largest, std::abs(double{a.rgba[i]} - double{b.rgba[i]}));
    return largest;
}

void measure(int resolution) {
    const HexMesh mesh = make_model("twist", resolution);
    const Box box = bounds(mesh);
    const View view(fit_camera(box, {-1, 1, -1}), kSize, kSize);
    const Optics optics({{{0, {0, 0, 1}}, {0.5, {0.1, 1, 0.2}}, {1, {1, 0, 0}}}, {{0, 0}, {1, 0.1}}},
                        0.01 * glm::length(box.upper - box.lower));
    const auto& values = mesh.attributes[0].values;
    TetsResult rays;
    const double ray_seconds = bench::seconds_of([&] { rays = render_tets(mesh, values, view, optics); }, kFrames);
    std::printf("twist %d: %zu tets; by rays: build %.3f s, draw %.3f s, together %.3f s\n", resolution, rays.report.tets,
                rays.report.seconds_build, rays.report.seconds_draw, ray_seconds);
    const struct {
        const char* name;
        PtOrder order;
    } orders[] = {{"centroid", PtOrder::Centroid}, {"topological", PtOrder::Topological}, {"lists", PtOrder::Lists}};
    for (const auto& [name, order] : orders) {
        PtResult best;
        for (int i = 0; i < kFrames; ++i) {
            PtResult drawn = render_projected_tets(mesh, values, view, optics, {.order = order});
            if (i == 0 || drawn.report.seconds_draw < best.report.seconds_draw) best = std::move(drawn);
        }
        const PtReport counted =
            render_projected_tets(mesh, values, view, optics, {.order = order, .count_violations = true}).report;
        const PtReport& r = best.report;
        std::printf(
            "  %-12s build %.3f s, sort %.3f s, draw %.3f s; %zu cycles, %zu fragments, %zu wrong pixels; largest difference "
            "%.1e (%s)\n",
            name, r.seconds_build, r.seconds_sort, r.seconds_draw, r.cycles, counted.fragments, counted.violations.value_or(0),
            largest_difference(best.image, rays.image), r.device.c_str());
    }
}

}  // namespace

int main(int argc, char** argv) try {
    std::vector<int> resolutions{20, 40};
    if (argc > 1) resolutions.clear();
    for (int i = 1; i < argc; ++i) resolutions.push_back(std::stoi(argv[i]));
    for (const int resolution : resolutions) measure(resolution);
} catch (const std::exception& error) {
    std::fprintf(stderr, "projected_tets: %s\n", error.what());
    return 1;
}
