// SPDX-License-Identifier: Apache-2.0
#include "tet_faces.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "subvol/detail/parallel_each.h"
#include "subvol/detail/word_hash.h"

namespace subvol::detail {

namespace {

struct Numbered {
    double key;
    std::uint32_t number;

    bool operator<(const Numbered& other) const { return key != other.key ? key < other.key : number < other.number; }
};

double signed_volume(const TetMesh& mesh, const std::array<Index, 4>& corner) {
    const Vec3& p = mesh.points[corner[0]].position;
    return dot(cross(mesh.points[corner[1]].position - p, mesh.points[corner[2]].position - p),
               mesh.points[corner[3]].position - p);
}

/// Sorts three corners; returns whether that turns the face over.
bool sort_corners(std::array<Index, 3>& corner) {
    bool turned = false;
    const auto sort_two = [&](std::size_t a, std::size_t b) {
        if (corner[a] <= corner[b]) return;
        std::swap(corner[a], corner[b]);
        turned = !turned;
    };
    sort_two(0, 1);
    sort_two(1, 2);
    sort_two(0, 1);
    return turned;
}

/// +1 if the tetrahedron is on the side of the normal of its face with sorted corners, else −1. For a tetrahedron without
/// volume the result is arbitrary but consistent for its four faces: a ray leaves it as often as it enters.
int side_of_face(bool positive, std::uint32_t k, bool turned) {
    return (positive != (k % 2 == 0)) != turned ? 1 : -1;
}

/// The same for the tetrahedron across a face. Two tetrahedra may share more than one face.
int side_of_same_face(const TetMesh& mesh, Index tet, Index from, const std::array<Index, 3>& sorted, bool positive) {
    for (std::uint32_t k = 0; k < 4; ++k) {
        if (mesh.neighbor(tet, k) != from) continue;
        auto corner = mesh.corners(4 * tet + k);
        const bool turned = sort_corners(corner);
        if (corner == sorted) return side_of_face(positive, k, turned);
    }
    return 0;
}

/// A random waiting time made from the face's corners: the larger the face, the earlier its turn. Choosing by area makes the
/// error of a partial picture less by a fifth than choosing evenly.
double shuffle_key(const TetMesh& mesh, const TetFaces::Face& face) {
    std::uint64_t bits = detail::kGoldenWord;
    for (const Index corner : face.corner) bits = detail::mixed(bits + corner);
    const double random = (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;  // in (0, 1)
    const Vec3& p = mesh.points[face.corner[0]].position;
    const Vec3 normal = cross(mesh.points[face.corner[1]].position - p, mesh.points[face.corner[2]].position - p);
    return -std::log(random) / glm::length(normal);
}

/// An unsigned integer that ascends with x.
std::uint32_t ascending_bits(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits ^ ((bits >> 31) != 0 ? 0xffffffffU : 0x80000000U);
}

}  // namespace

std::size_t TetFaces::count(double fraction) const {
    const auto inner = static_cast<double>(faces.size() - outer);
    return outer + static_cast<std::size_t>(std::ceil(fraction * inner));
}

TetFaces find_faces(const TetMesh& mesh) {
    std::vector<std::uint8_t> positive(mesh.tets.size());
    parallel_each(positive.size(), [&](std::size_t t) { positive[t] = signed_volume(mesh, mesh.tets[t].corner) >= 0 ? 1 : 0; });
    TetFaces result;
    std::vector<TetFaces::Face> inner;
    for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Index other = mesh.neighbor(t, k);
            if (other < t) continue;  // kNone is larger than any number
            auto corner = mesh.corners(4 * t + k);
            int cover = side_of_face(positive[t] != 0, k, sort_corners(corner));
            if (other != kNone) cover += side_of_same_face(mesh, other, t, corner, positive[other] != 0);
            (cover == 0 ? inner : result.faces).push_back({corner, static_cast<std::uint32_t>(2 + cover)});
        }
    }
    result.outer = result.faces.size();
    std::vector<Numbered> order(inner.size());
    parallel_each(order.size(), [&](std::size_t i) {
        order[i] = {shuffle_key(mesh, inner[i]), static_cast<std::uint32_t>(i)};
    });
    tbb::parallel_sort(order.begin(), order.end());
    result.faces.resize(result.outer + inner.size());
    parallel_each(order.size(), [&](std::size_t i) { result.faces[result.outer + i] = inner[order[i].number]; });
    return result;
}

std::vector<std::uint32_t> order_faces(const TetMesh& mesh, const TetFaces& faces, std::size_t count, const View& view) {
    std::vector<std::uint64_t> keys(count);
    parallel_each(count, [&](std::size_t i) {
        Vec3 sum(0.0);
        for (const Index p : faces.faces[i].corner) sum += mesh.points[p].position;
        const auto depth = static_cast<float>(view.to_eye(sum / 3.0).z);
        keys[i] = std::uint64_t{ascending_bits(depth)} << 32 | i;
    });
    tbb::parallel_sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> order(count);
    parallel_each(count, [&](std::size_t i) { order[i] = static_cast<std::uint32_t>(keys[i]); });
    return order;
}

double value_at(const TetMesh& mesh, const Vec3& point) {
    struct Best {
        double inside = -std::numeric_limits<double>::infinity(), value = 0;
    };
    // The least of the barycentric weights measures how far inside the point is. Among equals the first wins.
    const auto better = [&](Best best, std::size_t t) {
        const auto& corner = mesh.tets[t].corner;
        const double volume = signed_volume(mesh, corner);
        if (volume == 0) return best;
        Best candidate{std::numeric_limits<double>::infinity(), 0};
        for (std::size_t k = 0; k < 4; ++k) {
            std::array<Vec3, 4> p;
            for (std::size_t i = 0; i < 4; ++i) p[i] = i == k ? point : mesh.points[corner[i]].position;
            const double weight = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / volume;
            candidate.inside = std::min(candidate.inside, weight);
            candidate.value += weight * mesh.points[corner[k]].value;
        }
        return candidate.inside > best.inside ? candidate : best;
    };
    return tbb::parallel_reduce(
               tbb::blocked_range<std::size_t>(0, mesh.tets.size(), 4096), Best{},
               [&](const auto& range, Best best) {
                   for (std::size_t t = range.begin(); t < range.end(); ++t) best = better(best, t);
                   return best;
               },
               [](const Best& a, const Best& b) { return b.inside > a.inside ? b : a; })
        .value;
}

}  // namespace subvol::detail
