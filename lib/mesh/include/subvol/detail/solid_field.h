// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/vec.h"

namespace subvol::detail {

namespace model {

struct Solid;
extern const Solid kPawn, kAlien, kTrain1, kCar, kFan, kTrain2;

[[nodiscard]] Vec3 parameter(const Solid& solid, const Vec3& x);
[[nodiscard]] Vec3 position(const Solid& solid, const Vec3& parameter);
[[nodiscard]] double density(const Solid& solid, const Vec3& parameter);
[[nodiscard]] std::optional<double> value(const Solid& solid, const Vec3& x);

}  // namespace model

/// The exact field of a solid model, with the functions of TwistField: a deformed block. The density is signed, in [-1,1],
/// positive inside the solid; it reaches these ends within about four cells of the default resolution from the surface.
template <const model::Solid& kSolid>
struct SolidField {
    [[nodiscard]] static Vec3 parameter(const Vec3& x) { return model::parameter(kSolid, x); }
    [[nodiscard]] static Vec3 position(const Vec3& parameter) { return model::position(kSolid, parameter); }
    [[nodiscard]] static double density(const Vec3& parameter) { return model::density(kSolid, parameter); }
    [[nodiscard]] std::optional<double> value(const Vec3& x) const { return model::value(kSolid, x); }
};

using PawnField = SolidField<model::kPawn>;
using AlienField = SolidField<model::kAlien>;
using Train1Field = SolidField<model::kTrain1>;
using CarField = SolidField<model::kCar>;
using FanField = SolidField<model::kFan>;
using Train2Field = SolidField<model::kTrain2>;

}  // namespace subvol::detail
