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

/// The generated models: `pawn`, `ball`, `twist`.
[[nodiscard]] std::vector<ModelInfo> list_models();

/// Generates a model with its density (the attribute "density").
///
/// resolution: cells along the model's main direction, 2..512; 0 takes the default. pawn: its height; ball: an edge of the
///             inner cube; twist: each side
/// throws: Error(InvalidInput) for an unknown name (lists the known ones) or a resolution out of range
[[nodiscard]] HexMesh make_model(const std::string& name, int resolution = 0);

/// The exact field of the `twist` model: its closed-form inverse exists, so its exact image does too.
struct TwistField {
    /// The parameter in [-1,1]³ that maps to x, unclipped.
    [[nodiscard]] static Vec3 parameter(const Vec3& x);
    /// Where a parameter lies in the world.
    [[nodiscard]] static Vec3 position(const Vec3& parameter);
    [[nodiscard]] static double density(const Vec3& parameter);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

/// The exact field of the `pawn` model, in the same form: a bent and twisted block. The density is signed, in [-1,1], positive
/// inside the pawn, and saturates over about .06 world units at its surface.
struct PawnField {
    [[nodiscard]] static Vec3 parameter(const Vec3& x);
    [[nodiscard]] static Vec3 position(const Vec3& parameter);
    [[nodiscard]] static double density(const Vec3& parameter);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

/// The exact field of the `ball` model: a smooth function of the position in [-1,1], inside the unit ball.
struct BallField {
    [[nodiscard]] static double density(const Vec3& x);
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
};

}  // namespace subvol
