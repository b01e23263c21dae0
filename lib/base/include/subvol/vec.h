// SPDX-License-Identifier: Apache-2.0
#pragma once

// The small vectors of the public interface are GLM's: the one third-party type in the headers (docs/adr/0002).
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <limits>

namespace subvol {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Mat3 = glm::dmat3;  // column-major, as in GLM

/// An axis-aligned box in world units; empty (lower > upper) until a point is added.
struct Box {
    Vec3 lower{std::numeric_limits<double>::infinity()};
    Vec3 upper{-std::numeric_limits<double>::infinity()};

    void add(const Vec3& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    void add(const Box& b) {
        lower = glm::min(lower, b.lower);
        upper = glm::max(upper, b.upper);
    }
    [[nodiscard]] bool empty() const { return !(lower.x <= upper.x); }
    [[nodiscard]] Vec3 size() const { return empty() ? Vec3(0.0) : upper - lower; }
    [[nodiscard]] Vec3 center() const { return empty() ? Vec3(0.0) : 0.5 * (lower + upper); }
    [[nodiscard]] double diagonal() const { return glm::length(size()); }
};

}  // namespace subvol
