// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "subvol/error.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// A number in [0, 1). std::uniform_real_distribution differs between libraries; this does not.
inline double random_unit(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// The box that contains both; an empty box adds nothing.
[[nodiscard]] inline Box box_about(const Box& a, const Box& b) {
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

/// A box cut into equal cells, as close to cubes as whole numbers of cells allow.
struct SampleGrid {
    Vec3 lower{0.0};
    Vec3 cell{0.0};  // sides, world
    std::array<int, 3> count{};

    /// resolution: cells along the longest side
    ///
    /// throws: Error(InvalidInput) for an empty box or a resolution not in 2 … 2000
    SampleGrid(const Box& box, int resolution) : lower(box.lower) {
        const Vec3 size = box.size();
        const double longest = std::max({size.x, size.y, size.z});
        if (!(longest > 0) || !std::isfinite(longest)) throw Error(ErrorCode::InvalidInput, "the fields' box is empty");
        if (resolution < 2 || resolution > 2000) {
            throw Error(ErrorCode::InvalidInput, "a resolution of " + std::to_string(resolution) + " is out of range", {},
                        "2 to 2000");
        }
        for (int k = 0; k < 3; ++k) {
            const auto n = static_cast<int>(std::lround(size[k] / longest * resolution));
            count[static_cast<std::size_t>(k)] = std::max(n, 1);
            cell[k] = size[k] / std::max(n, 1);
        }
    }

    /// i, j, k count cells: whole numbers are their corners.
    [[nodiscard]] Vec3 place(double i, double j, double k) const { return lower + cell * Vec3(i, j, k); }
    [[nodiscard]] double spacing() const { return std::max({cell.x, cell.y, cell.z}); }
};

}  // namespace subvol::detail
