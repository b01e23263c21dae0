// SPDX-License-Identifier: Apache-2.0
// Dense cells of a twisted block, streamed. Arguments: cells per side, levels.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "measure.h"
#include "subvol/dense_cells.h"
#include "subvol/model.h"

int main(int argc, char** argv) {
    using namespace subvol;
    const int side = argc > 1 ? std::atoi(argv[1]) : 64, levels = argc > 2 ? std::atoi(argv[2]) : 2;
    const HexMesh mesh = make_model("twist", side);
    std::atomic<std::size_t> nodes{0};
    const double seconds = bench::seconds_of(
        [&] { for_each_dense_cell(mesh, {.levels = levels}, [&](const DenseCell& cell) { nodes += cell.points.size(); }); }, 1);
    const double points = std::pow(side * std::pow(2.0, levels) + 1, 3);  // each once
    std::printf("%.1f M points (%.1f M nodes): %.2f s, %.2f M points/s, peak %.1f bytes a point (%.0f MB)\n", points / 1e6,
                static_cast<double>(nodes) / 1e6, seconds, points / seconds / 1e6, bench::peak_bytes() / points,
                bench::peak_bytes() / 1e6);
}
