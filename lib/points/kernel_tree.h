// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// e(d) = |A d|² = dᵀ S⁻¹ d with A lower triangular (xx yx yy zx zy zz): never negative, whatever rounding does to S.
struct InverseRoot {
    std::array<double, 6> a{};

    [[nodiscard]] Vec3 times(const Vec3& d) const {
        return {a[0] * d.x, a[1] * d.x + a[2] * d.y, a[3] * d.x + a[4] * d.y + a[5] * d.z};
    }
    [[nodiscard]] Vec3 transposed_times(const Vec3& d) const {
        return {a[0] * d.x + a[1] * d.y + a[3] * d.z, a[2] * d.y + a[4] * d.z, a[5] * d.z};
    }
};

/// frame: xx xy xz yy yz zz of S; a singular one is thickened to 1e-6 of its longest extent
[[nodiscard]] InverseRoot inverse_root(const std::array<float, 6>& frame);

/// Finds the ellipsoids e < 1 that hold a point: a tree of boxes over them, halved at the median, all in flat arrays.
///
/// The tree is complete: node n has the children 2n+1 and 2n+2, leaves hold up to 16 ellipsoids. It depends on its input alone.
class KernelTree {
public:
    KernelTree(std::span<const Vec3> centers, std::span<const std::array<float, 6>> frames);

    [[nodiscard]] std::size_t size() const { return shapes_.size(); }

    /// The kernel at a place of the tree's order.
    [[nodiscard]] std::size_t kernel(std::size_t slot) const { return order_[slot]; }

    /// Calls visit(slot, d, A d, e) for every ellipsoid with e < 1 at x; d = x − center.
    template <class Visit>
    void visit_at(const Vec3& x, const Visit& visit) const {
        if (boxes_.empty()) return;
        std::array<std::size_t, 64> open;
        std::size_t count = 0;
        open[count++] = 0;
        while (count > 0) {
            const std::size_t node = open[--count];
            if (!boxes_[node].holds(x)) continue;
            if (node < first_leaf_) {
                open[count++] = 2 * node + 2;
                open[count++] = 2 * node + 1;
                continue;
            }
            const std::size_t leaf = node - first_leaf_, end = first_slot(leaf + 1);
            for (std::size_t slot = first_slot(leaf); slot < end; ++slot) {
                const Vec3 d = x - shapes_[slot].center;
                const Vec3 scaled = shapes_[slot].root.times(d);
                const double e = glm::dot(scaled, scaled);
                if (e < 1) visit(slot, d, scaled, e);
            }
        }
    }

    [[nodiscard]] const InverseRoot& root(std::size_t slot) const { return shapes_[slot].root; }

private:
    struct FloatBox {
        std::array<float, 3> lower{}, upper{};

        [[nodiscard]] bool holds(const Vec3& x) const {
            return x.x >= double(lower[0]) && x.x <= double(upper[0]) && x.y >= double(lower[1]) && x.y <= double(upper[1]) &&
                   x.z >= double(lower[2]) && x.z <= double(upper[2]);
        }
    };
    struct Shape {
        Vec3 center;
        InverseRoot root;
    };

    [[nodiscard]] std::size_t first_slot(std::size_t leaf) const { return leaf * order_.size() / (first_leaf_ + 1); }
    void sort_below(std::span<const Vec3> centers, std::size_t begin_leaf, std::size_t leaves);
    void fill_leaf(std::span<const Vec3> centers, std::span<const std::array<float, 6>> frames, std::size_t leaf);

    std::vector<Index> order_;
    std::vector<Shape> shapes_;
    std::vector<FloatBox> boxes_;
    std::size_t first_leaf_ = 0;  // of 2ᵏ leaves it is 2ᵏ − 1
};

}  // namespace subvol::detail
