// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "subvol/detail/word_hash.h"
#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Finds the points of a list that are at the same place, or no farther apart than a tolerance.
class PointWelder {
public:
    PointWelder(std::span<const Vec3> points, double tolerance)
        : points_(points), tolerance_(tolerance), before_(points.size(), kNone) {}

    /// The first of the points kept so far that `p` coincides with; `p` itself, which is then kept, if there is none.
    Index join(Index p) {
        const Index found = first_near(p);
        if (found != kNone) return found;
        Index& last = last_in_.try_emplace(cube_of(points_[p]), kNone).first->second;
        before_[p] = std::exchange(last, p);
        return p;
    }

private:
    // The cube of a lattice that holds a point: four times as wide as the tolerance, so that most points have no other within
    // reach. Points that are kept are farther apart than the tolerance: few are in one. Without a tolerance, the coordinates
    // themselves.
    using Cube = std::array<double, 3>;
    static constexpr double kWidth = 4, kReach = 1 + 1e-9;  // in tolerances; a little more, for rounding

    struct CubeHash {
        std::size_t operator()(const Cube& cube) const { return static_cast<std::size_t>(hash_of_place(cube)); }
    };

    [[nodiscard]] Cube cube_of(const Vec3& x) const {
        const auto along = [&](double v) {
            return (tolerance_ > 0 ? std::floor(v / (kWidth * tolerance_)) : v) + 0.0;
        };  // -0 is 0
        return {along(x.x), along(x.y), along(x.z)};
    }

    [[nodiscard]] Index first_in(Index p, const Cube& cube) const {
        const auto last = last_in_.find(cube);
        Index first = kNone;
        for (Index q = last == last_in_.end() ? kNone : last->second; q != kNone; q = before_[q]) {
            if (glm::distance(points_[q], points_[p]) <= tolerance_) first = q;
        }
        return first;
    }

    /// In all cubes that the tolerance reaches.
    [[nodiscard]] Index first_near(Index p) const {
        const Vec3 reach(kReach * tolerance_);
        const Cube low = cube_of(points_[p] - reach), high = cube_of(points_[p] + reach);
        if (low == high) return first_in(p, low);
        Index first = kNone;
        for (std::size_t k = 0; k < 8; ++k) {  // at most two along each axis; far away, adding 1 does not lead to the next
            const std::array<std::size_t, 3> upper{k & 1, k >> 1 & 1, k >> 2};
            Cube cube = low;
            bool is_new = true;
            for (std::size_t a = 0; a < 3; ++a) {
                if (upper[a] == 0) continue;
                cube[a] = high[a];
                is_new = is_new && low[a] != high[a];
            }
            if (is_new) first = std::min(first, first_in(p, cube));
        }
        return first;
    }

    std::span<const Vec3> points_;
    double tolerance_;
    std::unordered_map<Cube, Index, CubeHash> last_in_;
    std::vector<Index> before_;  // for each point that is kept, the one before it in its cube
};

}  // namespace subvol::detail
