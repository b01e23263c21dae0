// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
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
    explicit BoxTree(std::vector<Box> boxes);

    [[nodiscard]] Box bounds() const { return nodes_.front(); }

    /// Calls visit(item) for every item whose box satisfies enter(box), until visit returns true. If enter is true for a box,
    /// it must be true for every box that contains it.
    template <class Enter, class Visit>
    void visit(const Enter& enter, const Visit& visit) const {
        std::array<std::size_t, 64> open;
        std::size_t count = 0;
        open[count++] = 0;
        while (count > 0) {
            const std::size_t node = open[--count];
            if (!enter(nodes_[node])) continue;
            if (node < first_leaf_) {
                open[count++] = 2 * node + 2;
                open[count++] = 2 * node + 1;
                continue;
            }
            const std::size_t leaf = node - first_leaf_, end = first_slot(leaf + 1);
            for (std::size_t slot = first_slot(leaf); slot < end; ++slot) {
                if (enter(boxes_[slot]) && visit(order_[slot])) return;
            }
        }
    }

    /// The least of squared_distance_to(item) over all items; infinite if there are none.
    template <class Distance>
    [[nodiscard]] double nearest(const Vec3& x, const Distance& squared_distance_to) const {
        double best = std::numeric_limits<double>::infinity();
        search(0, squared_distance(nodes_[0], x), x, squared_distance_to, best);
        return best;
    }

private:
    [[nodiscard]] std::size_t first_slot(std::size_t leaf) const { return leaf * order_.size() / (first_leaf_ + 1); }
    void sort_below(std::span<const Box> boxes, std::size_t begin_leaf, std::size_t leaves);

    template <class Distance>
    void search(std::size_t node, double bound, const Vec3& x, const Distance& squared_distance_to, double& best) const {
        if (bound >= best) return;
        if (node < first_leaf_) {
            // The nearer child first: often the other one need not be searched then.
            std::array<std::size_t, 2> child{2 * node + 1, 2 * node + 2};
            std::array<double, 2> distance{squared_distance(nodes_[child[0]], x), squared_distance(nodes_[child[1]], x)};
            const std::size_t nearer = distance[0] <= distance[1] ? 0 : 1;
            search(child[nearer], distance[nearer], x, squared_distance_to, best);
            search(child[1 - nearer], distance[1 - nearer], x, squared_distance_to, best);
            return;
        }
        const std::size_t leaf = node - first_leaf_;
        for (std::size_t slot = first_slot(leaf); slot < first_slot(leaf + 1); ++slot) {
            if (squared_distance(boxes_[slot], x) < best) best = std::min(best, squared_distance_to(order_[slot]));
        }
    }

    std::vector<Index> order_;
    std::vector<Box> boxes_;  // in that order
    std::vector<Box> nodes_;
    std::size_t first_leaf_ = 0;  // 2ᵏ − 1 for 2ᵏ leaves
};

}  // namespace subvol::detail
