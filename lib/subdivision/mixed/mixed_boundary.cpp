// SPDX-License-Identifier: Apache-2.0
// The boundary of a mixed mesh: its faces, its creases, and the kind of each point, which says by which rule it moves.
//
//     faces     those of one cell only. Sorting the corners of all faces brings the two sides of an inner face together
//     creases   boundary edges that are tagged, that belong to one cell alone, at which more than two boundary faces meet, or
//               that bend by more than the angle
//     kinds     no boundary face: Interior. No crease: Smooth. Two creases: Crease. Anything else: Corner, which stays
//
// A point at which several *fans* of boundary faces touch is a Corner: no single surface passes through it.
//
// The boundary of the next level follows from this one without positions (split_boundary), so a crease by angle is found on the
// control mesh alone.
#include "subvol/detail/mixed_levels.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// A face with its corners in ascending order, by which the two sides of an inner face are equal, and in the order of its cell,
/// which says where its outside is.
struct FaceRecord {
    std::array<Index, 4> key;
    std::array<Index, 4> corners;
    auto operator<=>(const FaceRecord&) const = default;
};

std::vector<std::array<Index, 4>> boundary_faces(const MixedMesh& mesh) {
    std::vector<FaceRecord> records;
    each_kind_of(mesh, [&](CellKind kind, const auto& cells) {
        const auto& faces = table_of(kind).faces;
        const std::size_t first = records.size();
        records.resize(first + cells.size() * faces.size());
        parallel_each(cells.size(), [&](std::size_t c) {
            for (std::size_t f = 0; f < faces.size(); ++f) {
                FaceRecord& record = records[first + c * faces.size() + f];
                record.corners = face_of(cells[c], faces[f]);
                record.key = record.corners;
                std::sort(record.key.begin(), record.key.end());
            }
        });
    });
    tbb::parallel_sort(records.begin(), records.end());
    std::vector<std::array<Index, 4>> result;
    for (std::size_t i = 0; i < records.size();) {
        std::size_t end = i + 1;
        while (end < records.size() && records[end].key == records[i].key) ++end;
        // One record is a face of the boundary, two are the sides of an inner face.
        if (end - i == 1) result.push_back(records[i].corners);
        if (end - i > 2) {
            std::string points;
            for (const Index p : records[i].key) points += p == kNone ? "" : " " + std::to_string(p);
            throw Error(ErrorCode::InvalidInput, std::to_string(end - i) + " cells share the face of points" + points, {},
                        "at most two cells share a face");
        }
        i = end;
    }
    return result;
}

/// An edge of a boundary face; the face has it from `from` to the other end.
struct BoundaryEdge {
    std::array<Index, 2> ends;
    Index from;
    Index face;
    auto operator<=>(const BoundaryEdge&) const = default;
};

std::vector<BoundaryEdge> boundary_edges(const std::vector<std::array<Index, 4>>& faces) {
    std::vector<BoundaryEdge> edges;
    for (Index f = 0; f < faces.size(); ++f) {
        const std::size_t count = faces[f][3] == kNone ? 3 : 4;
        for (std::size_t k = 0; k < count; ++k) {
            const Index a = faces[f][k], b = faces[f][(k + 1) % count];
            edges.push_back({{std::min(a, b), std::max(a, b)}, a, f});
        }
    }
    tbb::parallel_sort(edges.begin(), edges.end());
    return edges;
}

/// Normal to a triangle, or to the diagonals of a quad; not of unit length.
Vec3 normal_of(const std::vector<Vec3>& points, const std::array<Index, 4>& face) {
    const Vec3 &a = points[face[0]], &b = points[face[1]], &c = points[face[2]];
    return face[3] == kNone ? glm::cross(b - a, c - a) : glm::cross(c - a, points[face[3]] - b);
}

/// How many cells have each of these edges, which are sorted.
std::vector<Index> cells_of_edges(const MixedMesh& mesh, const std::vector<std::array<Index, 2>>& edges) {
    std::vector<Index> count(edges.size());
    std::vector<std::uint8_t> on_boundary(mesh.points.size());
    for (const auto& [a, b] : edges) on_boundary[a] = on_boundary[b] = 1;
    each_kind_of(mesh, [&](CellKind kind, const auto& cells) {
        for (const auto& cell : cells) {
            for (const auto& ends : table_of(kind).edges) {
                const auto key = edge_of(cell, ends);
                // Most edges lie inside; two look-ups of flags spare their bisection.
                if (!on_boundary[key[0]] || !on_boundary[key[1]]) continue;
                const auto found = std::lower_bound(edges.begin(), edges.end(), key);
                if (found != edges.end() && *found == key) ++count[static_cast<std::size_t>(found - edges.begin())];
            }
        }
    });
    return count;
}

/// The number of fans of boundary faces that meet at each point: faces are in one fan if they share an edge there. Each corner
/// of a face starts as a fan of its own; edges join the fans of their faces at both ends (union-find).
std::vector<std::uint8_t> count_fans(std::size_t points, const std::vector<std::array<Index, 4>>& faces,
                                     const std::vector<BoundaryEdge>& edges) {
    struct Corner {
        Index point, face;
        auto operator<=>(const Corner&) const = default;
    };
    std::vector<Corner> corners;
    for (Index f = 0; f < faces.size(); ++f) {
        for (const Index p : faces[f]) {
            if (p != kNone) corners.push_back({p, f});
        }
    }
    tbb::parallel_sort(corners.begin(), corners.end());
    DisjointSets fans(corners.size());
    const auto join = [&](Index point, Index f0, Index f1) {
        const auto place = [&](Index f) {
            return static_cast<Index>(std::lower_bound(corners.begin(), corners.end(), Corner{point, f}) - corners.begin());
        };
        fans.join(place(f0), place(f1));
    };
    for (std::size_t e = 1; e < edges.size(); ++e) {
        if (edges[e].ends != edges[e - 1].ends) continue;
        for (const Index p : edges[e].ends) join(p, edges[e - 1].face, edges[e].face);
    }
    std::vector<std::uint8_t> count(points);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        auto& n = count[corners[i].point];
        // Each fan has one corner that is its least.
        if (fans.least(static_cast<Index>(i)) == i && n < 255) ++n;
    }
    return count;
}

}  // namespace

MixedBoundary find_boundary(const MixedMesh& mesh, std::optional<double> crease_angle_deg) {
    if (crease_angle_deg && !(*crease_angle_deg > 0 && *crease_angle_deg <= 180)) {
        throw Error(ErrorCode::InvalidInput, "the crease angle is " + number_text(*crease_angle_deg), {},
                    "more than 0, at most 180 degrees");
    }
    MixedBoundary result;
    result.faces = boundary_faces(mesh);
    const auto edges = boundary_edges(result.faces);
    std::vector<std::array<Index, 2>> unique;
    for (const auto& edge : edges) {
        if (unique.empty() || unique.back() != edge.ends) unique.push_back(edge.ends);
    }
    auto tagged = mesh.creases;
    for (auto& [a, b] : tagged) {
        if (a > b) std::swap(a, b);
        if (std::binary_search(unique.begin(), unique.end(), std::array<Index, 2>{a, b})) continue;
        throw Error(ErrorCode::InvalidInput,
                    "the crease from point " + std::to_string(a) + " to point " + std::to_string(b) + " is not on the boundary",
                    {}, "creases are edges of the boundary");
    }
    std::sort(tagged.begin(), tagged.end());
    const auto cells = cells_of_edges(mesh, unique);
    // An edge's records follow each other in `edges`: two for a smooth edge. Normals are compared without dividing by their
    // lengths, which may be 0.
    const bool bent_is_sharp = crease_angle_deg.value_or(180) < 180;
    const double least_cosine = bent_is_sharp ? std::cos(*crease_angle_deg * std::numbers::pi / 180) : -2;
    std::size_t i = 0;
    for (std::size_t e = 0; e < unique.size(); ++e) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].ends == unique[e]) ++end;
        bool sharp = cells[e] == 1 || end - i != 2 || std::binary_search(tagged.begin(), tagged.end(), unique[e]);
        if (!sharp && bent_is_sharp) {
            const Vec3 n0 = normal_of(mesh.points, result.faces[edges[i].face]);
            const Vec3 n1 = normal_of(mesh.points, result.faces[edges[i + 1].face]);
            sharp = glm::dot(n0, n1) < least_cosine * glm::length(n0) * glm::length(n1);
        }
        if (sharp) result.creases.push_back(unique[e]);
        i = end;
    }
    std::vector<std::uint8_t> creases_at(mesh.points.size());
    for (const auto& crease : result.creases) {
        for (const Index p : crease) creases_at[p] = static_cast<std::uint8_t>(std::min(creases_at[p] + 1, 3));
    }
    const auto fans_at = count_fans(mesh.points.size(), result.faces, edges);
    result.kinds.resize(mesh.points.size());
    for (std::size_t p = 0; p < result.kinds.size(); ++p) {
        result.kinds[p] = fans_at[p] == 0      ? PointKind::Interior
                          : fans_at[p] > 1     ? PointKind::Corner
                          : creases_at[p] == 0 ? PointKind::Smooth
                          : creases_at[p] == 2 ? PointKind::Crease
                                               : PointKind::Corner;
    }
    return result;
}

MixedBoundary split_boundary(const MixedBoundary& parent, const SplitNumbers& numbers) {
    MixedBoundary child;
    // Old points keep their kinds, because the new boundary meets in them as the old one did.
    child.kinds = parent.kinds;
    child.kinds.resize(numbers.size(), PointKind::Interior);
    child.faces.resize(4 * parent.faces.size());
    for (std::size_t f = 0; f < parent.faces.size(); ++f) {
        const auto& corners = parent.faces[f];
        const std::size_t count = corners[3] == kNone ? 3 : 4;
        std::array<Index, 4> middle{};
        for (std::size_t k = 0; k < count; ++k) {
            middle[k] = numbers.edge(corners[k], corners[(k + 1) % count]);
            // Middles of creases are set below, after those of all faces.
            child.kinds[middle[k]] = PointKind::Smooth;
        }
        if (count == 3) {
            for (std::size_t k = 0; k < 3; ++k) child.faces[4 * f + k] = {corners[k], middle[k], middle[(k + 2) % 3], kNone};
            child.faces[4 * f + 3] = {middle[0], middle[1], middle[2], kNone};
        } else {
            const Index center = numbers.quad(corners);
            child.kinds[center] = PointKind::Smooth;
            for (std::size_t k = 0; k < 4; ++k) child.faces[4 * f + k] = {corners[k], middle[k], center, middle[(k + 3) % 4]};
        }
    }
    child.creases.reserve(2 * parent.creases.size());
    for (const auto& [a, b] : parent.creases) {
        const Index middle = numbers.edge(a, b);
        child.kinds[middle] = PointKind::Crease;
        child.creases.push_back({a, middle});
        child.creases.push_back({b, middle});
    }
    std::sort(child.creases.begin(), child.creases.end());
    return child;
}

}  // namespace subvol::detail
