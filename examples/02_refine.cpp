// SPDX-License-Identifier: Apache-2.0
// Refinement: every level splits a cell into eight, and the volume converges to a smooth limit. Writes fine.vtu, for ParaView.

#include <cmath>
#include <cstdio>

#include "subvol/io.h"
#include "subvol/subvol.h"

int main() try {
    const subvol::HexMesh mesh = subvol::make_model("ball", 4);  // a ball, as well as so few cells can show one

    const double ball = 4 * std::acos(-1.0) / 3;
    double error = 1;
    bool better = true;
    for (int levels = 0; levels <= 3; ++levels) {
        const subvol::HexMesh fine = subvol::refine(mesh, {.scheme = {subvol::Scheme::Mcq}, .levels = levels});
        const double error_now = std::abs(inspect(fine).volume / ball - 1);
        std::printf("level %d: %6zu cells, the volume is %.3f %% off a ball's\n", levels, fine.cells.size(), 100 * error_now);
        better = better && error_now < error;
        error = error_now;
        if (levels == 2) subvol::write_mesh("fine.vtu", fine);  // with the refined field
    }
    return better ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
