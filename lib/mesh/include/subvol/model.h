// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

struct ModelInfo {
    std::string name;
    std::string description;
    int default_resolution;
};

/// The generated models: `pawn`, `ball`, `twist` and look-alikes of the other models of [mnmq2007]: `alien`, `train1`, `car`,
/// `fan`, `nozzle`, `train2`.
[[nodiscard]] std::vector<ModelInfo> list_models();

/// Generates a model with its density (the attribute "density").
///
/// resolution: cells along the model's main direction, 2..512; 0 takes the default. For the ball that is an edge of the inner
///             cube, for the twist each side, for the others their height or length
/// throws:     Error(InvalidInput) for an unknown name (lists the known ones) or a resolution out of range
[[nodiscard]] HexMesh make_model(const std::string& name, int resolution = 0);

/// The exact field of a model, which its meshes sample: the value at a place; nothing outside.
using ModelField = std::optional<double> (*)(const Vec3& x);

/// throws: Error(InvalidInput) for an unknown name
[[nodiscard]] ModelField model_field(const std::string& name);

/// The exact field of the `twist` model. The map of its block has an inverse in closed form, so the field is known everywhere.
struct TwistField {
    /// The parameter in [-1,1]³ that maps to x, unclipped.
    [[nodiscard]] static Vec3 parameter(const Vec3& x);
    /// Where a parameter lies in the world.
    [[nodiscard]] static Vec3 position(const Vec3& parameter);
    [[nodiscard]] static double density(const Vec3& parameter);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

/// The exact field of the `nozzle` model: the speed of a gas in a bent nozzle, from rest (-1) to the greatest (1).
struct NozzleField {
    /// (s, u, v): s in [-1,1] along the axis; (u,v) in the unit disk, the wall at its rim.
    [[nodiscard]] static Vec3 parameter(const Vec3& x);
    [[nodiscard]] static Vec3 position(const Vec3& parameter);
    [[nodiscard]] static double density(const Vec3& parameter);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

/// The exact field of the `ball` model: a smooth function of the position with values in [-1,1], inside the unit ball.
struct BallField {
    [[nodiscard]] static double density(const Vec3& x);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

}  // namespace subvol
