// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

constexpr int kBlades = 5;

/// A blade along z, from the hub to the ring: wider, flatter and swept forward towards its tip.
double blade(const Vec3& q) {
    const double pitch = 1.15 - 0.03 * q.z, half_chord = 3.4 + 0.2 * q.z, sweep = 0.012 * q.z * q.z;
    const double c = std::cos(pitch), s = std::sin(pitch), t = q.x - sweep;
    return box({c * t + s * q.y, c * q.y - s * t, q.z - 14}, {half_chord, 1.7, 11}, 1.2);
}

double blades(const Vec3& q) {
    std::array<double, kBlades> each;
    for (int k = 0; k < kBlades; ++k) {
        const double turn = 2 * std::numbers::pi * k / kBlades, c = std::cos(turn), s = std::sin(turn);
        each[static_cast<std::size_t>(k)] = blade({c * q.x - s * q.z, q.y, s * q.x + c * q.z});
    }
    return kCellBlend.join({each[0], each[1], each[2], each[3], each[4]});
}

/// Five blades about a bored hub, in a ring, 53 wide about the y axis.
double fan(const Vec3& q) {
    const double ring_wall = kCellBlend.cut(cylinder(q, 1, 26.4, 6), cylinder(q, 1, 22.8, 20));
    const double hub = kCellBlend.join({cylinder(q, 1, 6.5, 6.5), ellipsoid(q - Vec3(0, -5.5, 0), {6, 3.4, 6})});
    const double inner = kCellBlend.meet({blades(q), cylinder(q, 1, 24.5, 20)}), bore = cylinder(q, 1, 2.4, 20);
    return kCellBlend.cut(kCellBlend.join({ring_wall, hub, inner}), bore);
}

constexpr std::array<Deformation, 2> kFanDeformation{Twist{.axis = 2, .rate = 0.011},
                                                     Bend{.along = 2, .towards = 1, .radius = -55}};

}  // namespace

constinit const Solid kFan{
    .distance = fan, .transition = kCellTransition, .half = {28, 10, 28}, .main = 2, .deformation = kFanDeformation};

}  // namespace subvol::detail::model
