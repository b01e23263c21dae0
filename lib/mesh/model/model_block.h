// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <variant>

#include "subvol/hex_mesh.h"

namespace subvol::detail::model {

// A model is a straight block of cells that is then deformed. The block's parameters are [-1,1]³.

/// Whether a parameter lies in [-1,1]³, without tolerance.
[[nodiscard]] bool in_block(const Vec3& parameter);

/// A regular block of cells on the parameters [-1,1]³, point ids x fastest.
[[nodiscard]] HexMesh parameter_block(const std::array<Index, 3>& cells);

// Steps of a deformation, each with `apply` and its inverse `undo` in closed form. Axes are counted from 0.

/// Turns the section at the coordinate a of an axis about this axis by rate·a + offset.
struct Twist {
    int axis;
    double rate;  // radians a unit of length
    double offset = 0;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// Bends the axis `along` into an arc; lengths on it are kept.
struct Bend {
    int along;
    int towards;
    /// The centre of the arc is at -radius on the axis `towards`: a positive radius bends away from that axis. What is bent
    /// must lie within π·|radius| along the axis and on one side of the centre
    double radius;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// Scales the section at a by 1 + amount·sin(rate·a + phase). |amount| < 1
struct Swell {
    int along;
    double amount;
    double rate;
    double phase = 0;

    [[nodiscard]] Vec3 apply(const Vec3& p) const;
    [[nodiscard]] Vec3 undo(const Vec3& x) const;
};

/// Shifts the section at a by amount·sin(rate·a + phase) in the direction `towards`.
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

/// Applies the steps in their order.
[[nodiscard]] Vec3 apply(std::span<const Deformation> steps, Vec3 p);
/// The inverse of `apply`.
[[nodiscard]] Vec3 undo(std::span<const Deformation> steps, Vec3 x);

/// The meshes of the models that are not a Solid. resolution: checked by make_model
[[nodiscard]] HexMesh make_twist(Index resolution);
[[nodiscard]] HexMesh make_ball(Index resolution);
[[nodiscard]] HexMesh make_nozzle(Index resolution);

}  // namespace subvol::detail::model
