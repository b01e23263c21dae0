// SPDX-License-Identifier: Apache-2.0
// What a surface of triangles encloses, however it was put together. In this order:
//
//     copies     triangles with the same corners, the same way round, and those without three different corners are left out
//     fins       flat patches at edges of an odd number of triangles are left out, again and again: all that end freely, else
//                the flattest one
//     turning    triangles of a patch are turned as most of it is
//     walls      triangles joined by edges; those with open edges are one wall together
//     unions     walls of which an edge of one pierces a triangle of another, found by a sweep over their boxes
//     depth      in how many other unions a wall lies, by the winding numbers at 15 of its triangles; odd: a cavity
//
// Of several walls, a place has the likeness p of a union by the largest |winding number| of its walls, at most 1. Inside is
// what lies in an odd number of unions: likenesses p and q become p + q − 2 p q. Points count as one within 1e-7 of the box's
// diagonal.
#include "surface_bodies.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "subvol/detail/counted_rows.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/parallel_each.h"
#include "surface_sides.h"

namespace subvol::detail {

namespace {

constexpr double kFlat = 0.7;  // |sum of area vectors| of the area: half a ball has 0.5, a flat sheet 1
constexpr float kInside = 0.5F;

/// Triangles that are joined by edges of two.
///
/// open, odd: it has edges of one triangle, and of three, five, …; area: the sum of its area vectors; size: its area
struct Patch {
    bool open = false, odd = false;
    Vec3 area{0.0};
    double size = 0;

    [[nodiscard]] double flatness() const { return size > 0 ? glm::length(area) / size : 1; }
};

Vec3 area_of(const Surface& surface, Index triangle) {
    const auto& [a, b, c] = surface.triangles[triangle];
    return 0.5 * glm::cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a]);
}

Vec3 middle_of(const Surface& surface, std::size_t triangle) {
    const auto& [a, b, c] = surface.triangles[triangle];
    return (surface.points[a] + surface.points[b] + surface.points[c]) / 3.0;
}

/// Whether an edge of some triangles of a surface passes through a triangle of another one.
bool pierces(const Surface& surface, const std::vector<Index>& triangles, const SurfaceTree& tree, double touching) {
    std::atomic<bool> found = false;
    parallel_each(triangles.size(), [&](std::size_t t) {
        const auto& corners = surface.triangles[triangles[t]];
        for (std::size_t k = 0; k < 3 && !found; ++k) {
            const Index a = corners[k], b = corners[(k + 1) % 3];
            if (tree.pierced_by(surface.points[a], surface.points[b], touching)) found = true;
        }
    });
    return found;
}

template <class Keep>
void keep_triangles(Surface& surface, const Keep& keep) {
    std::vector<std::array<Index, 3>> kept;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (keep(t)) kept.push_back(surface.triangles[t]);
    }
    surface.triangles = std::move(kept);
}

}  // namespace

double same_place(const Surface& surface) {
    constexpr double kSame = 1e-7;  // of the box
    return kSame * bounds(surface).diagonal();
}

OpenEdges open_edges(const Surface& surface) {
    OpenEdges open;
    each_edge(sides_of(surface, same_place(surface)), [&](std::span<const TriangleSide> sides) {
        if (sides.size() != 1) return;
        ++open.count;
        open.length_world += glm::distance(surface.points[sides[0].ends[0]], surface.points[sides[0].ends[1]]);
    });
    return open;
}

SurfaceBodies::SurfaceBodies(const Surface& surface) : surface_(surface), same_(same_place(surface)) {
    leave_out_copies();
    constexpr int kTimes = 64;
    for (int k = 0; k < kTimes && leave_out_fins(); ++k) {
    }
    turn();
    make_walls();
    unite();
    nest();
}

void SurfaceBodies::leave_out_copies() {
    const std::vector<Index> first = welded_points(surface_, same_);
    using Key = std::pair<std::array<Index, 3>, std::size_t>;
    std::vector<Key> keys;
    std::vector<std::uint8_t> keep(surface_.triangles.size(), 0);
    for (std::size_t t = 0; t < keep.size(); ++t) {
        std::array<Index, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = first[surface_.triangles[t][k]];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
        keys.emplace_back(corners, t);
    }
    std::ranges::sort(keys);
    for (std::size_t k = 0; k < keys.size(); ++k) {
        if (k == 0 || keys[k].first != keys[k - 1].first) keep[keys[k].second] = 1;
    }
    const auto kept = static_cast<std::size_t>(std::ranges::count(keep, 1));
    report_.copies = keys.size() - kept;
    if (kept < keep.size()) keep_triangles(surface_, [&](std::size_t t) { return keep[t] != 0; });
}

// returns: whether there were any, behind which there may be more
bool SurfaceBodies::leave_out_fins() {
    const std::vector<TriangleSide> sides = sides_of(surface_, same_);
    DisjointSets sets(surface_.triangles.size());
    bool any_odd = false;
    each_edge(sides, [&](std::span<const TriangleSide> edge) {
        if (edge.size() == 2) sets.join(edge[0].triangle, edge[1].triangle);
        any_odd |= edge.size() > 2 && edge.size() % 2 == 1;
    });
    if (!any_odd) return false;
    std::vector<Patch> patches(surface_.triangles.size());
    for (Index t = 0; t < surface_.triangles.size(); ++t) {
        Patch& patch = patches[sets.least(t)];
        const Vec3 area = area_of(surface_, t);
        patch.area += area;
        patch.size += glm::length(area);
    }
    each_edge(sides, [&](std::span<const TriangleSide> edge) {
        for (const TriangleSide& side : edge) {
            Patch& patch = patches[sets.least(side.triangle)];
            patch.open |= edge.size() == 1;
            patch.odd |= edge.size() > 2 && edge.size() % 2 == 1;
        }
    });
    // All that end freely; of walls between parts the flattest alone, as without it the others may be what encloses them.
    std::vector<std::uint8_t> fin(patches.size(), 0);
    Index flattest = kNone;
    for (Index p = 0; p < patches.size(); ++p) {
        if (!patches[p].odd || patches[p].flatness() < kFlat) continue;
        fin[p] = patches[p].open ? 1 : 0;
        if (flattest == kNone || patches[p].flatness() > patches[flattest].flatness()) flattest = p;
    }
    if (flattest == kNone) return false;
    if (std::ranges::count(fin, 1) == 0) fin[flattest] = 1;
    const std::size_t before = surface_.triangles.size();
    std::vector<std::array<Index, 3>> all = surface_.triangles;
    keep_triangles(surface_, [&](std::size_t t) { return fin[sets.least(static_cast<Index>(t))] == 0; });
    if (surface_.triangles.empty()) {
        surface_.triangles = std::move(all);
        return false;
    }
    report_.sheets += before - surface_.triangles.size();
    return true;
}

// Triangles are turned where most of their patch have the other orientation.
void SurfaceBodies::turn() {
    struct Neighbor {
        Index next;
        bool alike;
    };
    std::vector<std::array<TriangleSide, 2>> pairs;
    each_edge(sides_of(surface_, same_), [&](std::span<const TriangleSide> edge) {
        report_.many_edges += edge.size() > 2 ? 1 : 0;
        if (edge.size() == 2) pairs.push_back({edge[0], edge[1]});
    });
    const auto neighbors = counted_rows<Neighbor>(surface_.triangles.size(), [&](const auto& put) {
        for (const auto& [a, b] : pairs) {
            put(a.triangle, {b.triangle, a.forward != b.forward});
            put(b.triangle, {a.triangle, a.forward != b.forward});
        }
    });
    constexpr std::uint8_t kUnknown = 2;
    std::vector<std::uint8_t> turned(surface_.triangles.size(), kUnknown);
    std::vector<Index> patch;
    for (Index start = 0; start < turned.size(); ++start) {
        if (turned[start] != kUnknown) continue;
        turned[start] = 0;
        patch.assign(1, start);
        for (std::size_t k = 0; k < patch.size(); ++k) {
            for (const Neighbor& neighbor : neighbors[patch[k]]) {
                const auto wanted = static_cast<std::uint8_t>(turned[patch[k]] ^ (neighbor.alike ? 0 : 1));
                std::uint8_t& next = turned[neighbor.next];
                if (next == kUnknown) {
                    next = wanted;
                    patch.push_back(neighbor.next);
                } else if (next != wanted && patch[k] < neighbor.next) {
                    ++report_.one_sided;
                }
            }
        }
        const auto count = static_cast<std::size_t>(std::ranges::count_if(patch, [&](Index t) { return turned[t] != 0; }));
        const bool others = 2 * count > patch.size();
        report_.turned += others ? patch.size() - count : count;
        for (const Index t : patch) {
            if ((turned[t] != 0) == others) continue;
            std::swap(surface_.triangles[t][1], surface_.triangles[t][2]);
        }
    }
}

void SurfaceBodies::make_walls() {
    DisjointSets sets(surface_.triangles.size());
    std::vector<std::uint8_t> odd(surface_.triangles.size(), 0);
    each_edge(sides_of(surface_, same_), [&](std::span<const TriangleSide> edge) {
        for (const TriangleSide& side : edge) {
            sets.join(edge[0].triangle, side.triangle);
            if (edge.size() % 2 == 1) odd[side.triangle] = 1;
        }
    });
    std::vector<std::uint8_t> open(odd.size(), 0);
    for (Index t = 0; t < odd.size(); ++t) open[sets.least(t)] |= odd[t];
    std::vector<std::size_t> number(odd.size(), odd.size());
    Wall rest;
    rest.closed = false;
    for (Index t = 0; t < odd.size(); ++t) {
        const Index set = sets.least(t);
        if (open[set] == 0 && number[set] == odd.size()) {
            number[set] = walls_.size();
            walls_.emplace_back();
        }
        Wall& wall = open[set] == 0 ? walls_[number[set]] : rest;
        wall.surface.triangles.push_back(surface_.triangles[t]);
    }
    if (!rest.surface.triangles.empty()) walls_.push_back(std::move(rest));
    for (Wall& wall : walls_) {
        Surface& own = wall.surface;
        std::vector<Index> points;
        for (const auto& t : own.triangles) points.insert(points.end(), t.begin(), t.end());
        std::ranges::sort(points);
        points.erase(std::unique(points.begin(), points.end()), points.end());
        for (const Index p : points) own.points.push_back(surface_.points[p]);
        for (auto& t : own.triangles) {
            for (Index& p : t) p = static_cast<Index>(std::ranges::lower_bound(points, p) - points.begin());
        }
        for (Index t = 0; t < own.triangles.size(); ++t) {
            const Vec3 area = area_of(own, t);
            wall.area += area;
            wall.size += glm::length(area);
        }
        wall.volume = enclosed_volume(own);
    }
    if (walls_.size() > 1 && !walls_.back().closed && glm::length(walls_.back().area) > kFlat * walls_.back().size) {
        report_.sheets += walls_.back().surface.triangles.size();
        walls_.pop_back();
    }
    for (Wall& wall : walls_) {
        wall.tree.emplace(wall.surface);
        report_.walls += wall.closed ? 1 : 0;
    }
}

void SurfaceBodies::unite() {
    std::vector<std::size_t> order(walls_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto box = [&](std::size_t w) -> const Box& { return walls_[w].tree->box(); };
    std::ranges::sort(order, {}, [&](std::size_t w) { return std::pair(box(w).lower.x, w); });
    DisjointSets sets(walls_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size() && box(order[j]).lower.x <= box(order[i]).upper.x; ++j) {
            const auto a = static_cast<Index>(order[i]), b = static_cast<Index>(order[j]);
            if (!meet(box(a), box(b)) || sets.least(a) == sets.least(b)) continue;
            const auto passes = [&](const Wall& wall, const Wall& other) {
                return pierces(wall.surface, wall.tree->triangles_near(other.tree->box()), *other.tree, same_);
            };
            if (passes(walls_[a], walls_[b]) || passes(walls_[b], walls_[a])) sets.join(a, b);
        }
    }
    for (Index w = 0; w < walls_.size(); ++w) {
        walls_[w].joined = sets.least(w);
        if (walls_[w].joined == w) continue;
        ++report_.united;
    }
}

void SurfaceBodies::nest() {
    if (walls_.size() < 2) return;
    std::vector<Vec3> centers;
    for (const Wall& wall : walls_) centers.push_back(wall.tree->box().center());
    constexpr std::size_t kOfLeaf = 4;
    boxes_.emplace(centers, kOfLeaf, [&](Index w) { return walls_[w].tree->box(); });
    for (Wall& wall : walls_) {
        // Some of its triangles decide, as where walls touch one alone may err.
        constexpr std::size_t kVotes = 15;
        const std::size_t count = wall.surface.triangles.size(), votes = std::min(kVotes, count);
        std::vector<std::pair<std::size_t, const Wall*>> found;  // the unions about them, and one of their walls
        for (std::size_t k = 0; k < votes; ++k) {
            const Vec3 at = middle_of(wall.surface, k * count / votes);
            std::vector<std::pair<std::size_t, const Wall*>> here;
            each_wall_about(at, [&](const Wall& other) {
                if (other.joined == wall.joined) return;
                if (std::abs(other.tree->winding(at)) > kInside) here.emplace_back(other.joined, &other);
            });
            std::ranges::stable_sort(here, {}, [](const auto& a) { return a.first; });
            for (std::size_t n = 0; n < here.size(); ++n) {
                if (n == 0 || here[n].first != here[n - 1].first) found.push_back(here[n]);
            }
        }
        std::ranges::stable_sort(found, {}, [](const auto& a) { return a.first; });
        const Wall* around = nullptr;
        for (std::size_t n = 0, end = 0; n < found.size(); n = end) {
            while (end < found.size() && found[end].first == found[n].first) ++end;
            if (2 * (end - n) <= votes) continue;
            ++wall.depth;
            if (!around || std::abs(found[n].second->volume) < std::abs(around->volume)) around = found[n].second;
        }
        if (wall.depth % 2 == 0) continue;
        ++report_.cavities;
        report_.cavities_alike += wall.volume * around->volume > 0 ? 1 : 0;
    }
}

float SurfaceBodies::likeness(const Vec3& x) const {
    if (walls_.size() == 1) return static_cast<float>(std::abs(walls_.front().tree->winding(x)));
    std::vector<std::pair<std::size_t, float>> here;
    each_wall_about(x, [&](const Wall& wall) {
        here.emplace_back(wall.joined, static_cast<float>(std::min(1.0, std::abs(wall.tree->winding(x)))));
    });
    std::ranges::sort(here);
    float inside = 0;  // of an odd number of unions
    for (std::size_t n = 0; n < here.size(); ++n) {
        if (n + 1 < here.size() && here[n + 1].first == here[n].first) continue;  // the last of a union is the largest
        inside = inside + here[n].second - 2 * inside * here[n].second;
    }
    return inside;
}

double SurfaceBodies::least_volume() const {
    std::vector<const Wall*> largest(walls_.size(), nullptr);
    for (const Wall& wall : walls_) {
        const Wall*& most = largest[wall.joined];
        if (wall.closed && (most == nullptr || std::abs(wall.volume) > std::abs(most->volume))) most = &wall;
    }
    double volume = 0;
    for (const Wall* wall : largest) {
        if (wall != nullptr) volume += (wall->depth % 2 == 0 ? 1 : -1) * std::abs(wall->volume);
    }
    return volume;
}

std::optional<double> SurfaceBodies::volume() const {
    const bool closed = std::ranges::all_of(walls_, [](const Wall& wall) { return wall.closed; });
    if (!closed || report_.united > 0 || report_.one_sided > 0) return {};
    return least_volume();
}

bool SurfaceBodies::is_sheet() const {
    return is_open() && glm::length(walls_.front().area) > kFlat * walls_.front().size;
}

}  // namespace subvol::detail
