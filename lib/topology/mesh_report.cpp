// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_report.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "mesh_parts.h"
#include "subvol/cell.h"

namespace subvol {

namespace {

struct CellQuality {
    double volume = 0;
    double min_scaled_jacobian = 1;
    bool inverted = false;
    bool degenerate = false;
};

CellQuality measure(const std::array<Vec3, 8>& corners) {
    CellQuality quality;
    quality.volume = cell_volume(corners);
    quality.degenerate = quality.volume == 0;
    for (std::size_t k = 0; k < 8; ++k) {
        const auto& [a, b, c] = kCornerNeighbors[k];
        const Vec3 u = corners[a] - corners[k], v = corners[b] - corners[k], w = corners[c] - corners[k];
        const double det = glm::dot(u, glm::cross(v, w));
        const double lengths = glm::length(u) * glm::length(v) * glm::length(w);
        quality.inverted |= det < 0;
        quality.degenerate |= lengths == 0;
        quality.min_scaled_jacobian = std::min(quality.min_scaled_jacobian, lengths > 0 ? det / lengths : 0.0);
    }
    return quality;
}

CellQuality quality_of(const HexMesh& mesh, std::size_t c) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[c][k]];
    return measure(corners);
}

void add(ShapeReport& report, const CellQuality& cell) {
    report.volume += cell.volume;
    report.inverted_cells += cell.inverted;
    report.degenerate_cells += cell.degenerate;
    report.min_scaled_jacobian = std::min(report.min_scaled_jacobian, cell.min_scaled_jacobian);
}

/// Counts the edges whose smaller point is the part's own.
void count_edges(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        if (!part.own[topology.edges[e][0]]) continue;
        ++report.edges;
        if (topology.edge_on_boundary[e]) {
            report.nonmanifold_edges += topology.boundary_faces_at(static_cast<Index>(e)) != 2;
        } else {
            ++report.interior_edges;
            ++report.interior_edge_valence[static_cast<int>(topology.edge_cells[e].size())];
        }
    }
}

/// Counts the faces whose smallest point is the part's own.
void count_faces(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        if (!part.own[topology.faces[f][0]]) continue;
        ++report.faces;
        report.boundary_faces += topology.face_on_hull(static_cast<Index>(f));
    }
}

void count_points(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    for (std::size_t p = 0; p < topology.point_count; ++p) {
        if (!part.own[p]) continue;
        ++report.points_used;
        if (topology.point_on_boundary[p]) continue;
        const auto irregular = std::ranges::count_if(topology.point_edges[p], [&](Index e) {
            return !topology.edge_on_boundary[e] && topology.edge_cells[e].size() != 4;
        });
        report.singular_nodes += irregular != 0 && irregular != 2;
    }
}

}  // namespace

ShapeReport measure_cells(const HexMesh& mesh) {
    constexpr std::size_t kPart = 4096;  // cells that are summed together, so that rounding does not depend on the threads
    std::vector<ShapeReport> parts((mesh.cells.size() + kPart - 1) / kPart);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        for (std::size_t c = i * kPart; c < std::min(mesh.cells.size(), (i + 1) * kPart); ++c) {
            add(parts[i], quality_of(mesh, c));
        }
    });
    ShapeReport report;
    for (const ShapeReport& part : parts) {
        report.volume += part.volume;
        report.inverted_cells += part.inverted_cells;
        report.degenerate_cells += part.degenerate_cells;
        report.min_scaled_jacobian = std::min(report.min_scaled_jacobian, part.min_scaled_jacobian);
    }
    return report;
}

std::vector<std::size_t> inverted_cells(const HexMesh& mesh, std::size_t at_most) {
    std::vector<std::size_t> numbers;
    for (std::size_t c = 0; c < mesh.cells.size() && numbers.size() < at_most; ++c) {
        if (quality_of(mesh, c).inverted) numbers.push_back(c);
    }
    return numbers;
}

MeshReport inspect(const HexMesh& mesh) {
    validate(mesh);
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) {  // tags matter only to schemes
        HexMesh untagged;
        untagged.points = mesh.points;
        untagged.cells = mesh.cells;
        return inspect(untagged);
    }
    MeshReport report;
    report.points = mesh.points.size();
    report.cells = mesh.cells.size();
    report.bounds = bounds(mesh);
    detail::each_part(mesh, [&](const detail::MeshPart& part) {
        count_points(part, report);
        count_edges(part, report);
        count_faces(part, report);
    });

    const ShapeReport shape = measure_cells(mesh);
    report.inverted_cells = shape.inverted_cells;
    report.degenerate_cells = shape.degenerate_cells;
    report.min_scaled_jacobian = shape.min_scaled_jacobian;
    report.volume = shape.volume;
    return report;
}

}  // namespace subvol
