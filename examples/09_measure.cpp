// SPDX-License-Identifier: Apache-2.0
// Numbers and surfaces of the limit: values at places, integrals, a slice, an isosurface. Writes half.ply and slice.vtp.

#include <cmath>
#include <cstdio>
#include <numbers>

#include "subvol/subvol.h"

int main() try {
    const subvol::HexMesh mesh = subvol::make_model("ball", 8);

    // Values and gradients anywhere; outside the volume there is nothing.
    const subvol::LimitProbe probe(mesh);
    const auto places = subvol::places_on_line({-1.2, 0, 0}, {1.2, 0, 0}, 13);
    const subvol::ProbeResult line = probe.at(places);
    for (std::size_t p = 0; p < places.size(); ++p) {
        if (line.inside(p)) {
            std::printf("x %5.2f: %s %8.5f in cell %zu\n", places[p].x, line.fields[0].name.c_str(), line.fields[0].values[p],
                        static_cast<std::size_t>(line.cells[p]));
        } else {
            std::printf("x %5.2f: outside\n", places[p].x);
        }
    }

    // Integrals, and the extremes of the limit with their places.
    const subvol::LimitMeasure measure = measure_limit(mesh);
    const subvol::FieldMeasure& density = measure.whole.fields[0];
    std::printf("volume %.5f, mean %.5f, largest %.5f at %.3f %.3f %.3f\n", measure.whole.volume, density.mean,
                density.max.value, density.max.place.x, density.max.place.y, density.max.place.z);

    // A slice with contour lines.
    const subvol::LimitSlice slice = slice_limit(mesh, "density", {0, 0, 0}, {0, 0, 1}, {.resolution = 200});
    write_slice("slice.vtp", slice, contour_lines(slice, std::vector{-0.5, 0.0, 0.5}));

    // A closed surface about the part where the density is at least 0, for a printer.
    const subvol::LimitSurface part = limit_surface(mesh, "density", {.isos = {0.0}, .cap = true});
    write_limit_surface("half.ply", part);
    std::printf("%zu triangles, volume %.5f, %s\n", part.surface.triangles.size(), part.report.volume,
                part.report.watertight ? "watertight" : "open");

    const double ball = 4.0 / 3 * std::numbers::pi;
    return std::abs(measure.whole.volume / ball - 1) < 1e-3 && part.report.watertight ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
