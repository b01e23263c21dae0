// SPDX-License-Identifier: Apache-2.0
#include "collapse_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace subvol::bench {

namespace {

constexpr double kLeastVolume = 1e-3;   // of a new tetrahedron, in parts of the cube over its longest edge
constexpr double kFlat = 0.97;          // cosine: a face of the boundary turns no further
constexpr double kLengthWeight = 1e-3;  // short edges first where the field is about the same
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};  // outward

std::array<Index, 3> sorted(std::array<Index, 3> face) {
    std::sort(face.begin(), face.end());
    return face;
}

}  // namespace

CollapseHierarchy::CollapseHierarchy(const MixedMesh& mesh)
    : points_(mesh.points),
      values_(mesh.attributes.front().values),
      tets_at_(mesh.points.size()),
      dropped_in_(mesh.tets.size()),
      on_boundary_(mesh.points.size(), 0),
      version_(mesh.points.size(), 0) {
    const auto [low, high] = std::ranges::minmax(values_);
    range_ = std::max(high - low, 1e-300);
    Box box;
    for (const Vec3& p : points_) box.add(p);
    size_ = box.diagonal();
    for (const auto& corners : mesh.tets) {
        for (const Index p : corners) tets_at_[p].push_back(static_cast<std::uint32_t>(tets_.size()));
        tets_.push_back({corners});
    }
    first_made_ = tets_.size();
    find_boundary();
    for (Index p = 0; p < points_.size(); ++p) offer(p);
    while (!queue_.empty()) {
        const Candidate next = queue_.top();
        queue_.pop();
        if (next.version == version_[next.from]) collapse(next);
    }
}

void CollapseHierarchy::find_boundary() {
    std::map<std::array<Index, 3>, int> faces;
    for (const Tet& tet : tets_) {
        for (const auto& f : kFaces) ++faces[sorted({tet.corners[f[0]], tet.corners[f[1]], tet.corners[f[2]]})];
    }
    for (const auto& [face, count] : faces) {
        if (count == 1) {
            for (const Index p : face) on_boundary_[p] = 1;
        }
    }
}

double CollapseHierarchy::six_volumes(const std::array<Index, 4>& c) const {
    const Vec3& o = points_[c[0]];
    return glm::dot(glm::cross(points_[c[1]] - o, points_[c[2]] - o), points_[c[3]] - o);
}

bool CollapseHierarchy::has(std::uint32_t tet, Index point) const {
    return std::ranges::find(tets_[tet].corners, point) != tets_[tet].corners.end();
}

std::vector<Index> CollapseHierarchy::neighbors(Index point) const {
    std::vector<Index> found;
    for (const std::uint32_t t : tets_at_[point]) {
        for (const Index p : tets_[t].corners) {
            if (p != point) found.push_back(p);
        }
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

/// The tetrahedra about `from` when it has been pulled to `to`.
std::vector<std::array<Index, 4>> CollapseHierarchy::after(Index from, Index to) const {
    std::vector<std::array<Index, 4>> made;
    for (const std::uint32_t t : tets_at_[from]) {
        if (has(t, to)) continue;
        made.push_back(tets_[t].corners);
        std::ranges::replace(made.back(), from, to);
    }
    return made;
}

/// Boundary faces about `from` hardly turn, so that edges and corners of the body stay.
bool CollapseHierarchy::keeps_boundary(Index from, Index to) const {
    std::map<std::array<Index, 3>, std::pair<int, std::array<Index, 3>>> faces;
    for (const std::uint32_t t : tets_at_[from]) {
        for (const auto& f : kFaces) {
            const std::array<Index, 3> face{tets_[t].corners[f[0]], tets_[t].corners[f[1]], tets_[t].corners[f[2]]};
            if (std::ranges::find(face, from) == face.end()) continue;
            auto& [count, turned] = faces[sorted(face)];
            ++count;
            turned = face;
        }
    }
    int with_both = 0;
    for (const auto& [key, entry] : faces) {
        if (entry.first != 1) continue;
        const auto normal = [&](std::array<Index, 3> face) {
            return glm::cross(points_[face[1]] - points_[face[0]], points_[face[2]] - points_[face[0]]);
        };
        std::array<Index, 3> moved = entry.second;
        if (std::ranges::find(moved, to) != moved.end()) {
            ++with_both;
            continue;
        }
        std::ranges::replace(moved, from, to);
        const Vec3 was = normal(entry.second), is = normal(moved);
        if (!(glm::dot(was, is) > kFlat * glm::length(was) * glm::length(is))) return false;
    }
    return with_both == 2;  // an edge of the boundary
}

bool CollapseHierarchy::allowed(Index from, Index to, const std::vector<std::array<Index, 4>>& made) const {
    if (made.empty()) return false;
    for (const auto& corners : made) {
        double longest = 0;
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = a + 1; b < 4; ++b) {
                longest = std::max(longest, glm::distance(points_[corners[a]], points_[corners[b]]));
            }
        }
        if (!(six_volumes(corners) > kLeastVolume * longest * longest * longest)) return false;
    }
    // The volume stays what it was: no fold, and no hole or bridge through the body.
    double was = 0, is = 0;
    for (const std::uint32_t t : tets_at_[from]) was += six_volumes(tets_[t].corners);
    for (const auto& corners : made) is += six_volumes(corners);
    if (on_boundary_[from] != 0) return on_boundary_[to] != 0 && keeps_boundary(from, to);
    return std::abs(was - is) < 1e-9 * was;
}

/// The value at a place in the cell that it lies deepest in.
double CollapseHierarchy::value_in(const std::vector<std::array<Index, 4>>& cells, const Vec3& place, std::size_t& cell) const {
    double deepest = -1e300, value = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const auto& c = cells[k];
        const double all = six_volumes(c);
        std::array<double, 4> weights{};
        for (std::size_t a = 0; a < 4; ++a) {
            const std::array<std::size_t, 3>& f = kFaces[a];
            const Vec3& o = points_[c[f[0]]];
            weights[a] =
                -glm::dot(glm::cross(points_[c[f[1]]] - o, points_[c[f[2]]] - o), place - o) / all;  // the faces turn outward
        }
        const double depth = std::ranges::min(weights);
        if (depth <= deepest) continue;
        deepest = depth;
        cell = k;
        value = 0;
        for (std::size_t a = 0; a < 4; ++a) value += weights[a] * values_[c[a]];
    }
    return value;
}

/// Puts the best collapse of a point into the queue.
void CollapseHierarchy::offer(Index point) {
    Candidate best{.cost = 1e300, .from = point, .version = ++version_[point]};
    std::vector<std::pair<double, Index>> order;
    for (const Index to : neighbors(point)) {
        order.emplace_back(glm::distance(points_[point], points_[to]) / size_ * kLengthWeight, to);
    }
    for (const auto& [length, to] : order) {
        const auto made = after(point, to);
        if (!allowed(point, to, made)) continue;
        std::size_t cell = 0;
        const double cost = std::abs(values_[point] - value_in(made, points_[point], cell)) / range_ + length;
        if (cost < best.cost) {
            best.cost = cost;
            best.to = to;
        }
    }
    if (best.cost < 1e300) queue_.push(best);
}

void CollapseHierarchy::collapse(const Candidate& candidate) {
    const auto [cost, from, to, version] = candidate;
    const auto made = after(from, to);
    const auto around = neighbors(from);
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node{.point = from};
    std::vector<Index> dropped{from};
    for (const std::uint32_t t : std::vector(tets_at_[from])) {
        tets_[t].undone_by = number;
        dropped.insert(dropped.end(), dropped_in_[t].begin(), dropped_in_[t].end());
        std::vector<Index>().swap(dropped_in_[t]);
        for (const Index p : tets_[t].corners) std::erase(tets_at_[p], t);
    }
    for (const auto& corners : made) {
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = a + 1; b < 4; ++b) {
                node.edge_world = std::max(node.edge_world, glm::distance(points_[corners[a]], points_[corners[b]]));
            }
        }
        for (const Index p : corners) tets_at_[p].push_back(static_cast<std::uint32_t>(tets_.size()));
        tets_.push_back({corners, number});
        dropped_in_.emplace_back();
    }
    const std::size_t first = tets_.size() - made.size();
    for (const Index p : dropped) {
        std::size_t cell = 0;
        node.error = std::max(node.error, std::abs(values_[p] - value_in(made, points_[p], cell)) / range_);
        dropped_in_[first + cell].push_back(p);
    }
    node.end_tet = tets_.size();
    nodes_.push_back(node);
    ++version_[from];
    for (const Index p : around) offer(p);
}

MixedMesh CollapseHierarchy::cut(const View& view, double pixels, double error) const {
    std::vector<std::uint8_t> split(nodes_.size(), 0);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        const Node& node = nodes_[n];
        const double depth = view.perspective() ? view.to_eye(points_[node.point]).z : 1;
        if (node.error > error && node.edge_world > pixels * view.pixel() * depth) split[n] = 1;
        if (split[n] == 0) continue;
        for (std::size_t t = n == 0 ? first_made_ : nodes_[n - 1].end_tet; t < node.end_tet; ++t) {
            if (tets_[t].undone_by != kNever) split[tets_[t].undone_by] = 1;  // a later one, to which the loop comes
        }
    }
    MixedMesh mesh;
    std::vector<Index> numbers(points_.size(), kNone);
    mesh.attributes = {{"f", 1, {}}};
    for (const Tet& tet : tets_) {
        if (tet.made_by != kNever && split[tet.made_by] != 0) continue;
        if (tet.undone_by != kNever && split[tet.undone_by] == 0) continue;
        std::array<Index, 4> corners{};
        for (std::size_t a = 0; a < 4; ++a) {
            Index& number = numbers[tet.corners[a]];
            if (number == kNone) {
                number = static_cast<Index>(mesh.points.size());
                mesh.points.push_back(points_[tet.corners[a]]);
                mesh.attributes[0].values.push_back(values_[tet.corners[a]]);
            }
            corners[a] = number;
        }
        mesh.tets.push_back(corners);
    }
    return mesh;
}

}  // namespace subvol::bench
