// SPDX-License-Identifier: Apache-2.0
// Counts and measures of a mesh, in memory or in pieces.
//
// Counts come from parts of the mesh with their own topology, so that of the whole is never needed. A part counts an edge or a
// face if it owns the smallest of its points, so that each is counted once; threads have counts of their own, which are added.
//
// Shapes come from the corners of the cells: with u, v, w the edges at a corner, the scaled Jacobian there is
// det(u, v, w) / (|u| |v| |w|), and a cell is inverted if a determinant is negative. Volumes are summed in blocks of 4096 cells
// and these in their order, so that rounding does not depend on the threads.
//
// Pieces, and shares of the work on a mesh, have figures of the same kind; joined, counts add up, the least of all Jacobians is
// kept, and volumes are added in the order of the pieces. Creases and sharp faces do not matter here.
#include "subvol/mesh_report.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "subvol/cell.h"
#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/mesh_parts.h"
#include "subvol/detail/mesh_share.h"

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

void add_counts(MeshReport& report, const MeshReport& more) {
    report.points_used += more.points_used;
    report.edges += more.edges;
    report.faces += more.faces;
    report.boundary_faces += more.boundary_faces;
    report.interior_edges += more.interior_edges;
    for (const auto& [valence, edges] : more.interior_edge_valence) report.interior_edge_valence[valence] += edges;
    report.singular_nodes += more.singular_nodes;
    report.nonmanifold_edges += more.nonmanifold_edges;
    report.nonmanifold_points += more.nonmanifold_points;
}

/// Calls add(i, counts) for every i in [0, count), in parallel, and adds the counts to the report.
template <class Add>
void count_each(std::size_t count, MeshReport& report, const Add& add) {
    tbb::enumerable_thread_specific<MeshReport> of_threads;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
        MeshReport& counts = of_threads.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) add(static_cast<Index>(i), counts);
    });
    for (const MeshReport& counts : of_threads) add_counts(report, counts);
}

/// Counts the edges whose smaller point is the part's own.
void count_edges(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    count_each(topology.edges.size(), report, [&](Index e, MeshReport& counts) {
        if (!part.own[topology.edges[e][0]]) return;
        ++counts.edges;
        if (topology.edge_on_boundary[e]) {
            counts.nonmanifold_edges += topology.boundary_faces_at(e) != 2;
        } else {
            ++counts.interior_edges;
            ++counts.interior_edge_valence[static_cast<int>(topology.edge_cells[e].size())];
        }
    });
}

/// Counts the faces whose smallest point is the part's own.
void count_faces(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    count_each(topology.faces.size(), report, [&](Index f, MeshReport& counts) {
        if (!part.own[topology.faces[f][0]]) return;
        ++counts.faces;
        counts.boundary_faces += topology.face_on_hull(f);
    });
}

void count_points(const detail::MeshPart& part, MeshReport& report) {
    const Topology& topology = part.topology;
    count_each(topology.point_count, report, [&](Index p, MeshReport& counts) {
        if (!part.own[p]) return;
        ++counts.points_used;
        if (topology.point_on_boundary[p]) {
            counts.nonmanifold_points += detail::is_touching_point(topology, p);
            return;
        }
        const auto irregular = std::ranges::count_if(topology.point_edges[p], [&](Index e) {
            return !topology.edge_on_boundary[e] && topology.edge_cells[e].size() != 4;
        });
        counts.singular_nodes += irregular != 0 && irregular != 2;
    });
}

constexpr std::size_t kPart = 4096;  // cells that are summed together, so that rounding does not depend on the threads

std::size_t summed_parts(const HexMesh& mesh) {
    return (mesh.cells.size() + kPart - 1) / kPart;
}

/// The shapes of some parts of the cells, from part `begin` to before `end`.
std::vector<ShapeReport> shapes_of_parts(const HexMesh& mesh, std::size_t begin, std::size_t end) {
    std::vector<ShapeReport> parts(end - begin);
    tbb::parallel_for(begin, end, [&](std::size_t i) {
        for (std::size_t c = i * kPart; c < std::min(mesh.cells.size(), (i + 1) * kPart); ++c) {
            add(parts[i - begin], quality_of(mesh, c));
        }
    });
    return parts;
}

}  // namespace

double min_scaled_jacobian(const std::array<Vec3, 8>& corners) {
    return measure(corners).min_scaled_jacobian;
}

double aspect_ratio(const std::array<Vec3, 8>& corners) {
    constexpr double kMost = 1e9;
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (const auto& [a, b] : kCellEdges) {
        const double length = glm::distance(corners[a], corners[b]);
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
    }
    return longest < kMost * shortest ? longest / shortest : kMost;
}

ShapeReport measure_cells(const HexMesh& mesh) {
    ShapeReport report;
    for (const ShapeReport& part : shapes_of_parts(mesh, 0, summed_parts(mesh))) {
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

std::vector<std::size_t> inverted_cells(const HexMesh& moved, std::span<const Vec3> before,
                                        std::span<const std::size_t> known) {
    std::vector<std::uint8_t> has_moved(moved.points.size());
    for (std::size_t p = 0; p < has_moved.size(); ++p) has_moved[p] = moved.points[p] != before[p] ? 1 : 0;
    std::vector<std::size_t> numbers;
    auto next = known.begin();
    for (std::size_t c = 0; c < moved.cells.size(); ++c) {
        const bool was = next != known.end() && *next == c;
        if (was) ++next;
        const bool changed = std::ranges::any_of(moved.cells[c], [&](Index p) { return has_moved[p] != 0; });
        if (changed ? quality_of(moved, c).inverted : was) numbers.push_back(c);
    }
    return numbers;
}

void detail::add_part(const HexMesh& part, std::span<const std::uint8_t> owned_points,
                      std::span<const std::uint8_t> owned_cells, MeshReport& report) {
    HexMesh bare;  // tags matter only to schemes
    bare.points = part.points;
    bare.cells = part.cells;
    validate(bare);
    each_part(bare, [&](const MeshPart& piece) {
        MeshPart owned = piece;
        for (std::size_t p = 0; p < owned.own.size(); ++p) owned.own[p] = owned.own[p] && owned_points[owned.points[p]];
        count_points(owned, report);
        count_edges(owned, report);
        count_faces(owned, report);
    });
    std::size_t kept = 0;
    for (std::size_t c = 0; c < part.cells.size(); ++c) {
        if (!owned_cells[c]) continue;
        for (const Index p : bare.cells[c]) report.bounds.add(bare.points[p]);
        bare.cells[kept++] = bare.cells[c];
    }
    bare.cells.resize(kept);
    const ShapeReport shape = measure_cells(bare);
    const bool first = report.cells == 0;
    report.cells += kept;
    for (const std::uint8_t owned : owned_points) report.points += owned;
    report.inverted_cells += shape.inverted_cells;
    report.degenerate_cells += shape.degenerate_cells;
    report.min_scaled_jacobian =
        first ? shape.min_scaled_jacobian : std::min(report.min_scaled_jacobian, shape.min_scaled_jacobian);
    report.volume += shape.volume;
}

namespace {

MeshReport inspect_mesh(const HexMesh& mesh, Progress* progress) {
    validate(mesh);
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) {  // tags matter only to schemes
        HexMesh untagged;
        untagged.points = mesh.points;
        untagged.cells = mesh.cells;
        return inspect_mesh(untagged, progress);
    }
    MeshReport report;
    report.points = mesh.points.size();
    report.cells = mesh.cells.size();
    report.bounds = bounds(mesh);
    detail::each_part(mesh, [&](const detail::MeshPart& part) {
        report_progress(progress, "inspect", report.points_used, report.points);
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

detail::MeshShare share_of_mesh(const HexMesh& mesh, const Share& share, std::size_t inverted_at_most) {
    using namespace detail;
    validate(mesh);
    validate(share);
    HexMesh untagged;
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) {
        untagged.points = mesh.points;
        untagged.cells = mesh.cells;
    }
    MeshShare made;
    MeshReport& counts = made.counts;
    counts.points = mesh.points.size();
    counts.cells = mesh.cells.size();
    counts.bounds = bounds(mesh);
    counts.min_scaled_jacobian = 1;
    each_part(untagged.cells.empty() ? mesh : untagged, share, [&](const MeshPart& some) {
        count_points(some, counts);
        count_edges(some, counts);
        count_faces(some, counts);
    });
    const std::size_t parts = summed_parts(mesh);
    const auto [begin, end] = share.range(parts);
    made.range = {begin, end, parts};
    for (const ShapeReport& shape : shapes_of_parts(mesh, begin, end)) {
        made.volumes.push_back(shape.volume);
        counts.inverted_cells += shape.inverted_cells;
        counts.degenerate_cells += shape.degenerate_cells;
        counts.min_scaled_jacobian = std::min(counts.min_scaled_jacobian, shape.min_scaled_jacobian);
    }
    for (std::size_t c = begin * kPart; c < std::min(end * kPart, mesh.cells.size()); ++c) {
        if (counts.inverted_cells == 0 || made.inverted.size() == inverted_at_most) break;
        if (quality_of(mesh, c).inverted) made.inverted.push_back(c);
    }
    return made;
}

/// The figures of some pieces, from `begin` to before `end`.
detail::MeshShare share_of_pieces(const MeshSource::Stored& stored, std::size_t begin, std::size_t end,
                                  std::size_t inverted_at_most, Progress* progress) {
    detail::MeshShare share;
    MeshReport& counts = share.counts;
    for (std::size_t p = begin; p < end; ++p) {
        report_progress(progress, "inspect", p - begin, end - begin);
        const MeshPiece piece = stored.read(p);
        counts.volume = 0;
        const std::size_t inverted_before = counts.inverted_cells;
        detail::add_part(piece.mesh, piece.owned_points, piece.owned_cells, counts);
        share.volumes.push_back(counts.volume);
        if (counts.inverted_cells == inverted_before) continue;
        for (const std::size_t cell : inverted_cells(piece.mesh, piece.mesh.cells.size())) {
            if (piece.owned_cells[cell]) share.inverted.push_back(static_cast<std::size_t>(piece.cell_numbers[cell]));
        }
        std::ranges::sort(share.inverted);
        share.inverted.resize(std::min(share.inverted.size(), inverted_at_most));
    }
    if (begin == end) counts.min_scaled_jacobian = 1;
    counts.volume = 0;
    counts.points = stored.points;
    counts.cells = stored.cells;
    counts.bounds = stored.bounds;
    return share;
}

}  // namespace

MeshReport inspect(const MeshSource& source, Progress* progress) {
    if (source.mesh() != nullptr) return inspect_mesh(*source.mesh(), progress);
    const detail::MeshShare all = share_of_pieces(source.stored(), 0, source.stored().pieces.size(), 0, progress);
    return detail::join_shares(std::span(&all, 1), 0).counts;
}

detail::MeshShare detail::inspect_share(const MeshSource& source, const Share& share, std::size_t inverted_at_most,
                                        Progress* progress) {
    if (source.mesh() != nullptr) return share_of_mesh(*source.mesh(), share, inverted_at_most);
    validate(share);
    const std::size_t pieces = source.stored().pieces.size();
    const auto [begin, end] = share.range(pieces);
    MeshShare made = share_of_pieces(source.stored(), begin, end, inverted_at_most, progress);
    made.range = {begin, end, pieces};
    return made;
}

detail::MeshShare detail::join_shares(std::span<const MeshShare> shares, std::size_t inverted_at_most) {
    MeshShare whole;
    MeshReport& all = whole.counts;
    all.points = shares.front().counts.points;
    all.cells = shares.front().counts.cells;
    all.bounds = shares.front().counts.bounds;
    all.min_scaled_jacobian = 1;
    for (const auto& [counts, range, volumes, inverted] : shares) {
        add_counts(all, counts);
        all.inverted_cells += counts.inverted_cells;
        all.degenerate_cells += counts.degenerate_cells;
        all.min_scaled_jacobian = std::min(all.min_scaled_jacobian, counts.min_scaled_jacobian);
        all.nonmanifold_faces += counts.nonmanifold_faces;
        for (const double volume : volumes) all.volume += volume;
        whole.inverted.insert(whole.inverted.end(), inverted.begin(), inverted.end());
    }
    std::ranges::sort(whole.inverted);  // the cells of bricks are in no order
    whole.inverted.resize(std::min(whole.inverted.size(), inverted_at_most));
    return whole;
}

Facts facts_of(const MeshReport& report) {
    const auto corner = [](const Vec3& x) { return FactValue(std::array{x.x, x.y, x.z}); };
    Facts valences;
    for (const auto& [valence, edges] : report.interior_edge_valence) valences[std::to_string(valence)] = edges;
    Facts facts;
    facts["points"] = report.points;
    facts["points_used"] = report.points_used;
    facts["cells"] = report.cells;
    facts["edges"] = report.edges;
    facts["faces"] = report.faces;
    facts["boundary_faces"] = report.boundary_faces;
    facts["interior_edges"] = report.interior_edges;
    facts["interior_edge_valence"] = valences;
    facts["singular_nodes"] = report.singular_nodes;
    facts["inverted_cells"] = report.inverted_cells;
    facts["degenerate_cells"] = report.degenerate_cells;
    facts["min_scaled_jacobian"] = report.min_scaled_jacobian;
    facts["nonmanifold_edges"] = report.nonmanifold_edges;
    facts["nonmanifold_points"] = report.nonmanifold_points;
    facts["nonmanifold_faces"] = report.nonmanifold_faces;
    facts["volume"] = report.volume;
    facts["bounds"] = FactValue::List{corner(report.bounds.lower), corner(report.bounds.upper)};
    return facts;
}

}  // namespace subvol
