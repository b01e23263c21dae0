// SPDX-License-Identifier: Apache-2.0
// Takes a fine mesh apart into control points and details, bends the control points, and puts it together again: the details
// turn with their surroundings.
#include <cmath>
#include <cstdio>

#include "subvol/io.h"
#include "subvol/subvol.h"

int main() try {
    // A mesh with fine bumps, as a scan or a simulation would give it.
    subvol::HexMesh fine = subvol::refine(subvol::make_model("ball", 3), {.levels = 2});
    for (auto& p : fine.points) p *= 1 + .02 * std::sin(20 * p.x) * std::sin(20 * p.y) * std::sin(20 * p.z);

    // Twist its control points two levels coarser about z. The details turn with their surroundings.
    subvol::CoarseEdit edit(fine, 2);
    subvol::HexMesh coarse = edit.coarse();
    std::printf("%zu points are %zu control points and %zu details\n", fine.points.size(), coarse.points.size(),
                fine.points.size() - coarse.points.size());
    for (auto& p : coarse.points) {
        const double angle = p.z;
        p = {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
    }
    fine = edit.change(coarse);
    write_mesh("twisted.vtu", fine);

    const subvol::WaveletFileReport report = write_wavelet_file("twisted.svw", fine, {.tolerance = 1e-3});
    std::printf("twisted.svw has %llu bytes; the density is kept within %.2g of its range\n",
                static_cast<unsigned long long>(report.bytes), report.arrays.back().rms);
    return report.arrays.back().rms <= 1e-3 ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
