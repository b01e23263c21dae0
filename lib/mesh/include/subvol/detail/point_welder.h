// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

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
        const Cube home = cube_of(points_[p]);
        const Index found = tolerance_ > 0 ? first_around(p, home) : first_in(p, home);
        if (found != kNone) return found;
        Index& last = last_in_.try_emplace(home, kNone).first->second;
        before_[p] = std::exchange(last, p);
        return p;
    }

private:
    // The cube of a lattice that holds a point: as wide as the tolerance. Without a tolerance, the coordinates themselves.
    using Cube = std::array<double, 3>;

    struct CubeHash {
        std::size_t operator()(const Cube& cube) const {
            std::uint64_t hash = 0;
            for (const double x : cube) hash = (std::rotl(hash, 21) ^ std::bit_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15u;
            return static_cast<std::size_t>(hash ^ (hash >> 32));
        }
    };

    [[nodiscard]] Cube cube_of(const Vec3& x) const {
        const auto along = [&](double v) { return (tolerance_ > 0 ? std::floor(v / tolerance_) : v) + 0.0; };  // -0 is 0
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

    [[nodiscard]] Index first_around(Index p, const Cube& home) const {
        Index first = kNone;
        for (int n = 0; n < 27; ++n) {
            const int x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1;
            first = std::min(first, first_in(p, {home[0] + x, home[1] + y, home[2] + z}));
        }
        return first;
    }

    std::span<const Vec3> points_;
    double tolerance_;
    std::unordered_map<Cube, Index, CubeHash> last_in_;
    std::vector<Index> before_;  // for each point that is kept, the one before it in its cube
};

}  // namespace subvol::detail
