// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "subvol/kernel_hierarchy.h"

namespace subvol::detail {

/// Whether nodes may be drawn in place of their kernels: the same answer for trees in memory and in files.
class NodeTest {
public:
    /// view:     null: widths do not count; else referred to
    /// channels: how many there are, each with error bounds
    /// throws:   Error(InvalidInput) if an option is negative or not a number, or there is no such channel
    NodeTest(const View* view, const LevelOptions& options, std::size_t kernels, std::size_t channels);

    [[nodiscard]] std::size_t channel() const { return options_.channel; }

    /// error: of the channel
    [[nodiscard]] bool takes(const Vec3& center, float width, float error) const {
        if (!(double(error) <= options_.error)) return false;
        if (single_) return false;  // the node would be its only kernel
        return view_ == nullptr || width_px(center, double(width)) < options_.pixels;
    }

private:
    [[nodiscard]] double width_px(const Vec3& center, double width) const {
        if (!view_->perspective()) return width / view_->pixel();
        const Vec3 x = view_->to_eye(center);
        const double nearest = x.z - 0.5 * width;
        if (!(nearest > 0)) return std::numeric_limits<double>::infinity();
        // Off the axis spheres are drawn as ellipses; no wider than in the corner of the picture, beyond which nothing is seen.
        return std::min(glm::length(x) / x.z, widest_) * width / (nearest * view_->pixel());
    }

    const View* view_;
    LevelOptions options_;
    bool single_;
    double widest_ = 1;
};

}  // namespace subvol::detail
