// SPDX-License-Identifier: Apache-2.0
// Paths of edges of a mesh's boundary along the sharp curves of a surface.
//
// Each corner of the curves takes the nearest free point with as many edges as curves end there. Curves then get paths one
// after the other, the shortest curves first: cheapest paths over points that no other path has, where an edge costs its length
// times 1 + 16 d², with d the distance of its middle from the curve in cells. Points farther than two cells from the curve are
// barred. A ring goes by three points, and once more by those midway between them, as the first three may lie beside the best
// path. A path much shorter than its curve has cut something off and is dropped.
//
// Then paths of one or two edges that end freely are dropped. Other free ends go on to another path by cuts: edges that are no
// creases. Where there is no way, the path is dropped. Curves without a path are missed. All is tried again with the missed
// curves first, up to 20 times, and the try that misses the least length is the result.
#include "sharp_paths.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <span>

namespace subvol::detail {

namespace {

std::array<Index, 2> in_order(const std::array<Index, 2>& edge) {
    return {std::min(edge[0], edge[1]), std::max(edge[0], edge[1])};
}

/// How far from a curve a path may lie, and from a corner its point, in sides: control meshes do not reach far into tips.
constexpr double kPathReach = 2, kCornerReach = 3;

/// The points and edges of a mesh's boundary, some of them taken.
class BoundaryGraph {
public:
    BoundaryGraph(const HexMesh& mesh, double side) : mesh_(mesh), side_(side) {
        const Topology topology = build_topology(mesh);
        for (Index e = 0; e < topology.edges.size(); ++e) {
            if (topology.edge_on_boundary[e] == 0) continue;
            const auto [a, b] = topology.edges[e];
            ends_.emplace_back(a, b);
            ends_.emplace_back(b, a);
        }
        std::ranges::sort(ends_);
        for (std::size_t k = 0; k < ends_.size(); ++k) {
            if (k == 0 || ends_[k].first != ends_[k - 1].first) points_.push_back(ends_[k].first);
        }
        taken_.assign(mesh.points.size(), 0);
    }

    /// The free point nearest to a place with at least so many edges; kNone if none is near.
    [[nodiscard]] Index nearest(const Vec3& place, std::size_t edges) const {
        Index best = kNone;
        double least = kCornerReach * side_;
        for (const Index p : points_) {
            const double distance = glm::distance(mesh_.points[p], place);
            if (taken_[p] != 0 || distance >= least || at(p).size() < edges) continue;
            least = distance;
            best = p;
        }
        return best;
    }

    void take(Index point) { taken_[point] = 1; }
    void free(Index point) { taken_[point] = 0; }
    /// No path goes along this edge any more.
    void close(const std::array<Index, 2>& edge) { closed_.insert(edge); }
    void open_all() { closed_.clear(); }
    [[nodiscard]] bool taken(Index point) const { return taken_[point] != 0; }

    /// The points of the path from one point to another that is nearest to a curve, both included; empty if there is none.
    [[nodiscard]] std::vector<Index> path(Index from, Index to, const CurveTree& curve) const {
        const auto far = [&](const Vec3& x) { return glm::distance(x, curve.nearest(x).point) / side_; };
        return path_where(
            from, [&](Index p) { return p == to; },
            [&](Index p, Index q) {
                if (q != to && far(mesh_.points[q]) > kPathReach) return std::numeric_limits<double>::infinity();
                const double off = far(0.5 * (mesh_.points[p] + mesh_.points[q]));
                constexpr double kOff = 16;
                return glm::distance(mesh_.points[q], mesh_.points[p]) * (1 + kOff * off * off);
            });
    }

    /// The shortest path from a point to one of those where `ends` is true.
    template <class Ends>
    [[nodiscard]] std::vector<Index> path_to(Index from, const Ends& ends) const {
        return path_where(from, ends, [&](Index p, Index q) { return glm::distance(mesh_.points[q], mesh_.points[p]); });
    }

private:
    /// The cheapest path over free points to one where `ends` is true; empty if there is none. cost: of an edge
    template <class Ends, class Cost>
    [[nodiscard]] std::vector<Index> path_where(Index from, const Ends& ends, const Cost& cost_of) const {
        struct Reached {
            double cost;
            Index before;
            bool done;
        };
        std::map<Index, Reached> reached;
        Index to = kNone;
        using Next = std::pair<double, Index>;
        std::priority_queue<Next, std::vector<Next>, std::greater<>> next;
        reached[from] = {0, kNone, false};
        next.emplace(0, from);
        while (!next.empty()) {
            const Index p = next.top().second;
            next.pop();
            Reached& point = reached[p];
            if (point.done) continue;
            point.done = true;
            if (p != from && ends(p)) {
                to = p;
                break;
            }
            for (const auto& [start, q] : at(p)) {
                if ((taken_[q] != 0 && !ends(q)) || closed_.contains(in_order({p, q}))) continue;
                const double cost = point.cost + cost_of(p, q);
                if (std::isinf(cost)) continue;
                const auto [found, is_new] = reached.try_emplace(q, Reached{cost, p, false});
                if (!is_new && (found->second.done || found->second.cost <= cost)) continue;
                found->second = {cost, p, false};
                next.emplace(cost, q);
            }
        }
        std::vector<Index> points;
        for (Index p = to; p != kNone; p = reached[p].before) points.push_back(p);
        std::ranges::reverse(points);
        return points;
    }

    [[nodiscard]] std::span<const std::pair<Index, Index>> at(Index p) const {
        const auto point = [](const auto& end) { return end.first; };
        return {std::ranges::lower_bound(ends_, p, {}, point), std::ranges::upper_bound(ends_, p, {}, point)};
    }

    const HexMesh& mesh_;
    double side_;
    std::vector<std::pair<Index, Index>> ends_;
    std::vector<Index> points_;
    std::vector<std::uint8_t> taken_;
    std::set<std::array<Index, 2>> closed_;
};

/// Paths along curves, of which each bars the way for those behind it.
class PathFinder {
public:
    PathFinder(const HexMesh& mesh, const SharpEdges& sharp, double side)
        : mesh_(mesh), sharp_(sharp), graph_(mesh, side), points_(sharp.corners.size(), kNone) {
        std::vector<std::size_t> ends(points_.size(), 0);
        for (const SharpCurve& curve : sharp.curves) {
            trees_.emplace_back(curve);
            if (curve.closed()) continue;
            for (const Index c : curve.corners) ++ends[c];
        }
        for (Index c = 0; c < points_.size(); ++c) {
            points_[c] = graph_.nearest(sharp.corners[c], ends[c]);
            if (points_[c] != kNone) graph_.take(points_[c]);
        }
    }

    /// curves: all, the first ones first
    [[nodiscard]] SharpPaths along(const std::vector<Index>& curves) {
        SharpPaths made;
        std::vector<Crease> creases;
        for (const Index k : curves) {
            const std::vector<Index> path = whole_path(k);
            if (path.empty()) made.missed.push_back(k);
            for (std::size_t i = 1; i < path.size(); ++i) {
                creases.push_back({in_order({path[i - 1], path[i]}), k});
                graph_.close(creases.back().first);
            }
        }
        drop_spurs(creases, made.missed);
        made.cuts = cuts_from_ends(creases, made.missed);
        std::vector<std::uint8_t> used(mesh_.points.size(), 0);
        std::ranges::sort(creases);
        for (const auto& [edge, curve] : creases) {
            made.creases.push_back(edge);
            made.curves.push_back(curve);
            for (const Index p : edge) {
                graph_.free(p);
                used[p] = 1;
            }
        }
        graph_.open_all();
        for (Index c = 0; c < points_.size(); ++c) {
            if (points_[c] == kNone) continue;
            graph_.take(points_[c]);
            if (used[points_[c]] != 0) made.corners.emplace_back(points_[c], c);
        }
        return made;
    }

private:
    using Crease = std::pair<std::array<Index, 2>, Index>;

    /// Leaves out paths of few edges that end freely.
    void drop_spurs(std::vector<Crease>& creases, std::vector<Index>& missed) {
        for (;;) {
            std::map<Index, std::size_t> ends, edges;  // at a point, of a curve
            for (const auto& [edge, curve] : creases) {
                for (const Index p : edge) ++ends[p];
                ++edges[curve];
            }
            const auto spur = [&](Index curve) {
                constexpr std::size_t kFew = 3;
                return !sharp_.curves[curve].closed() && edges[curve] < kFew &&
                       std::ranges::any_of(sharp_.curves[curve].corners, [&](Index c) { return ends[points_[c]] == 1; });
            };
            std::vector<Index> dropped;
            for (const auto& [curve, count] : edges) {
                if (spur(curve)) dropped.push_back(curve);
            }
            if (dropped.empty()) return;
            std::erase_if(creases, [&](const Crease& crease) {
                if (std::ranges::count(dropped, crease.second) == 0) return false;
                for (const Index p : crease.first) graph_.free(p);
                return true;
            });
            missed.insert(missed.end(), dropped.begin(), dropped.end());
        }
    }

    /// Edges by which paths that end freely go on to other paths, or to the other end of the same one. Those that cannot are
    /// left out.
    [[nodiscard]] std::vector<std::array<Index, 2>> cuts_from_ends(std::vector<Crease>& creases, std::vector<Index>& missed) {
        std::map<Index, std::set<Index>> curves_at;
        std::map<Index, std::size_t> edges_at;
        const auto count = [&](const std::array<Index, 2>& edge, Index curve) {
            for (const Index p : edge) {
                curves_at[p].insert(curve);
                ++edges_at[p];
            }
        };
        for (const auto& [edge, curve] : creases) count(edge, curve);
        std::vector<std::array<Index, 2>> cuts;
        std::set<Index> dropped;
        for (const Index c : std::vector<Index>(points_)) {
            if (c == kNone || edges_at[c] != 1) continue;
            const Index curve = *curves_at[c].begin();
            const std::vector<Index> path = graph_.path_to(c, [&](Index p) {
                const auto known = curves_at.find(p);
                return known != curves_at.end() && (edges_at[p] == 1 || !known->second.contains(curve));
            });
            if (path.empty()) dropped.insert(curve);
            for (std::size_t i = 1; i < path.size(); ++i) {
                cuts.push_back(in_order({path[i - 1], path[i]}));
                count(cuts.back(), kNone);
                graph_.take(path[i]);
                graph_.close(cuts.back());
                if (i + 1 < path.size()) on_cuts_.push_back(path[i]);
            }
        }
        for (const Index p : on_cuts_) graph_.free(p);
        on_cuts_.clear();
        std::erase_if(creases, [&](const Crease& crease) {
            if (!dropped.contains(crease.second)) return false;
            for (const Index p : crease.first) graph_.free(p);
            return true;
        });
        missed.insert(missed.end(), dropped.begin(), dropped.end());
        return cuts;
    }

    /// The path by some stops, all taken afterwards; empty, and nothing is taken, if there is none.
    std::vector<Index> path_by(const std::vector<Index>& stops, Index curve) {
        std::vector<Index> path{stops.front()};
        bool all = std::ranges::count(stops, kNone) == 0;
        std::vector<Index> taken;
        const auto take = [&](Index p) {
            if (graph_.taken(p)) return;
            graph_.take(p);
            taken.push_back(p);
        };
        if (all) std::ranges::for_each(stops, take);
        for (std::size_t s = 1; all && s < stops.size(); ++s) {
            const std::vector<Index> next = graph_.path(stops[s - 1], stops[s], trees_[curve]);
            all = next.size() > 1;
            std::ranges::for_each(next, take);
            if (all) path.insert(path.end(), next.begin() + 1, next.end());
        }
        if (all) return path;
        for (const Index p : taken) graph_.free(p);
        return {};
    }

    std::vector<Index> whole_path(Index k) {
        const SharpCurve& curve = sharp_.curves[k];
        constexpr std::size_t kEdges = 3;
        const auto stop_at = [&](double part) {
            const Index p = graph_.nearest(curve.at(part), kEdges);
            if (p != kNone) graph_.take(p);
            return p;
        };
        const auto free = [&](std::vector<Index> points) {
            for (const Index p : points) {
                if (p != kNone && std::ranges::count(points_, p) == 0) graph_.free(p);
            }
        };
        // A ring goes by three points, as else its way back would be the way there.
        const Index first = curve.closed() ? stop_at(0) : points_[curve.corners[0]];
        std::vector<Index> stops{first};
        if (curve.closed() || curve.corners[0] == curve.corners[1]) {
            constexpr double kThird = 1.0 / 3;
            stops.push_back(stop_at(kThird));
            stops.push_back(stop_at(2 * kThird));
        }
        stops.push_back(curve.closed() ? first : points_[curve.corners[1]]);
        std::vector<Index> path = path_by(stops, k);
        if (path.empty()) free(stops);
        if (!path.empty() && curve.closed()) {
            // The stops may lie beside the best path; those that are farthest from them do not.
            std::vector<Index> between;
            for (std::size_t s = 1; s < stops.size(); ++s) {
                const auto from = std::ranges::find(path, stops[s - 1]);
                const auto to = std::find(from + 1, path.end(), stops[s]);
                between.push_back(*(from + (to - from) / 2));
            }
            between.push_back(between.front());
            free(path);
            std::vector<Index> better = path_by(between, k);
            if (better.empty()) {
                std::ranges::for_each(path, [&](Index p) { graph_.take(p); });
            } else {
                path = std::move(better);
            }
        }
        double length = 0;
        for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(mesh_.points[path[i - 1]], mesh_.points[path[i]]);
        constexpr double kShort = 0.6;  // of a curve: the path has left something out
        if (length < kShort * curve.length()) {
            free(path);
            path.clear();
        }
        return path;
    }

    const HexMesh& mesh_;
    const SharpEdges& sharp_;
    BoundaryGraph graph_;
    std::vector<Index> points_;  // of the corners
    std::vector<Index> on_cuts_;
    std::deque<CurveTree> trees_;
};

}  // namespace

SharpPaths sharp_paths(const HexMesh& mesh, const SharpEdges& sharp, double side) {
    std::vector<double> lengths;
    for (const SharpCurve& curve : sharp.curves) lengths.push_back(curve.length());
    // Short curves have the fewest ways to go; then those for which no way was left go first.
    std::vector<Index> order(lengths.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::sort(order, {}, [&](Index k) { return std::pair(lengths[k], k); });
    PathFinder finder(mesh, sharp, side);
    SharpPaths best;
    double least = std::numeric_limits<double>::infinity();
    constexpr int kTries = 20;
    for (int k = 0; k < kTries && least > 0; ++k) {
        SharpPaths found = finder.along(order);
        double missed = 0;
        for (const Index c : found.missed) missed += lengths[c];
        std::stable_partition(order.begin(), order.end(), [&](Index c) { return std::ranges::count(found.missed, c) > 0; });
        if (missed >= least) continue;
        least = missed;
        best = std::move(found);
    }
    return best;
}

}  // namespace subvol::detail
