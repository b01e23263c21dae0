// SPDX-License-Identifier: Apache-2.0
// Points per second of the conversion to radial basis functions with the rule `scheme`: the twisted block at 1, 2 and 4
// intervals per edge.
//
//   points_speed [N = 64]
#include <cstdio>
#include <cstdlib>

#include "measure.h"
#include "subvol/model.h"
#include "subvol/sample.h"

int main(int argc, char** argv) {
    using namespace subvol;
    const int n = argc > 1 ? std::atoi(argv[1]) : 64;
    const HexMesh mesh = make_model("twist", n);
    for (const int per_edge : {1, 2, 4}) {
        std::size_t points = 0;
        const double seconds =
            bench::seconds_of([&] { points = sample_rbf_points(mesh, {.per_edge = per_edge}).report.points; }, 3);
        const double count = static_cast<double>(points);
        std::printf("%d an edge: %9zu points %6.2f s %6.2f M points/s  peak %.0f bytes a point\n", per_edge, points, seconds,
                    count / seconds * 1e-6, bench::peak_bytes() / count);
        std::fflush(stdout);
    }
}
