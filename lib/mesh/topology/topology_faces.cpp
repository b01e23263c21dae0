// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/surface_builder.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Quad = std::array<Index, 4>;

struct FaceRecord {
    Quad points;
    Index cell;
    std::uint8_t side;
    auto operator<=>(const FaceRecord&) const = default;
};

Quad canonical_quad(const std::array<Index, 8>& cell, std::size_t side) {
    Quad quad = outward_quad(cell, side);
    if (quad[1] > quad[3]) std::swap(quad[1], quad[3]);
    return quad;
}

/// Sorts the faces of cells for whose points `where` is true. Those of two cells follow each other.
template <class Cells, class Where>
FlatArray<FaceRecord> sorted_faces(const Cells& cells, std::size_t point_count, const Where& where) {
    auto sorted = bucket_sort<FaceRecord>(
        cells.size(), point_count,
        [&](std::size_t c, const auto& sink) {
            for (std::size_t side = 0; side < 6; ++side) {
                const Quad points = canonical_quad(cells[c], side);
                if (where(points)) sink({points, static_cast<Index>(c), static_cast<std::uint8_t>(side)});
            }
        },
        [](const FaceRecord& record) { return record.points[0]; });
    return std::move(sorted.records);
}

template <class Cells>
std::string name_cells(const Cells& cells, Index a, Index b) {
    auto corners_a = cells[a], corners_b = cells[b];
    std::sort(corners_a.begin(), corners_a.end());
    std::sort(corners_b.begin(), corners_b.end());
    if (corners_a != corners_b) return {};
    return "cells " + std::to_string(a) + " and " + std::to_string(b) + " have the same corners (cells counted from 0)";
}

template <class Cells>
[[noreturn]] void refuse_face(const Cells& all, std::span<const FaceRecord> sharing) {
    // Few are enough to be compared with each other, however many there are.
    constexpr std::size_t kCompared = 100;
    const std::size_t compared = std::min(kCompared, sharing.size());
    for (std::size_t i = 0; i < compared; ++i) {
        for (std::size_t j = i + 1; j < compared; ++j) {
            const auto text = name_cells(all, sharing[i].cell, sharing[j].cell);
            if (!text.empty()) throw Error(ErrorCode::InvalidInput, text, {}, "each cell may be listed once");
        }
    }
    std::string points;
    for (const Index p : sharing[0].points) points += (points.empty() ? "" : " ") + std::to_string(p);
    std::vector<std::string> cells;
    for (const auto& record : sharing) cells.push_back(std::to_string(record.cell));
    throw Error(ErrorCode::InvalidInput,
                "face (" + points + ") has " + std::to_string(sharing.size()) + " cells: " + listed(cells) +
                    " (points and cells counted from 0)",
                {}, "at most two cells share a face");
}

/// Two cells with the same corners and no third neighbour share all six faces, which cannot be seen at any one face.
void refuse_twins(const Topology& topology) {
    for (const auto& sides : topology.cell_faces) {
        const auto first = topology.face_cells[sides[0]];
        if (first[1] == kNone) continue;
        if (std::all_of(sides.begin(), sides.end(), [&](Index f) { return topology.face_cells[f] == first; })) {
            throw Error(ErrorCode::InvalidInput, name_cells(topology.cells, first[0], first[1]), {},
                        "each cell may be listed once");
        }
    }
}

}  // namespace

void check_count(std::size_t count, std::string_view kind) {
    if (count < kNone) return;
    throw Error(ErrorCode::InvalidInput, "the mesh has " + std::to_string(count) + " " + std::string(kind), {},
                "at most " + std::to_string(kNone - 1) + ", or a build with SUBVOL_INDEX64");
}

void build_faces(Topology& topology) {
    const auto records = sorted_faces(topology.cells, topology.point_count, [](const Quad&) { return true; });
    const auto starts = group_starts(records, [](const auto& a, const auto& b) { return a.points == b.points; });

    const std::size_t count = starts.size() - 1;
    check_count(count, "faces");
    for (std::size_t f = 0; f < count; ++f) {
        if (starts[f + 1] - starts[f] > 2)
            refuse_face(topology.cells, std::span(records).subspan(starts[f], starts[f + 1] - starts[f]));
    }
    topology.faces.resize(count);
    topology.face_cells.resize(count);
    topology.cell_faces.resize(topology.cells.size());
    parallel_each(count, [&](std::size_t f) {
        topology.faces[f] = records[starts[f]].points;
        topology.face_cells[f] = {records[starts[f]].cell, kNone};
        for (std::size_t i = starts[f]; i < starts[f + 1]; ++i) {
            topology.face_cells[f][i - starts[f]] = records[i].cell;
            topology.cell_faces[records[i].cell][records[i].side] = static_cast<Index>(f);
        }
    });
    refuse_twins(topology);
}

std::vector<Quad> hull_quads(const HexMesh& mesh, const std::function<bool(const Quad&)>& where) {
    const auto records = sorted_faces(mesh.cells, mesh.points.size(), where);
    std::vector<Quad> quads;
    for (std::size_t first = 0, end = 0; first < records.size(); first = end) {
        const FaceRecord& record = records[first];
        for (end = first + 1; end < records.size() && records[end].points == record.points;) ++end;
        if (end - first > 2) refuse_face(mesh.cells, std::span(records).subspan(first, end - first));
        if (end - first == 1) quads.push_back(outward_quad(mesh.cells[record.cell], record.side));
    }
    return quads;
}

std::array<Index, 4> outward_quad(const std::array<Index, 8>& cell, std::size_t side) {
    Quad quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = cell[kCellFaces[side][k]];
    std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
    return quad;
}

std::array<Index, 4> outward_quad(const Topology& topology, Index cell, Index face) {
    const auto& sides = topology.cell_faces[cell];
    return outward_quad(topology.cells[cell],
                        static_cast<std::size_t>(std::find(sides.begin(), sides.end(), face) - sides.begin()));
}

Surface boundary_surface_where(const HexMesh& mesh, const std::function<bool(const std::array<Index, 4>&)>& where) {
    SurfaceBuilder builder(mesh.points.size());
    for (const auto& quad : hull_quads(mesh, where)) builder.add(quad);
    return builder.finish([&](Index p) { return mesh.points[p]; });
}

}  // namespace subvol::detail

namespace subvol {

Box bounds(const Surface& surface) {
    Box box;
    for (const auto& t : surface.triangles) {
        for (const Index p : t) box.add(surface.points[p]);
    }
    return box;
}

double enclosed_volume(const Surface& closed) {
    const Vec3 x = closed.points.empty() ? Vec3(0.0) : closed.points.front();  // near, so that no digits are lost
    double volume = 0;
    for (const auto& [a, b, c] : closed.triangles)
        volume += glm::dot(closed.points[a] - x, glm::cross(closed.points[b] - x, closed.points[c] - x)) / 6;
    return volume;
}

Surface boundary_surface(const HexMesh& mesh) {
    return detail::boundary_surface_where(mesh, [](const auto&) { return true; });
}

}  // namespace subvol
