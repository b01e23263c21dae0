// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "subvol/detail/median_tree.h"
#include "subvol/surface.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The square of the distance to a box; 0 inside.
[[nodiscard]] inline double squared_distance(const Box& box, const Vec3& x) {
    const Vec3 d = glm::max(glm::max(box.lower - x, x - box.upper), Vec3(0.0));
    return glm::dot(d, d);
}

/// A tree over boxes, split at the median. It is complete: node n has the children 2n+1 and 2n+2, and leaves have up to 8
/// boxes. It depends on its input only, not on the number of threads.
class BoxTree {
public:
    explicit BoxTree(const std::vector<Box>& boxes);

    [[nodiscard]] Box bounds() const { return tree_.box(0); }

    /// Calls visit(item) for every item whose box satisfies enter(box), until visit returns true. If enter is true for a box,
    /// it must be true for every box that contains it.
    template <class Enter, class Visit>
    void visit(const Enter& enter, const Visit& visit) const {
        tree_.visit_leaves(enter, [&](std::size_t first, std::size_t last) {
            for (std::size_t slot = first; slot < last; ++slot) {
                if (enter(boxes_[slot]) && visit(tree_.item(slot))) return true;
            }
            return false;
        });
    }

    /// The least of squared_distance_to(item) over all items; infinite if there are none.
    template <class Distance>
    [[nodiscard]] double nearest(const Vec3& x, const Distance& squared_distance_to) const {
        double best = std::numeric_limits<double>::infinity();
        search(0, squared_distance(tree_.box(0), x), x, squared_distance_to, best);
        return best;
    }

private:
    template <class Distance>
    void search(std::size_t node, double bound, const Vec3& x, const Distance& squared_distance_to, double& best) const {
        if (bound >= best) return;
        if (!tree_.is_leaf(node)) {
            // The nearer child first: then the other one is often too far away to be searched.
            const std::array<std::size_t, 2> child{2 * node + 1, 2 * node + 2};
            const std::array<double, 2> distance{squared_distance(tree_.box(child[0]), x),
                                                 squared_distance(tree_.box(child[1]), x)};
            const std::size_t nearer = distance[0] <= distance[1] ? 0 : 1;
            search(child[nearer], distance[nearer], x, squared_distance_to, best);
            search(child[1 - nearer], distance[1 - nearer], x, squared_distance_to, best);
            return;
        }
        const auto [first, last] = tree_.slots(node);
        for (std::size_t slot = first; slot < last; ++slot) {
            if (squared_distance(boxes_[slot], x) < best) best = std::min(best, squared_distance_to(tree_.item(slot)));
        }
    }

    MedianTree<Box> tree_;
    std::vector<Box> boxes_;  // by slot
};

/// The inside of a closed surface of outward triangles: points from which a ray leaves the surface more often than it enters
/// it. Shells may be nested or overlap.
class ClosedSurface {
public:
    explicit ClosedSurface(Surface surface);

    [[nodiscard]] bool holds(const Vec3& x) const;
    [[nodiscard]] bool empty() const { return surface_.triangles.empty(); }
    [[nodiscard]] Box bounds() const { return tree_.bounds(); }

private:
    /// +1 or −1 if the ray from x up the z axis leaves or enters through the triangle, else 0.
    [[nodiscard]] int crossing(Index triangle, const Vec3& x) const;

    Surface surface_;
    BoxTree tree_;
};

/// The box of each triangle.
[[nodiscard]] std::vector<Box> triangle_boxes(const Surface& surface);

}  // namespace subvol::detail
