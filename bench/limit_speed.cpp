// SPDX-License-Identifier: Apache-2.0
// Limits at random places of meshes. Arguments: mesh files, or models as NAME:RESOLUTION; options before them: --places N a
// mesh (1,000,000), --tolerance T (1e-6), --levels L (10), --scheme mcq|cc|bsxw|linear (mcq), --probe (also probes the
// positions that these have in the world, and compares the values).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>

#include "measure.h"
#include "subvol/limit.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/probe.h"

namespace {

using namespace subvol;

std::vector<double> coordinate(const std::vector<Vec3>& points, int axis) {
    std::vector<double> values;
    for (const Vec3& x : points) values.push_back(x[axis]);
    return values;
}

HexMesh load(const std::string& name) {
    const auto colon = name.find(':');
    HexMesh mesh = colon == std::string::npos ? read_mesh(name).mesh
                                              : make_model(name.substr(0, colon), std::atoi(name.c_str() + colon + 1));
    mesh = without_unused_points(std::move(mesh));
    std::erase_if(mesh.attributes, [](const Attribute& a) { return a.channels != 1; });
    if (mesh.attributes.empty()) mesh.attributes = {{"y", 1, coordinate(mesh.points, 1)}};
    if (mesh.attributes.size() > 1) mesh.attributes.resize(1);
    return mesh;
}

Scheme scheme_of(const std::string& name) {
    return name == "cc"       ? Scheme::CatmullClark
           : name == "bsxw"   ? Scheme::Bsxw
           : name == "linear" ? Scheme::Linear
                              : Scheme::Mcq;
}

void probe_back(const HexMesh& mesh, const LimitSamples& samples, const LimitOptions& options) {
    std::unique_ptr<LimitProbe> probe;
    const double prepared =
        bench::seconds_of([&] { probe = std::make_unique<LimitProbe>(mesh, ProbeOptions{.limit = options}); }, 1);
    ProbeResult found;
    const std::clock_t before = std::clock();
    const double seconds = bench::seconds_of([&] { found = probe->at(samples.positions); }, 1);
    const double cpu = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    std::size_t outside = 0;
    double worst = 0;
    for (std::size_t p = 0; p < found.cells.size(); ++p) {
        if (found.cells[p] == kNone) {
            ++outside;
        } else if (!found.fields.empty()) {
            worst = std::max(worst, std::abs(found.fields[0].values[p] - samples.attributes[0].values[p]));
        }
    }
    const auto count = static_cast<double>(found.cells.size());
    std::printf(
        "  probed: prepared %.2f s, %10.0f places/s, %10.0f a CPU-second  rounds %d, outside %zu, largest difference %.2g\n",
        prepared, count / seconds, count / cpu, found.rounds, outside, worst);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    std::size_t count = 1000000;
    LimitOptions options;
    bool probe = false;
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--places") {
            count = std::strtoul(argv[++i], nullptr, 10);
            continue;
        }
        if (name == "--tolerance") {
            options.tolerance = std::atof(argv[++i]);
            continue;
        }
        if (name == "--levels") {
            options.max_levels = std::atoi(argv[++i]);
            continue;
        }
        if (name == "--probe") {
            probe = true;
            continue;
        }
        if (name == "--scheme") {
            options.scheme.kind = scheme_of(argv[++i]);
            continue;
        }
        const HexMesh mesh = load(name);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> t(0, 1);
        std::vector<LimitQuery> queries;
        for (std::size_t n = 0; n < count; ++n) {
            queries.push_back({static_cast<Index>(random() % mesh.cells.size()), {t(random), t(random), t(random)}});
        }
        LimitReport report;
        const std::clock_t before = std::clock();
        const double seconds = bench::seconds_of([&] { report = evaluate_limit(mesh, queries, options).report; }, 1);
        const double cpu = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
        std::printf(
            "%-34s %8zu cells %10.0f places/s, %10.0f a CPU-second  exact %zu, refined %zu, not converged %zu, deepest level "
            "%d\n",
            name.substr(name.rfind('/') + 1).c_str(), mesh.cells.size(), static_cast<double>(count) / seconds,
            static_cast<double>(count) / cpu, report.exact, report.refined, report.unconverged, report.deepest_level);
        std::fflush(stdout);
        if (probe) probe_back(mesh, evaluate_limit(mesh, queries, options), options);
    }
    std::printf("peak memory %.0f MB\n", bench::peak_bytes() / 1e6);
}
