// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

/// Large slanted eyes: balls in sockets.
double with_eyes(double head, const Vec3& m) {
    const Vec3 q = m - Vec3(5, -7, 10.5);
    const Vec3 slanted(0.9 * q.x + 0.44 * q.z, q.y, 0.9 * q.z - 0.44 * q.x);
    return kCellBlend.join({kCellBlend.cut(head, ellipsoid(slanted, {4.3, 4.6, 6.3})), ellipsoid(slanted, {2.6, 4, 4.4})});
}

double head(const Vec3& m) {
    const double skull = ellipsoid(m - Vec3(0, 0.5, 13.5), {12.5, 9.5, 9});
    const double chin = ball(m - Vec3(0, -1.5, 5), 5.2);
    const double cheeks = rod(m, {0, 0, 12}, {0, -1, 6}, 9.4, 5.6);
    const double mouth = ellipsoid(m - Vec3(0, -7, 3.4), {3, 2.4, 1.5});
    return kCellBlend.cut(with_eyes(kCellBlend.join({skull, chin, cheeks}), m), mouth);
}

double antenna(const Vec3& m) {
    return kCellBlend.join({rod(m, {4.5, 0, 20}, {8.5, -1, 27}, 1.9, 1.6), ball(m - Vec3(8.7, -1, 27.6), 2.8)});
}

double arm(const Vec3& m) {
    const Vec3 elbow(11, -1, -10), hand(14, -2, -2.5);
    return kCellBlend.join({rod(m, {4, 0, -5.5}, elbow, 2.1, 1.8), rod(m, elbow, hand, 1.8, 1.7), ball(m - hand, 2.4),
                            rod(m, hand, {11.8, -2.5, 1.8}, 1.5, 1.5), rod(m, hand, {14.6, -2.5, 2.6}, 1.5, 1.5)});
}

double leg(const Vec3& m) {
    return kCellBlend.join(
        {rod(m, {3.5, 0, -15}, {5.5, 0, -26.6}, 2.8, 2.1), ellipsoid(m - Vec3(6, -2.2, -27.6), {3.6, 5.6, 2.6})});
}

/// A visitor who looks to -y, 61 high; left and right are mirror images.
double alien(const Vec3& q) {
    const Vec3 m(std::abs(q.x), q.y, q.z);
    const double neck = rod(m, {0, 0, 2}, {0, 0, -5}, 2.4, 2.8);
    const double body =
        kCellBlend.join({ellipsoid(m - Vec3(0, 0, -8), {5.2, 4.2, 6}), ellipsoid(m - Vec3(0, -0.5, -14), {6.4, 5.4, 5.6})});
    return kCellBlend.join({head(m), antenna(m), neck, body, arm(m), leg(m)});
}

constexpr std::array<Deformation, 3> kAlienDeformation{Swell{.along = 2, .amount = 0.18, .rate = 0.04, .phase = 0.2},
                                                       Twist{.axis = 2, .rate = 0.016, .offset = -0.1},
                                                       Bend{.along = 2, .towards = 0, .radius = 60}};

}  // namespace

constinit const Solid kAlien{
    .distance = alien, .transition = kCellTransition, .half = {18, 12.5, 32}, .main = 2, .deformation = kAlienDeformation};

}  // namespace subvol::detail::model
