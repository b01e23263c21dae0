// SPDX-License-Identifier: Apache-2.0
#include "surface_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subvol/detail/triangle_distance.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kTrianglesOfLeaf = 4;

double squared_distance_to(const Box& box, const Vec3& x) {
    const Vec3 off = glm::max(Vec3(0.0), glm::max(box.lower - x, x - box.upper));
    return glm::dot(off, off);
}

Vec3 place_at(const Vec3& weights, const std::array<Vec3, 3>& corners) {
    return corners[0] + weights.y * (corners[1] - corners[0]) + weights.z * (corners[2] - corners[0]);
}

/// The signed solid angle of a triangle as seen from the origin.
///
/// source: [vanoosterom1983]
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double above = glm::dot(a, glm::cross(b, c));
    const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::atan2(above, below);
}

}  // namespace

SurfaceTree::SurfaceTree(const Surface& surface) : surface_(surface) {
    std::vector<Vec3> centers;
    centers.reserve(surface.triangles.size());
    for (Index t = 0; t < surface.triangles.size(); ++t) {
        const auto x = corners(t);
        centers.push_back((x[0] + x[1] + x[2]) / 3.0);
    }
    tree_.emplace(centers, kTrianglesOfLeaf, [&](Index t) {
        Box box;
        for (const Vec3& x : corners(t)) box.add(x);
        return box;
    });
    make_clusters();
}

std::array<Vec3, 3> SurfaceTree::corners(Index triangle) const {
    const auto& t = surface_.triangles[triangle];
    return {surface_.points[t[0]], surface_.points[t[1]], surface_.points[t[2]]};
}

Vec3 SurfaceTree::normal(Index triangle) const {
    const auto x = corners(triangle);
    const Vec3 normal = glm::cross(x[1] - x[0], x[2] - x[0]);
    const double length = glm::length(normal);
    return length > 0 ? normal / length : Vec3(0.0);
}

void SurfaceTree::make_clusters() {
    std::size_t nodes = 0;
    while (!tree_->is_leaf(nodes)) nodes = 2 * nodes + 1;
    nodes = 2 * nodes + 1;
    clusters_.resize(nodes);
    std::vector<double> areas(nodes, 0);
    std::vector<Vec3> moments(nodes, Vec3(0.0));
    for (std::size_t n = nodes; n-- > 0;) {
        if (tree_->is_leaf(n)) {
            const auto [first, last] = tree_->slots(n);
            for (std::size_t slot = first; slot < last; ++slot) {
                const auto x = corners(tree_->item(slot));
                const Vec3 area = 0.5 * glm::cross(x[1] - x[0], x[2] - x[0]);
                clusters_[n].area += area;
                areas[n] += glm::length(area);
                moments[n] += glm::length(area) / 3 * (x[0] + x[1] + x[2]);
            }
        } else {
            for (const std::size_t child : {2 * n + 1, 2 * n + 2}) {
                clusters_[n].area += clusters_[child].area;
                areas[n] += areas[child];
                moments[n] += moments[child];
            }
        }
        const Box& box = tree_->box(n);
        Cluster& cluster = clusters_[n];
        cluster.center = areas[n] > 0 ? moments[n] / areas[n] : box.center();
        cluster.radius = glm::length(glm::max(cluster.center - box.lower, box.upper - cluster.center));
    }
}

SurfacePlace SurfaceTree::nearest(const Vec3& x) const {
    SurfacePlace found;
    double best = std::numeric_limits<double>::infinity();
    std::array<std::pair<std::size_t, double>, 64> open;
    std::size_t count = 0;
    open[count++] = {0, 0.0};
    while (count > 0) {
        const auto [node, least] = open[--count];
        if (least >= best) continue;
        if (!tree_->is_leaf(node)) {
            std::pair<std::size_t, double> near(2 * node + 1, squared_distance_to(tree_->box(2 * node + 1), x));
            std::pair<std::size_t, double> far(2 * node + 2, squared_distance_to(tree_->box(2 * node + 2), x));
            if (far.second < near.second) std::swap(near, far);
            open[count++] = far;
            open[count++] = near;
            continue;
        }
        const auto [first, last] = tree_->slots(node);
        for (std::size_t slot = first; slot < last; ++slot) {
            const Index t = tree_->item(slot);
            const auto c = corners(t);
            const Vec3 weights = nearest_in_triangle(x, c[0], c[1], c[2]).weights;
            const Vec3 place = place_at(weights, c);
            const Vec3 off = x - place;
            const double distance2 = glm::dot(off, off);
            if (distance2 >= best) continue;
            best = distance2;
            found.triangle = t;
            found.weights = weights;
            found.point = place;
        }
    }
    found.distance = std::sqrt(best);
    constexpr double kOn = 1e-9;  // of the surface's box: shorter vectors have no direction
    found.toward =
        found.distance > kOn * tree_->box(0).diagonal() ? (x - found.point) / found.distance : normal(found.triangle);
    return found;
}

bool SurfaceTree::pierced_by(const Vec3& a, const Vec3& b, double touching) const {
    Box segment;
    segment.add(a);
    segment.add(b);
    bool pierced = false;
    tree_->visit_leaves(
        [&](const Box& box) { return meet(box, segment); },
        [&](std::size_t first, std::size_t last) {
            for (std::size_t slot = first; slot < last && !pierced; ++slot) {
                const Index t = tree_->item(slot);
                const auto x = corners(t);
                const Vec3 n = normal(t);
                const double above = glm::dot(n, a - x[0]), below = glm::dot(n, b - x[0]);
                const bool across = (above > touching && below < -touching) || (above < -touching && below > touching);
                if (!across) continue;
                const Vec3 at = a + above / (above - below) * (b - a);
                pierced = glm::distance(at, place_at(nearest_in_triangle(at, x[0], x[1], x[2]).weights, x)) <= touching;
            }
            return pierced;
        });
    return pierced;
}

std::optional<double> SurfaceTree::way_to(const Vec3& a, const Vec3& b) const {
    Box segment;
    segment.add(a);
    segment.add(b);
    std::optional<double> first;
    for (const Index t : triangles_near(segment)) {
        const auto x = corners(t);
        const Vec3 n = glm::cross(x[1] - x[0], x[2] - x[0]), way = b - a;
        const double across = glm::dot(n, way);
        if (across == 0) continue;
        const double at = glm::dot(n, x[0] - a) / across;
        if (!(at >= 0 && at <= (first ? *first : 1))) continue;
        const Vec3 place = a + at * way;
        const bool inside = glm::dot(n, glm::cross(x[1] - x[0], place - x[0])) >= 0 &&
                            glm::dot(n, glm::cross(x[2] - x[1], place - x[1])) >= 0 &&
                            glm::dot(n, glm::cross(x[0] - x[2], place - x[2])) >= 0;
        if (inside) first = at;
    }
    return first;
}

std::vector<Index> SurfaceTree::triangles_near(const Box& box) const {
    std::vector<Index> near;
    tree_->visit_leaves([&](const Box& part) { return meet(part, box); },
                        [&](std::size_t first, std::size_t last) {
                            for (std::size_t slot = first; slot < last; ++slot) near.push_back(tree_->item(slot));
                            return false;
                        });
    return near;
}

double SurfaceTree::winding(const Vec3& x) const {
    constexpr double kFar = 2.5;  // radii
    double sum = 0;
    std::array<std::size_t, 64> open;
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
        const std::size_t node = open[--count];
        const Cluster& cluster = clusters_[node];
        const Vec3 to = cluster.center - x;
        const double distance = glm::length(to);
        if (distance > kFar * cluster.radius) {
            sum += glm::dot(cluster.area, to) / (distance * distance * distance);
        } else if (!tree_->is_leaf(node)) {
            open[count++] = 2 * node + 2;
            open[count++] = 2 * node + 1;
        } else {
            const auto [first, last] = tree_->slots(node);
            for (std::size_t slot = first; slot < last; ++slot) {
                const auto c = corners(tree_->item(slot));
                sum += solid_angle(c[0] - x, c[1] - x, c[2] - x);
            }
        }
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace subvol::detail
