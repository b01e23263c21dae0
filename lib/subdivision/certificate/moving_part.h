// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "cell_parts.h"

namespace subvol::detail {

/// A part whose points move straight: at time s from −1 to 1 it is `middle` + s `motion`, as parts are linear in their points.
///
/// Its derivatives are those in the middle, and the rest is as large as the motion can be.
template <class Part>
class MovingPart {
public:
    /// motion: with the frame of the part
    MovingPart(Part middle, Part motion) : middle_(std::move(middle)), motion_(std::move(motion)) {}

    [[nodiscard]] const PartFrame& frame() const { return middle_.frame(); }
    [[nodiscard]] PartJacobians corners() const { return with_size(middle_.corners()); }
    [[nodiscard]] PartJacobians corners_of_children() const { return with_size(middle_.corners_of_children()); }
    [[nodiscard]] Vec3 size() const { return middle_.size() + motion_.size(); }
    [[nodiscard]] Mat3 center() const { return middle_.center(); }

    [[nodiscard]] PartDerivatives derivatives(const Mat3& h) const {
        PartDerivatives part = middle_.derivatives(h);
        part.rest += change(h);
        return part;
    }
    [[nodiscard]] std::vector<MovingPart> children() const {
        std::vector<Part> middles = middle_.children(), motions = motion_.children();
        std::vector<MovingPart> parts;
        parts.reserve(middles.size());
        for (std::size_t k = 0; k < middles.size(); ++k) parts.emplace_back(std::move(middles[k]), std::move(motions[k]));
        return parts;
    }

    /// How much of the norm of the test (fold_test.h), which is to be below 1, is motion.
    [[nodiscard]] double norm_of_motion() const {
        const Mat3 j = middle_.center();
        if (!(glm::determinant(j) > 0)) return std::numeric_limits<double>::infinity();
        const Mat3 all = change(glm::inverse(j));
        const Vec3 sums = all[0] + all[1] + all[2];
        return std::max({sums.x, sums.y, sums.z});
    }

private:
    [[nodiscard]] PartJacobians with_size(PartJacobians at) const {
        at.size = size();
        return at;
    }
    // How far the columns of H J are from those in the middle, at most.
    [[nodiscard]] Mat3 change(const Mat3& h) const {
        const PartDerivatives moved = motion_.derivatives(h);
        Mat3 all = moved.rest;
        for (int c = 0; c < 3; ++c) {
            Vec3 largest(0.0);
            for (const Vec3& value : moved.columns[static_cast<std::size_t>(c)].values)
                largest = glm::max(largest, glm::abs(value));
            all[c] += largest;
        }
        return all;
    }

    Part middle_, motion_;
};

}  // namespace subvol::detail
