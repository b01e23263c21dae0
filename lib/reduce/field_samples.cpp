// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "bucket_sort.h"
#include "subvol/cell.h"
#include "subvol/error.h"
#include "subvol/reduce.h"

namespace subvol {
namespace {

const Attribute& first_attribute(const HexMesh& mesh) {
    if (mesh.attributes.empty())
        throw Error(ErrorCode::InvalidInput, "the mesh has no field to sample", {}, "an attribute at its points");
    return mesh.attributes[0];
}

/// The volume about a corner: an eighth of the determinant of its edges.
double corner_volume(const HexMesh& mesh, const std::array<Index, 8>& cell, std::size_t corner) {
    const Vec3& p = mesh.points[cell[corner]];
    const auto& n = kCornerNeighbors[corner];
    const Mat3 edges(mesh.points[cell[n[0]]] - p, mesh.points[cell[n[1]]] - p, mesh.points[cell[n[2]]] - p);
    return std::max(0.0, glm::determinant(edges) / 8);
}

}  // namespace

FieldSamples sample_vertices(const HexMesh& mesh, int level, const LimitOptions& options) {
    const HexMesh fine =
        on_limit(refine(mesh, {.scheme = options.scheme, .levels = level, .progress = options.progress}), options.scheme.kind);
    const Attribute& field = first_attribute(fine);
    FieldSamples samples{.points = fine.points, .values = {}, .weights = std::vector<double>(fine.points.size())};
    samples.values.resize(fine.points.size());
    for (std::size_t p = 0; p < fine.points.size(); ++p)
        samples.values[p] = field.values[p * static_cast<std::size_t>(field.channels)];
    for (const auto& cell : fine.cells) {
        for (std::size_t k = 0; k < 8; ++k) samples.weights[cell[k]] += corner_volume(fine, cell, k);
    }
    return samples;
}

FieldSamples sample_cells(const HexMesh& mesh, std::size_t count, const LimitOptions& options) {
    first_attribute(mesh);
    if (count < 1) throw Error(ErrorCode::InvalidInput, "no sample is asked for", {}, "1 or more");
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
    LimitSamples limit = evaluate_limit(mesh, queries, options);
    FieldSamples samples{.points = std::move(limit.positions), .values = {}, .weights = {}};
    const LimitAttribute& field = limit.attributes[0];
    const double share = static_cast<double>(cells) / static_cast<double>(used * each);
    for (std::size_t k = 0; k < queries.size(); ++k) {
        samples.values.push_back(field.values[k * field.channels]);
        samples.weights.push_back(share * std::max(0.0, glm::determinant(limit.jacobians[k])));
    }
    return samples;
}

}  // namespace subvol
