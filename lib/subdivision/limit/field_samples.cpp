// SPDX-License-Identifier: Apache-2.0
// Samples of a field of the limit with the volume that each stands for: what kernels are
// fitted to, and where their error is measured.
//
// At vertices of a refined mesh a sample's weight is an eighth of the parallelepipeds that the edges of its cells span there.
// In cells the places follow the sequence k·(1/g, 1/g², 1/g³) mod 1, which is evenly spread for any number of samples, unlike a
// grid or random places; a weight is the determinant of the Jacobian times the share of a cell that a sample represents.
#include "subvol/field_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/error.h"

namespace subvol {
namespace {

/// The volume around a corner: an eighth of the determinant of its edges.
double corner_volume(const HexMesh& mesh, const std::array<Index, 8>& cell, std::size_t corner) {
    const Vec3& p = mesh.points[cell[corner]];
    const auto& n = kCornerNeighbors[corner];
    const Mat3 edges(mesh.points[cell[n[0]]] - p, mesh.points[cell[n[1]]] - p, mesh.points[cell[n[2]]] - p);
    return std::max(0.0, glm::determinant(edges) / 8);
}

}  // namespace

FieldSamples limit_samples_at_vertices(const HexMesh& mesh, std::string_view field, int level, const LimitOptions& options) {
    const RefineOptions refinement{.scheme = options.scheme, .levels = level, .progress = options.progress};
    const HexMesh fine = on_limit(refine(with_scalar_field(mesh, field), refinement), options.scheme.kind);
    FieldSamples samples{
        .points = fine.points, .values = fine.attributes[0].values, .weights = std::vector<double>(fine.points.size())};
    for (const auto& cell : fine.cells) {
        for (std::size_t k = 0; k < 8; ++k) samples.weights[cell[k]] += corner_volume(fine, cell, k);
    }
    return samples;
}

FieldSamples limit_samples_in_cells(const HexMesh& mesh, std::string_view field, std::size_t count,
                                    const LimitOptions& options) {
    const HexMesh bare = with_scalar_field(mesh, field);
    validate(bare);
    if (count < 1) throw Error(ErrorCode::InvalidInput, "the number of samples is 0", {}, "1 or more");
    const std::size_t cells = mesh.cells.size(), used = std::min(cells, count), each = count / used;
    // The R3 sequence of the plastic number's sibling: 1/g, 1/g², 1/g³ with g⁴ = g + 1.
    constexpr double kG = 1.2207440846057596;
    std::vector<LimitQuery> queries;
    queries.reserve(used * each);
    for (std::size_t k = 0; k < used * each; ++k) {
        const auto n = static_cast<double>(k + 1);
        const auto part = [n](double step) { return std::fmod(.5 + n * step, 1.0); };
        queries.push_back(
            {static_cast<Index>(k / each * cells / used), {part(1 / kG), part(1 / (kG * kG)), part(1 / (kG * kG * kG))}});
    }
    LimitSamples limit = evaluate_limit(bare, queries, options);
    FieldSamples samples{.points = std::move(limit.positions), .values = std::move(limit.attributes[0].values), .weights = {}};
    const double share = static_cast<double>(cells) / static_cast<double>(used * each);
    for (const Mat3& jacobian : limit.jacobians) {
        samples.weights.push_back(share * std::max(0.0, glm::determinant(jacobian)));
    }
    return samples;
}

}  // namespace subvol
