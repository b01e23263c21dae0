// SPDX-License-Identifier: Apache-2.0
// Takes a fine mesh apart into control points and details, bends the control points, and puts it together again: the details
// turn with their surroundings.
#include <cmath>
#include <cstdio>

#include "subvol/subvol.h"

namespace {

std::vector<double> coordinates(const std::vector<subvol::Vec3>& points) {
    std::vector<double> values;
    for (const auto& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

}  // namespace

int main() try {
    // A mesh with fine bumps, as a scan or a simulation would give it.
    subvol::HexMesh fine = subvol::refine(subvol::make_model("ball", 3), {.levels = 2});
    for (auto& p : fine.points) p *= 1 + .02 * std::sin(20 * p.x) * std::sin(20 * p.y) * std::sin(20 * p.z);

    const subvol::MeshHierarchy hierarchy = subvol::find_hierarchy(fine, {.levels = 2});
    const subvol::WaveletBasis basis = subvol::wavelet_basis(build_topology(hierarchy.coarse), {.levels = hierarchy.levels});
    subvol::WaveletField shape = analyze(basis, in_hierarchy(hierarchy, coordinates(fine.points), 3), 3);
    std::printf("%zu points are %zu control points and %zu details\n", fine.points.size(), basis.control_points,
                fine.points.size() - basis.control_points);

    // Twist the control points about z. The details turn with their surroundings.
    turn_details_to_shape(basis, shape);
    for (std::size_t i = 0; i < shape.coarse.size(); i += 3) {
        const double x = shape.coarse[i], y = shape.coarse[i + 1], angle = shape.coarse[i + 2];
        shape.coarse[i] = std::cos(angle) * x - std::sin(angle) * y;
        shape.coarse[i + 1] = std::sin(angle) * x + std::cos(angle) * y;
    }
    turn_details_to_world(basis, shape);
    const std::vector<double> twisted = synthesize(basis, shape);
    for (std::size_t i = 0; i < hierarchy.points.size(); ++i) {
        fine.points[hierarchy.points[i]] = {twisted[3 * i], twisted[3 * i + 1], twisted[3 * i + 2]};
    }
    write_mesh("twisted.vtu", fine);

    const subvol::WaveletFileReport report = write_wavelet_file("twisted.svw", fine, {.tolerance = 1e-3});
    std::printf("twisted.svw has %llu bytes; the density is kept within %.2g of its range\n",
                static_cast<unsigned long long>(report.bytes), report.arrays.back().rms);
    return report.arrays.back().rms <= 1e-3 ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
