// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <variant>

#include "subvol/vec.h"

namespace subvol::model {

// Steps of a deformation, each in closed form both ways: `apply` and `undo`. Axes are counted from 0.

/// The section at a is turned about the axis by rate·a + offset.
struct Twist {
    int axis;
    double rate;  // radians a unit of length
    double offset = 0;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// The axis `along` becomes an arc; lengths on it are kept.
///
/// radius: the arc's centre is at -radius on the axis `towards`, so positive bends away from it; the part that is bent lies
///         within π·|radius| along the axis and on one side of the centre
struct Bend {
    int along;
    int towards;
    double radius;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// The section at a is scaled by 1 + amount·sin(rate·a + phase). |amount| < 1
struct Swell {
    int along;
    double amount;
    double rate;
    double phase = 0;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// The section at a is shifted by amount·sin(rate·a + phase) in the direction `towards`.
struct Sway {
    int along;
    int towards;
    double amount;
    double rate;
    double phase = 0;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

using Deformation = std::variant<Twist, Bend, Swell, Sway>;

/// The steps in their order.
[[nodiscard]] Vec3 apply(std::span<const Deformation> steps, Vec3 p);
/// The inverse of `apply`.
[[nodiscard]] Vec3 undo(std::span<const Deformation> steps, Vec3 x);

}  // namespace subvol::model
