// SPDX-License-Identifier: Apache-2.0
// How many kernels an error of the field needs: `reduce_rbf`, with and without moves, against uniform sampling with
// second-order kernels (the coarsest lattice of the model that reaches the error) and one kernel per control vertex. Errors are
// measured on one set of samples of the limit volume that no reduction has used.
//
//   reduction [model…]
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "measure.h"
#include "subvol/model.h"
#include "subvol/reduce.h"
#include "subvol/sample.h"

namespace {

using namespace subvol;

void print(const char* how, std::size_t kernels, const ErrorAtSamples& error, double seconds) {
    std::printf("  %-28s %8zu kernels  rmse %.5f  max %.3f  uncovered %zu  %6.1f s\n", how, kernels, error.rmse, error.max_abs,
                error.uncovered, seconds);
    std::fflush(stdout);
}

/// The coarsest lattice that reaches an error: the model's field on coarser control meshes, then more samples per edge of the
/// mesh itself (finer control meshes would have another limit).
void print_uniform(const std::string& model, int resolution, double rmse, const FieldSamples& other) {
    std::vector<std::pair<int, int>> lattices;  // resolution, samples per edge
    for (int n = 4; n < resolution; n += n < 16 ? 2 : n < 40 ? 4 : 8) lattices.emplace_back(n, 1);
    for (const int per_edge : {1, 2, 3}) lattices.emplace_back(resolution, per_edge);
    for (const auto& [n, per_edge] : lattices) {
        ErrorAtSamples error;
        std::size_t kernels = 0;
        const double seconds = bench::seconds_of(
            [&, n = n, per_edge = per_edge] {
                const RbfVolume volume = sample_rbf_points(make_model(model, n), {.per_edge = per_edge}).volume;
                kernels = volume.size();
                error = error_at_samples(volume, other);
            },
            1);
        if (error.rmse > rmse) continue;
        const std::string how = "uniform, " + std::to_string(n) + " × " + std::to_string(per_edge);
        print(how.c_str(), kernels, error, seconds);
        return;
    }
    std::printf("  uniform: not reached with 3 samples an edge\n");
}

void compare(const std::string& model, int resolution) {
    const HexMesh mesh = make_model(model, resolution);
    const FieldSamples other = limit_samples_in_cells(mesh, "", 30'011, {.tolerance = 1e-4});
    std::printf("%s: %zu cells\n", model.c_str(), mesh.cells.size());
    const RbfVolume full = sample_rbf_points(mesh).volume;
    print("one a control vertex", full.size(), error_at_samples(full, other), 0);
    for (const double rmse : {.01, .003}) {
        std::printf(" target %.3f\n", rmse);
        for (const bool move : {false, true}) {
            const auto reduced = reduce_rbf(mesh, "", {.rmse = rmse, .move = move});
            print(move ? "reduced, moved" : "reduced", reduced.volume.size(), error_at_samples(reduced.volume, other),
                  reduced.report.seconds);
        }
        print_uniform(model, resolution, rmse, other);
    }
    std::printf("  most memory so far: %.0f MB\n", 1e-6 * bench::peak_bytes());
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> asked(argv + 1, argv + argc);
    for (const auto& model : list_models()) {
        if (asked.empty() || std::find(asked.begin(), asked.end(), model.name) != asked.end())
            compare(model.name, model.default_resolution);
    }
}
