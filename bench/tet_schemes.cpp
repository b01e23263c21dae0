// SPDX-License-Identifier: Apache-2.0
// Meshes of tetrahedra with a known field: split into hexahedra, and refined as tetrahedra, with the same control values. The
// table of docs/schemes.md.
//
//   tet_schemes [--shape] MESH…     --shape: no field, cells and their shapes alone
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>

#include "subvol/limit.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "subvol/refine.h"
#include "subvol/refine_mixed.h"

namespace {

using namespace subvol;

/// A field that is the same on meshes of every size: of places in parts of half the longest side of the box.
struct Field {
    Vec3 center{0.0};
    double half = 1;

    double operator()(const Vec3& x) const {
        const Vec3 p = (x - center) / half;
        return std::sin(4 * p.x + 1) * std::cos(3 * p.y) + std::exp(-2 * glm::dot(p, p)) * p.z;
    }
};
Field field_at;

template <class Mesh>
void sample(Mesh& mesh) {
    Attribute field{"f", 1, {}};
    for (const Vec3& p : mesh.points) field.values.push_back(field_at(p));
    mesh.attributes = {field};
}

/// Seconds of all cores together.
struct Clock {
    std::clock_t start = std::clock();
    [[nodiscard]] double seconds() const { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }
};

/// The error of the values at the points of a fine mesh.
template <class Mesh>
void print(const char* name, std::size_t unknowns, std::size_t cells, std::size_t inverted, double worst, double volume,
           const Mesh& fine, double seconds) {
    double squares = 0, most = 0;
    if (!fine.attributes.empty()) {
        for (std::size_t i = 0; i < fine.points.size(); ++i) {
            const double off = fine.attributes[0].values[i] - field_at(fine.points[i]);
            squares += off * off;
            most = std::max(most, std::abs(off));
        }
    }
    std::printf("| %s | %zu | %zu | %zu | %.3f | %.4f | %.5f | %.4f | %.2f |\n", name, unknowns, cells, inverted, worst, volume,
                std::sqrt(squares / static_cast<double>(fine.points.size())), most, seconds);
    std::fflush(stdout);
}

void refine_tets(const char* name, const MixedMesh& control, TetScheme scheme, bool interpolate, int levels) {
    const Clock clock;
    const MixedMesh start = interpolate ? interpolate_vertices(control, scheme, 1e-5, 100).mesh : control;
    const MixedMesh fine = on_limit(refine(start, {.scheme = scheme, .levels = levels}), scheme);
    const double seconds = clock.seconds();
    const MixedShape shape = measure_cells(fine);
    print(name, control.points.size(), fine.cells(), shape.inverted, shape.worst, shape.volume, fine, seconds);
}

void refine_hexes(const char* name, const HexMesh& control, std::size_t unknowns, Scheme scheme, int levels) {
    const Clock clock;
    const HexMesh fine = on_limit(refine(control, {.scheme = {.kind = scheme}, .levels = levels}), scheme);
    const double seconds = clock.seconds();
    const ShapeReport shape = measure_cells(fine);
    print(name, unknowns, fine.cells.size(), shape.inverted_cells, shape.min_scaled_jacobian, shape.volume, fine, seconds);
}

void compare(const char* path, bool shape_alone) {
    ReadOptions options;
    HexMesh hexes = without_unused_points(read_mesh(path, options).mesh);
    hexes.attributes.clear();
    const Vec3 size = bounds(hexes).size();
    field_at = {bounds(hexes).center(), std::max({size.x, size.y, size.z}) / 2};
    MixedMesh tets = join_split_cells(hexes);
    if (!shape_alone) sample(tets);
    const MixedShape shape = measure_cells(tets);
    std::printf("%s: %zu points, %zu cells, worst shape %.3f, volume %.4f\n", path, tets.points.size(), tets.cells(),
                shape.worst, shape.volume);
    const HexMesh split = in_hexahedra(tets);
    refine_hexes("split, mcq", split, tets.points.size(), Scheme::Mcq, 1);
    refine_hexes("split, bsxw", split, tets.points.size(), Scheme::Bsxw, 1);
    if (!shape_alone) {
        HexMesh sampled = split;
        sample(sampled);
        refine_hexes("split, mcq, all hex points sampled", sampled, sampled.points.size(), Scheme::Mcq, 1);
    }
    refine_tets("linear", tets, TetScheme::Linear, false, 2);
    refine_tets("tetoct", tets, TetScheme::Tetoct, false, 2);
    refine_tets("tetoct, through the points", tets, TetScheme::Tetoct, true, 2);
    MixedMesh cut = in_tetrahedra(tets);
    refine_tets("boxspline", cut, TetScheme::Boxspline, false, 2);
    refine_tets("boxspline, through the points", cut, TetScheme::Boxspline, true, 2);
}

}  // namespace

int main(int argc, char** argv) {
    bool shape_alone = false;
    std::printf("| scheme | unknowns | cells | inverted | worst shape | volume | rms error | max error | CPU seconds |\n");
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--shape") == 0) {
            shape_alone = true;
            continue;
        }
        try {
            compare(argv[i], shape_alone);
        } catch (const std::exception& error) {
            std::printf("%s: %s\n", argv[i], error.what());
        }
    }
}
