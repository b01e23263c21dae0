// SPDX-License-Identifier: Apache-2.0
// The sharp edges of a surface as chains. Edges of two triangles that are bent, also as seen from a part of a cell away, are
// taken where the surface is to be reached on one of their sides, and joined to chains from corner to corner. Chains that are
// noise are left out, and all is traced again until there are none.
#include "sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/parallel_each.h"
#include "surface_sides.h"

namespace subvol::detail {

namespace {

/// An edge of two triangles, by its points, the smaller first.
struct BentEdge {
    std::array<Index, 2> ends;
    std::array<Index, 2> triangles;
};

/// The edges that exactly two triangles share. same_place: as of `sides_of`
std::vector<BentEdge> edges_of_two(const Surface& surface, double same_place) {
    std::vector<BentEdge> edges;
    each_edge(sides_of(surface, same_place), [&](std::span<const TriangleSide> sides) {
        if (sides.size() == 2) edges.push_back({sides[0].ends, {sides[0].triangle, sides[1].triangle}});
    });
    return edges;
}

/// Whether the surface is bent by more than an angle at an edge and beside it.
class Bend {
public:
    Bend(const Surface& surface, double angle_deg, double side)
        : surface_(surface), tree_(surface), least_(std::cos(angle_deg * std::numbers::pi / 180)), away_(kAway * side) {
        const double part = kPart * angle_deg * std::numbers::pi / 180;
        beside_ = std::cos(part);
    }

    [[nodiscard]] bool at(const BentEdge& edge) const {
        const Vec3 &a = surface_.points[edge.ends[0]], &b = surface_.points[edge.ends[1]];
        const double length = glm::distance(a, b);
        if (!(length > 0)) return false;
        const Vec3 along = (b - a) / length;
        std::array<Vec3, 2> inwards, normals;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto& t = surface_.triangles[edge.triangles[k]];
            const Vec3 middle = (surface_.points[t[0]] + surface_.points[t[1]] + surface_.points[t[2]]) / 3.0 - a;
            const Vec3 across = middle - glm::dot(middle, along) * along;
            if (!(glm::length(across) > 0)) return false;
            inwards[k] = glm::normalize(across);
            // As if the first triangle saw the edge from a to b and the second one from b to a.
            normals[k] = k == 0 ? glm::cross(along, inwards[k]) : glm::cross(inwards[k], along);
        }
        if (glm::dot(normals[0], normals[1]) > least_) return false;
        for (std::size_t k = 0; k < 2; ++k) {
            const Vec3 seen = tree_.normal(tree_.nearest(0.5 * (a + b) + away_ * inwards[k]).triangle);
            normals[k] = glm::dot(seen, normals[k]) < 0 ? -seen : seen;
        }
        return glm::dot(normals[0], normals[1]) < beside_;
    }

private:
    static constexpr double kAway = 0.25, kPart = 0.6;

    const Surface& surface_;
    SurfaceTree tree_;
    double least_, beside_ = 0, away_;
};

/// The chains of some edges.
class Chains {
public:
    Chains(const std::vector<Vec3>& points, std::vector<std::array<Index, 2>> edges)
        : points_(points), edges_(std::move(edges)) {
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            for (const Index p : edges_[e]) ends_.push_back({p, e});
        }
        std::ranges::sort(ends_);
    }

    /// chain: of each edge, one of the curves
    SharpEdges traced(std::vector<std::size_t>& chain) const {
        constexpr auto kOpen = static_cast<std::size_t>(-1);
        SharpEdges made;
        chain.assign(edges_.size(), kOpen);
        std::vector<std::pair<Index, Index>> corners;  // a point and its number
        for (std::size_t k = 0; k < ends_.size(); ++k) {
            const Index p = ends_[k].first;
            if ((k > 0 && ends_[k - 1].first == p) || !corner(p)) continue;
            corners.emplace_back(p, static_cast<Index>(made.corners.size()));
            made.corners.push_back(points_[p]);
        }
        const auto trace = [&](Index start, std::size_t edge, bool closed) {
            SharpCurve curve{{points_[start]}};
            Index at = start;
            for (;;) {
                chain[edge] = made.curves.size();
                at = edges_[edge][edges_[edge][0] == at ? 1 : 0];
                curve.points.push_back(points_[at]);
                if (at == start || corner(at)) break;
                for (const auto& [p, e] : at_point(at)) {
                    if (e != edge) {
                        edge = e;
                        break;
                    }
                }
            }
            if (!closed) {
                const auto number = [&](Index p) { return std::ranges::lower_bound(corners, std::pair(p, Index{0}))->second; };
                curve.corners = {number(start), number(at)};
            }
            made.curves.push_back(std::move(curve));
        };
        for (const auto& [p, e] : ends_) {
            if (corner(p) && chain[e] == kOpen) trace(p, e, false);
        }
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            if (chain[e] == kOpen) trace(edges_[e][0], e, true);
        }
        return made;
    }

private:
    [[nodiscard]] std::span<const std::pair<Index, std::size_t>> at_point(Index p) const {
        const auto point = [](const auto& end) { return end.first; };
        return {std::ranges::lower_bound(ends_, p, {}, point), std::ranges::upper_bound(ends_, p, {}, point)};
    }

    [[nodiscard]] bool corner(Index p) const {
        const auto ends = at_point(p);
        if (ends.size() != 2) return true;
        std::array<Vec3, 2> away;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto& [a, b] = edges_[ends[k].second];
            away[k] = glm::normalize(points_[a == p ? b : a] - points_[p]);
        }
        constexpr double kTurn = -0.64;  // the cosine of 130°: a turn by 50°
        return glm::dot(away[0], away[1]) > kTurn;
    }

    const std::vector<Vec3>& points_;
    std::vector<std::array<Index, 2>> edges_;
    std::vector<std::pair<Index, std::size_t>> ends_;  // the edges at each point
};

/// A flag for each curve: whether it ends freely after a few sides, or is one of a net that is short, or whose curves are.
std::vector<std::uint8_t> noise_among(const SharpEdges& found, double side) {
    constexpr double kSpur = 3, kRing = 6, kMean = 1.5;  // sides
    std::vector<std::size_t> ends(found.corners.size(), 0);
    for (const SharpCurve& curve : found.curves) {
        for (const Index c : curve.corners) {
            if (c != kNone) ++ends[c];
        }
    }
    // The length of all curves that are joined.
    DisjointSets nets(found.curves.size());
    std::vector<Index> first_at(found.corners.size(), kNone);
    for (Index k = 0; k < found.curves.size(); ++k) {
        for (const Index c : found.curves[k].corners) {
            if (c == kNone) continue;
            if (first_at[c] == kNone) first_at[c] = k;
            nets.join(first_at[c], k);
        }
    }
    std::vector<double> lengths(found.curves.size(), 0);
    std::vector<std::size_t> curves(found.curves.size(), 0);
    for (Index k = 0; k < found.curves.size(); ++k) {
        lengths[nets.least(k)] += found.curves[k].length();
        ++curves[nets.least(k)];
    }
    std::vector<std::uint8_t> noise(found.curves.size(), 0);
    for (Index k = 0; k < noise.size(); ++k) {
        const SharpCurve& curve = found.curves[k];
        const bool free = !curve.closed() && (ends[curve.corners[0]] == 1 || ends[curve.corners[1]] == 1);
        const Index net = nets.least(k);
        noise[k] = (free && curve.length() < kSpur * side) || lengths[net] < kRing * side ||
                           lengths[net] < kMean * side * static_cast<double>(curves[net])
                       ? 1
                       : 0;
    }
    return noise;
}

/// Adds an edge, or the parts of it that are reached and new.
void add_reached(const WallTarget& target, const BentEdge& edge, double side, const std::function<bool(const Vec3&)>& is_new,
                 std::vector<Vec3>& points, std::vector<std::array<Index, 2>>& edges) {
    const Surface& surface = *target.surface;
    const Vec3 a = surface.points[edge.ends[0]], b = surface.points[edge.ends[1]];
    constexpr double kPart = 0.25, kMost = 1e4;  // sides
    const double parts = target.reaches ? std::clamp(std::ceil(glm::distance(a, b) / (kPart * side)), 1.0, kMost) : 1;
    const auto at = [&](double part) { return a + part * (b - a); };
    const auto taken = [&](double from, double to) {
        const double middle = (from + to) / 2;
        if (is_new && !is_new(at(from)) && !is_new(at(middle)) && !is_new(at(to))) return false;
        return std::ranges::any_of(edge.triangles, [&](Index triangle) {
            const auto& t = surface.triangles[triangle];
            const Vec3& x = surface.points[t[0]];
            const Vec3 normal = glm::normalize(glm::cross(surface.points[t[1]] - x, surface.points[t[2]] - x));
            const Vec3 inwards = (x + surface.points[t[1]] + surface.points[t[2]]) / 3.0 - at(middle);
            constexpr double kBeside = 0.05;
            return target.reached(at(middle) + std::min(1.0, kBeside * side / glm::length(inwards)) * inwards, normal);
        });
    };
    Index last = edge.ends[0];
    bool joined = true;  // the end of the part before is a point
    for (double part = 1; part <= parts; ++part) {
        const bool take = taken((part - 1) / parts, part / parts);
        if (take && !joined) {
            last = static_cast<Index>(points.size());
            points.push_back(at((part - 1) / parts));
        }
        joined = take;
        if (!take) continue;
        Index next = edge.ends[1];
        if (part < parts) {
            next = static_cast<Index>(points.size());
            points.push_back(at(part / parts));
        }
        edges.push_back({std::min(last, next), std::max(last, next)});
        last = next;
    }
}

}  // namespace

double SharpCurve::length() const {
    double sum = 0;
    for (std::size_t k = 1; k < points.size(); ++k) sum += glm::distance(points[k - 1], points[k]);
    return sum;
}

Vec3 SharpCurve::at(double part) const {
    double left = part * length();
    for (std::size_t k = 1; k < points.size(); ++k) {
        const double step = glm::distance(points[k - 1], points[k]);
        if (left <= step && step > 0) return points[k - 1] + left / step * (points[k] - points[k - 1]);
        left -= step;
    }
    return points.back();
}

SharpEdges sharp_edges(const WallTarget& target, double angle_deg, double side,
                       const std::function<bool(const Vec3&)>& is_new) {
    constexpr double kSame = 1e-5;  // sides
    const Surface& surface = *target.surface;
    const std::vector<BentEdge> all = edges_of_two(surface, kSame * side);
    const Bend bend(surface, angle_deg, side);
    std::vector<std::uint8_t> bent(all.size());
    parallel_each(all.size(), [&](std::size_t e) { bent[e] = bend.at(all[e]) ? 1 : 0; });
    std::vector<Vec3> points = surface.points;
    std::vector<std::array<Index, 2>> edges;
    for (std::size_t e = 0; e < all.size(); ++e) {
        if (bent[e] != 0) add_reached(target, all[e], side, is_new, points, edges);
    }
    for (;;) {
        std::vector<std::size_t> chain;
        SharpEdges found = Chains(points, edges).traced(chain);
        const std::vector<std::uint8_t> noise = noise_among(found, side);
        if (std::ranges::count(noise, 1) == 0) return found;
        std::vector<std::array<Index, 2>> kept;
        for (std::size_t e = 0; e < edges.size(); ++e) {
            if (noise[chain[e]] == 0) kept.push_back(edges[e]);
        }
        edges = std::move(kept);
    }
}

CurveTree::CurveTree(const SharpCurve& curve) : closed_(curve.closed()) {
    segments_.points = curve.points;
    for (Index k = 1; k < curve.points.size(); ++k) segments_.triangles.push_back({k - 1, k, k});
    tree_.emplace(segments_);
}

CurvePlace CurveTree::nearest(const Vec3& x) const {
    const SurfacePlace place = tree_->nearest(x);
    const auto& segment = segments_.triangles[place.triangle];
    const bool end = !closed_ && (place.point == segments_.points.front() || place.point == segments_.points.back());
    return {place.point, glm::normalize(segments_.points[segment[1]] - segments_.points[segment[0]]), end};
}

}  // namespace subvol::detail
