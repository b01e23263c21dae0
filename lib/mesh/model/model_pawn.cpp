// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

// In world units, in which two cells of the default lattice are .0625 long.
constexpr double kTransition = 0.06;
constexpr Blend kPawnBlend{.rounding = 0.02};

double slab(double z, double center, double half_height) {
    return within((z - center) * (z - center), half_height);
}

double disk(double r2, double z, double radius, double center, double half_height) {
    return kPawnBlend.meet({within(r2, radius), slab(z, center, half_height)});
}

/// A chess pawn about the z axis, from -.9 to .87, radius .42.
double pawn(const Vec3& q) {
    const double r2 = q.x * q.x + q.y * q.y, z = q.z;  // polynomials of the squared radius are smooth on the axis too
    const double base = disk(r2, z, 0.42, -0.80, 0.11);
    const double step = disk(r2, z, 0.33, -0.62, 0.10);
    const double slope = (0.36 - z) / 0.9;
    const double body = kPawnBlend.meet({within(r2, 0.115 + 0.15 * slope * slope), slab(z, -0.10, 0.62)});
    const double collar = disk(r2, z, 0.26, 0.35, 0.065);
    const double head = within(r2 + (z - 0.62) * (z - 0.62), 0.25);
    return kPawnBlend.join({base, step, body, collar, head});
}

// 75° of twist and 50° of bend over a height of 2.
constexpr std::array<Deformation, 2> kPawnDeformation{Twist{.axis = 2, .rate = 0.6545, .offset = 0.6545},
                                                      Bend{.along = 2, .towards = 0, .radius = 1 / 0.4363}};

}  // namespace

constinit const Solid kPawn{
    .distance = pawn, .transition = kTransition, .half = {0.5, 0.5, 1}, .main = 2, .deformation = kPawnDeformation};

}  // namespace subvol::detail::model
