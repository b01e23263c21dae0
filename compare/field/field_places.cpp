// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_places.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "sample_grid.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/topology.h"

namespace subvol {

namespace {

constexpr int kLevels = 6;

/// A part of a cell: along each axis the whole cell, or the part near one end.
struct CellPart {
    enum Extent : std::uint8_t { All, NearLow, NearHigh };
    Index cell = 0;
    std::array<Extent, 3> extents{All, All, All};
};

std::vector<CellPart> parts_of(const HexMesh& mesh, PlaceKind kind) {
    std::vector<CellPart> parts;
    const Topology topology = build_topology(mesh);
    for (Index c = 0; c < topology.cells.size(); ++c) {
        if (kind == PlaceKind::Anywhere) parts.push_back({c});
        for (std::size_t s = 0; kind == PlaceKind::Boundary && s < 6; ++s) {
            if (!topology.face_on_hull(topology.cell_faces[c][s])) continue;
            parts.push_back({c});
            parts.back().extents[s / 2] = s % 2 == 0 ? CellPart::NearLow : CellPart::NearHigh;
        }
        for (std::size_t k = 0; kind == PlaceKind::Extraordinary && k < 12; ++k) {
            const Index e = topology.cell_edges[c][k];
            if (topology.edge_on_boundary[e] || topology.edge_cells[e].size() == 4) continue;
            parts.push_back({c});
            for (std::size_t a = 0; a < 3; ++a) {
                if (a == k / 4) continue;
                const bool high = kCornerParameters[kCellEdges[k][0]][a] == 1;
                parts.back().extents[a] = high ? CellPart::NearHigh : CellPart::NearLow;
            }
        }
    }
    return parts;
}

std::vector<LimitQuery> random_queries(const std::vector<CellPart>& parts, double within, std::size_t count,
                                       std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<LimitQuery> queries(count);
    for (LimitQuery& query : queries) {
        const CellPart& part = parts[random() % parts.size()];
        query.cell = part.cell;
        for (int a = 0; a < 3; ++a) {
            const double t = detail::random_unit(random);
            const auto extent = part.extents[static_cast<std::size_t>(a)];
            query.uvw[a] = extent == CellPart::All ? t : extent == CellPart::NearLow ? within * t : 1 - within * t;
        }
    }
    return queries;
}

}  // namespace

FieldSamples random_places(const HexMesh& mesh, std::string_view field, PlaceKind kind, double within, std::size_t count,
                           std::uint64_t seed, Scheme scheme) {
    const HexMesh bare = with_scalar_field(mesh, field);
    const auto parts = parts_of(bare, kind);
    if (parts.empty()) return {};
    LimitSamples limit = evaluate_limit(bare, random_queries(parts, within, count, seed),
                                        {.scheme = {scheme}, .tolerance = 1e-9, .max_levels = kLevels});
    return {std::move(limit.positions), std::move(limit.attributes.front().values), std::vector<double>(count, 1.0)};
}

FieldSamples new_vertices(const HexMesh& mesh, std::string_view field, int level, Scheme scheme) {
    HexMesh coarse = refine(with_scalar_field(mesh, field), {.scheme = {scheme}, .levels = level});
    const auto old = static_cast<std::ptrdiff_t>(coarse.points.size());  // they keep their numbers
    const HexMesh fine = refine(coarse, {.scheme = {scheme}, .levels = 1});
    const auto& values = fine.attributes.front().values;
    FieldSamples places{{fine.points.begin() + old, fine.points.end()}, {values.begin() + old, values.end()}, {}};
    places.weights.assign(places.size(), 1.0);
    return places;
}

}  // namespace subvol
