// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_places.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "sample_grid.h"
#include "subvol/cell.h"
#include "subvol/dense_cells.h"
#include "subvol/detail/gather_cells.h"
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

namespace {

/// The part of a new vertex that one of its cells has. places: of the vertex, 0, 1 or 2 along each axis of the cell
double share_of(const Topology& topology, Index cell, const std::array<std::size_t, 3>& places) {
    const auto halves = std::ranges::count(places, 1);
    if (halves == 3) return 1;
    if (halves == 2) {
        const std::size_t axis = places[0] != 1 ? 0 : places[1] != 1 ? 1 : 2;
        return topology.face_on_hull(topology.cell_faces[cell][2 * axis + places[axis] / 2]) ? 1 : 0.5;
    }
    for (std::size_t e = 0; e < 12; ++e) {
        const auto &from = kCornerParameters[kCellEdges[e][0]], &to = kCornerParameters[kCellEdges[e][1]];
        bool is_here = true;
        for (std::size_t a = 0; a < 3; ++a) is_here &= static_cast<std::size_t>(from[a] + to[a]) == places[a];
        if (is_here) return 1 / static_cast<double>(topology.edge_cells[topology.cell_edges[cell][e]].size());
    }
    return 0;
}

constexpr std::size_t kNew = 19;  // vertices of a cell: on 12 edges, on 6 sides, in the middle

/// The new vertices of the owned cells of a part.
///
/// first: where they begin
void put_new_vertices(const MeshPiece& part, Scheme scheme, std::size_t first, FieldSamples& places) {
    const Topology topology = build_topology(part.mesh);
    std::vector<Index> cells;
    for (Index c = 0; c < part.owned_cells.size(); ++c) {
        if (part.owned_cells[c] != 0) cells.push_back(c);
    }
    for_each_dense_cell(part.mesh, {.scheme = {scheme}, .levels = 1}, {.cells = cells}, [&](const DenseCell& grid) {
        auto to = first + kNew * static_cast<std::size_t>(std::ranges::lower_bound(cells, grid.cell) - cells.begin());
        for (std::size_t n = 0; n < grid.points.size(); ++n) {
            const std::array<std::size_t, 3> at{n % 3, n / 3 % 3, n / 9};
            if (std::ranges::count(at, 1) == 0) continue;
            places.points[to] = grid.points[n];
            places.values[to] = grid.values.front()[n];
            places.weights[to++] = share_of(topology, grid.cell, at);
        }
    });
}

/// The new vertices of some cells, ascending: of a few at once, so that the topology of the whole is not needed.
FieldSamples new_vertices_of(HexMesh coarse, const std::vector<Index>& cells, Scheme scheme) {
    constexpr std::size_t kAtOnce = 1024;
    constexpr int kLayers = 2;
    const std::size_t count = kNew * cells.size();
    FieldSamples places{std::vector<Vec3>(count), std::vector<double>(count), std::vector<double>(count)};
    MeshPiece all;
    all.mesh = std::move(coarse);
    all.owned_cells.assign(all.mesh.cells.size(), 1);
    all.owned_points.assign(all.mesh.points.size(), 1);
    all.cell_numbers.resize(all.owned_cells.size());
    all.point_numbers.resize(all.owned_points.size());
    std::iota(all.cell_numbers.begin(), all.cell_numbers.end(), std::uint64_t{0});
    std::iota(all.point_numbers.begin(), all.point_numbers.end(), std::uint64_t{0});
    for (std::size_t first = 0; first < cells.size(); first += kAtOnce) {
        std::vector<std::uint8_t> chosen(all.owned_cells.size(), 0);
        const auto some = std::span(cells).subspan(first, std::min(kAtOnce, cells.size() - first));
        for (const Index cell : some) chosen[cell] = 1;
        put_new_vertices(detail::chosen_cells(all, chosen, kLayers), scheme, kNew * first, places);
    }
    return places;
}

}  // namespace

FieldSamples new_vertices(const HexMesh& mesh, std::string_view field, int level, Scheme scheme, std::size_t most) {
    constexpr std::size_t kOfACell = 7;  // of a large grid, as cells share them
    HexMesh coarse = refine(with_scalar_field(mesh, field), {.scheme = {scheme}, .levels = level});
    if (coarse.cells.size() > most / kOfACell) {
        const std::size_t stride = 1 + kOfACell * coarse.cells.size() / std::max<std::size_t>(most, 1);
        std::vector<Index> cells;
        for (std::size_t c = stride / 2; c < coarse.cells.size(); c += stride) cells.push_back(static_cast<Index>(c));
        return new_vertices_of(std::move(coarse), cells, scheme);
    }
    const auto old = static_cast<std::ptrdiff_t>(coarse.points.size());  // they keep their numbers
    const HexMesh fine = refine(coarse, {.scheme = {scheme}, .levels = 1});
    const auto& values = fine.attributes.front().values;
    FieldSamples places{{fine.points.begin() + old, fine.points.end()}, {values.begin() + old, values.end()}, {}};
    places.weights.assign(places.size(), 1.0);
    return places;
}

}  // namespace subvol
