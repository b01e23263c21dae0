// SPDX-License-Identifier: Apache-2.0
// A mesh from a file: what is in it, and is it sound? Reads the file that is named, or else one that it writes itself.

#include <cstdio>

#include "subvol/io.h"
#include "subvol/subvol.h"

int main(int argc, char** argv) try {
    const char* path = argc > 1 ? argv[1] : "ball.vtu";
    if (argc == 1) subvol::write_mesh(path, subvol::make_model("ball", 8));

    // The warnings say what was left out, turned round or converted.
    const subvol::ReadResult read = subvol::read_mesh(path);
    for (const std::string& warning : read.warnings) std::printf("warning: %s\n", warning.c_str());

    const subvol::MeshReport report = inspect(read.mesh);
    std::printf("%s: %zu points, %zu cells, volume %.4g\n", path, report.points, report.cells, report.volume);
    for (const auto& [valence, edges] : report.interior_edge_valence)
        std::printf("  %zu interior edges with %d cells about them%s\n", edges, valence, valence == 4 ? ", as in a grid" : "");
    for (const subvol::FieldInfo& field : read.fields)
        std::printf("  field %s: %d components, %g to %g\n", field.name.c_str(), field.components, field.min, field.max);

    const bool sound = report.inverted_cells == 0 && report.degenerate_cells == 0 && report.nonmanifold_edges == 0;
    std::printf("%s, worst scaled Jacobian %.2f\n", sound ? "sound" : "not sound", report.min_scaled_jacobian);
    return sound ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
