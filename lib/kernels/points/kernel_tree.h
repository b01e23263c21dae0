// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/detail/median_tree.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Checks what a KernelTree relies on.
///
/// throws: Error(InvalidInput) as `validate`, if the kernel is not radial, or there are 2³² points or more
void check_rbf_volume(const RbfVolume& volume);

/// A with e(d) = |A d|² = dᵀ S⁻¹ d, lower triangular (xx yx yy zx zy zz). So e is never negative, even if rounding makes S
/// indefinite.
struct InverseRoot {
    std::array<double, 6> a{};

    [[nodiscard]] Vec3 times(const Vec3& d) const {
        return {a[0] * d.x, a[1] * d.x + a[2] * d.y, a[3] * d.x + a[4] * d.y + a[5] * d.z};
    }
    [[nodiscard]] Vec3 transposed_times(const Vec3& d) const {
        return {a[0] * d.x + a[1] * d.y + a[3] * d.z, a[2] * d.y + a[4] * d.z, a[5] * d.z};
    }
};

/// frame: S; a singular one is thickened to 1e-6 of its longest extent
[[nodiscard]] InverseRoot inverse_root(const Symmetric3& frame);

/// Finds the ellipsoids e < 1 that hold a point.
class KernelTree {
public:
    KernelTree(std::span<const Vec3> centers, std::span<const Symmetric3> frames);

    [[nodiscard]] std::size_t size() const { return shapes_.size(); }

    /// The kernel in a slot of the tree.
    [[nodiscard]] std::size_t kernel(std::size_t slot) const { return tree_.item(slot); }

    /// Calls visit(slot, d, A d, e) for every ellipsoid with e < 1 at x; d = x − center.
    template <class Visit>
    void visit_at(const Vec3& x, const Visit& visit) const {
        const auto holds = [&](const FloatBox& box) { return box.holds(x); };
        tree_.visit_leaves(holds, [&](std::size_t first, std::size_t last) {
            for (std::size_t slot = first; slot < last; ++slot) {
                const Vec3 d = x - shapes_[slot].center;
                const Vec3 scaled = shapes_[slot].root.times(d);
                const double e = glm::dot(scaled, scaled);
                if (e < 1) visit(slot, d, scaled, e);
            }
            return false;
        });
    }

    [[nodiscard]] const InverseRoot& root(std::size_t slot) const { return shapes_[slot].root; }

private:
    struct FloatBox {
        std::array<float, 3> lower{}, upper{};

        void add(const FloatBox& other) {
            for (std::size_t k = 0; k < 3; ++k) {
                lower[k] = std::min(lower[k], other.lower[k]);
                upper[k] = std::max(upper[k], other.upper[k]);
            }
        }
        [[nodiscard]] bool holds(const Vec3& x) const {
            return x.x >= double(lower[0]) && x.x <= double(upper[0]) && x.y >= double(lower[1]) && x.y <= double(upper[1]) &&
                   x.z >= double(lower[2]) && x.z <= double(upper[2]);
        }
    };
    struct Shape {
        Vec3 center;
        InverseRoot root;
    };

    [[nodiscard]] static FloatBox box_of(const Vec3& center, const Symmetric3& frame);

    MedianTree<FloatBox> tree_;
    std::vector<Shape> shapes_;  // by slot
};

}  // namespace subvol::detail
