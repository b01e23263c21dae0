// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/limit_shells.h"

namespace subvol::detail {

/// Adds points, each with the source of its value, and triangles to a surface.
class ShellTriangles {
public:
    explicit ShellTriangles(ShellSurface& to) : to_(to) {}

    /// The number of the next point.
    [[nodiscard]] std::size_t next_point() const { return to_.surface.points.size(); }
    void add(const Vec3& point, Index source) {
        to_.surface.points.push_back(point);
        to_.sources.push_back(source);
    }
    void triangle(std::size_t a, std::size_t b, std::size_t c) {
        to_.surface.triangles.push_back({static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c)});
    }

private:
    ShellSurface& to_;
};

}  // namespace subvol::detail
