// SPDX-License-Identifier: Apache-2.0
// Tetrahedra from back to front, so that each may be blended over what lies behind it.
//
// A shared face decides between its two tetrahedra: the one on the eye's side of the face's plane is nearer. These relations
// are the arrows of a graph, and an order that respects them all is a topological sort (MPVO [williams1992], [mhc1990]):
//
//     eye            A before B before C: each waits until all tetrahedra behind its faces have been
//      *  ->  C|B|A  drawn. Of those that wait for none, the one with the farthest centroid is next.
//
// In a convex mesh without cycles the result is exact. Where the mesh is not convex, parts without a common face are ordered by
// their centroids (Williams' heuristic, MPVONC), which can be wrong. Three or more tetrahedra may also lie behind each other in
// a cycle; then none is ready, the farthest one left is drawn anyway, and `cycles` counts it.
#include "tet_order.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

std::vector<double> centroid_depths(const TetMesh& mesh, const View& view) {
    std::vector<double> depths(mesh.tets.size());
    parallel_each(depths.size(), [&](std::size_t t) {
        Vec3 sum(0.0);
        for (const Index p : mesh.tets[t].corner) sum += mesh.points[p].position;
        depths[t] = view.to_eye(0.25 * sum).z;
    });
    return depths;
}

/// The direction from a point to the eye.
Vec3 towards_eye(const View& view, const Vec3& from) {
    return view.perspective() ? view.eye() - from : -view.axes()[2];
}

/// Six times the signed volume.
double volume_of(const TetMesh& mesh, const TetMesh::Tet& tet) {
    const Vec3& p = mesh.points[tet.corner[0]].position;
    return dot(cross(mesh.points[tet.corner[1]].position - p, mesh.points[tet.corner[2]].position - p),
               mesh.points[tet.corner[3]].position - p);
}

/// Whether the eye is on the outer side of the face opposite to corner k: then the neighbour across it is nearer.
bool faces_eye(const TetMesh& mesh, const View& view, std::uint32_t tet, std::uint32_t k, bool& edge_on) {
    const auto ids = mesh.corners(4 * tet + k);
    const Vec3& p = mesh.points[ids[0]].position;
    const Vec3 normal = cross(mesh.points[ids[1]].position - p, mesh.points[ids[2]].position - p);
    const double inside = dot(normal, mesh.points[mesh.tets[tet].corner[k]].position - p);
    const double eye = dot(normal, towards_eye(view, p));
    edge_on = eye == 0 || inside == 0;
    return (eye > 0) != (inside > 0);
}

/// For every tetrahedron, a bit for each face whose neighbour is nearer.
///
/// The tetrahedron of larger volume decides for both, as its corner lies farther from the plane of the face.
std::vector<std::uint8_t> find_nearer(const TetMesh& mesh, const View& view) {
    std::vector<double> volumes(mesh.tets.size());
    parallel_each(volumes.size(), [&](std::size_t t) { volumes[t] = std::abs(volume_of(mesh, mesh.tets[t])); });
    std::vector<std::uint8_t> nearer(mesh.tets.size());
    parallel_each(nearer.size(), [&](std::size_t i) {
        const auto t = static_cast<std::uint32_t>(i);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Index other = mesh.neighbor(t, k);
            if (other == kNone) continue;
            const bool mine = volumes[t] != volumes[other] ? volumes[t] > volumes[other] : t < other;
            std::uint32_t there = 0;
            while (mesh.neighbor(other, there) != t) ++there;
            bool edge_on = false;
            const bool outside = mine ? faces_eye(mesh, view, t, k, edge_on) : !faces_eye(mesh, view, other, there, edge_on);
            if (outside && !edge_on) nearer[t] = static_cast<std::uint8_t>(nearer[t] | (1U << k));
        }
    });
    return nearer;
}

}  // namespace

TetOrder order_by_centroid(const TetMesh& mesh, const View& view) {
    const std::vector<double> depths = centroid_depths(mesh, view);
    TetOrder order;
    order.tets.resize(depths.size());
    std::iota(order.tets.begin(), order.tets.end(), 0U);
    tbb::parallel_sort(order.tets.begin(), order.tets.end(), [&](std::uint32_t a, std::uint32_t b) {
        return depths[a] != depths[b] ? depths[a] > depths[b] : a < b;
    });
    return order;
}

TetOrder order_topologically(const TetMesh& mesh, const View& view) {
    const std::vector<std::uint32_t> by_centroid = order_by_centroid(mesh, view).tets;
    const std::vector<std::uint8_t> nearer = find_nearer(mesh, view);
    const std::size_t count = mesh.tets.size();
    std::vector<std::uint32_t> place(count);
    for (std::size_t i = 0; i < count; ++i) place[by_centroid[i]] = static_cast<std::uint32_t>(i);
    std::vector<std::uint8_t> waits_for(count);
    const auto for_each_nearer = [&](std::uint32_t tet, const auto& body) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            if ((nearer[tet] >> k) & 1U) body(mesh.neighbor(tet, k));
        }
    };
    for (std::uint32_t t = 0; t < count; ++t) for_each_nearer(t, [&](Index other) { ++waits_for[other]; });

    constexpr std::uint8_t kDone = 255;
    // Positions in by_centroid: the farthest comes first.
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> ready;
    for (std::size_t i = 0; i < count; ++i) {
        if (waits_for[by_centroid[i]] == 0) ready.push(static_cast<std::uint32_t>(i));
    }
    TetOrder order;
    order.tets.reserve(count);
    for (std::size_t farthest = 0; order.tets.size() < count;) {
        if (ready.empty()) {
            while (waits_for[by_centroid[farthest]] == kDone) ++farthest;
            waits_for[by_centroid[farthest]] = 0;
            ready.push(static_cast<std::uint32_t>(farthest));
            ++order.cycles;
        }
        const std::uint32_t tet = by_centroid[ready.top()];
        ready.pop();
        waits_for[tet] = kDone;
        order.tets.push_back(tet);
        for_each_nearer(tet, [&](Index other) {
            if (waits_for[other] != kDone && waits_for[other] > 0 && --waits_for[other] == 0) ready.push(place[other]);
        });
    }
    return order;
}

}  // namespace subvol::detail
