// SPDX-License-Identifier: Apache-2.0
// Projected tetrahedra on the twisted block: seconds per picture for each order, and the difference from rays through the same
// tetrahedra. Every row is the fastest of several pictures of one renderer.
//
//   projected_tets [resolution…]
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "measure.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"

namespace {

using namespace subvol;

constexpr int kSize = 512;
constexpr int kFrames = 2;

struct Difference {
    double largest = 0, rms = 0;  // rms: of red, green and blue
};

Difference difference(const Image& a, const Image& b) {
    Difference result;
    double squares = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        const double d = std::abs(double{a.rgba[i]} - double{b.rgba[i]});
        result.largest = std::max(result.largest, d);
        if (i % 4 != 3) squares += d * d;
    }
    result.rms = std::sqrt(squares / (0.75 * static_cast<double>(a.rgba.size())));
    return result;
}

struct Row {
    std::string name;
    ProjectedOptions options;
};

std::vector<Row> rows() {
    std::vector<Row> result{
        {"centroid", {.order = ProjectedOrder::Centroid}}, {"topological", {}}, {"lists", {.order = ProjectedOrder::Lists}}};
    for (const int k : {1, 2, 4, 6, 16})
        result.push_back({"havs k=" + std::to_string(k), {.order = ProjectedOrder::Havs, .kbuffer = k}});
    for (const double lod : {0.0, 0.03, 0.1, 0.3, 0.6}) {
        char name[32];
        std::snprintf(name, sizeof name, "lod %g", lod);
        result.push_back({name, {.order = ProjectedOrder::Havs, .lod = lod}});
    }
    return result;
}

void measure(int resolution) {
    const HexMesh mesh = make_model("twist", resolution);
    const Box box = bounds(mesh);
    const View view(fit_camera(box, {-1, 1, -1}), kSize, kSize);
    const Optics optics({{{0, {0, 0, 1}}, {0.5, {0.1, 1, 0.2}}, {1, {1, 0, 0}}}, {{0, 0}, {1, 0.1}}},
                        0.01 * glm::length(box.upper - box.lower));
    const TetsRenderer tracer(mesh);
    TetsResult rays;
    const double ray_seconds = bench::seconds_of([&] { rays = tracer.draw(view, optics); }, kFrames);
    std::printf("twist %d: %zu tets; by rays on the CPU: prepare %.3f s, draw %.3f s\n", resolution, rays.report.tets,
                tracer.seconds_build(), ray_seconds);
    ProjectedRenderer renderer(mesh);
    for (const auto& [name, options] : rows()) {
        ProjectedResult best;
        for (int i = 0; i < kFrames; ++i) {
            ProjectedResult drawn = renderer.draw(view, optics, options);
            const auto seconds = [](const ProjectedReport& r) { return r.seconds_prepare + r.seconds_sort + r.seconds_draw; };
            if (i == 0 || seconds(drawn.report) < seconds(best.report)) best = std::move(drawn);
        }
        if (!best.report.violations) {
            ProjectedOptions counting = options;
            counting.count_violations = true;
            const ProjectedReport counted = renderer.draw(view, optics, counting).report;
            best.report.violations = counted.violations;
            best.report.fragments = counted.fragments;
        }
        const ProjectedReport& r = best.report;
        const Difference error = difference(best.image, rays.image);
        std::printf(
            "  %-11s prepare %.3f s, sort %.3f s, draw %.3f s; %8zu fragments, %6zu wrong pixels, %7zu late; RMSE %.1e, "
            "largest %.1e\n",
            name.c_str(), r.seconds_prepare, r.seconds_sort, r.seconds_draw, r.fragments, r.violations.value_or(0),
            r.late_faces, error.rms, error.largest);
    }
    const ProjectedReport r = renderer.draw(view, optics).report;
    std::printf("  built once: %.3f s (%s)\n", r.seconds_build, r.device.c_str());
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
