// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

/// Two axles of two wheels. m: relative to the middle of the bogie
double bogie(const Vec3& m) {
    const Vec3 q(std::abs(m.x), m.y, m.z);
    const double frame = box(q, {10, 9, 2.2}, 1);
    const double wheel = cylinder(q - Vec3(6.5, 11, -1.5), 1, 4.4, 2.2);
    return kCellBlend.join({frame, wheel, cylinder(q - Vec3(6.5, 0, -1.5), 1, 1.7, 11)});
}

/// A window in each side, cut from one to the other.
double window(const Vec3& m, double x, double half_width) {
    return box(m - Vec3(x, 0, 4.5), {half_width, 40, 3.6}, 1.5);
}

/// Shrinks to a low nose at x = 72.
double nose(const Vec3& m, double inset) {
    const Vec3 q = m - Vec3(30, 0, -9);
    return ellipsoid({std::max(q.x, 0.0), q.y, q.z}, Vec3(42, 20, 21.5) - inset);
}

double engine(const Vec3& m) {
    const double body = kCellBlend.meet({box(m - Vec3(40, 0, 1), {34, 14, 10.5}, 5), nose(m, 0)});
    const double glass = kCellBlend.cut(box(m - Vec3(53, 0, 5), {8, 8.5, 3.4}, 1), nose(m, 2.6));
    const double windows = kCellBlend.join({window(m, 16, 4.5), window(m, 29, 4.5)});
    const double door = box(m - Vec3(41, 14, 0.5), {3.2, 2, 6}, 1);
    const double lamp = ball(m - Vec3(66, 8.5, -4.5), 2.6);
    const double roof = box(m - Vec3(22, 0, 12), {10, 7, 2.4}, 1.5);
    const double hull = kCellBlend.meet({body, -glass, -windows, -door});
    return kCellBlend.join({hull, lamp, roof, bogie(m - Vec3(20, 0, -8.8)), bogie(m - Vec3(52, 0, -8.8))});
}

double wagon(const Vec3& m) {
    const double body = box(m - Vec3(-38.5, 0, 1), {33.5, 14, 10.5}, 5);
    const double windows =
        kCellBlend.join({window(m, -62, 4.5), window(m, -49, 4.5), window(m, -36, 4.5), window(m, -23, 4.5)});
    const double door = box(m - Vec3(-12.5, 14, 0.5), {3.2, 2, 6}, 1);
    const double roof = box(m - Vec3(-40, 0, 12), {18, 7, 2.4}, 1.5);
    const double hull = kCellBlend.meet({body, -windows, -door});
    return kCellBlend.join({hull, roof, bogie(m - Vec3(-58, 0, -8.8)), bogie(m - Vec3(-19, 0, -8.8))});
}

/// A streamlined engine driving to +x and its wagon, 144 long; left and right are mirror images.
double tram(const Vec3& q) {
    const Vec3 m(q.x, std::abs(q.y), q.z);
    const double coupling = rod(m, {-8, 0, -8}, {10, 0, -8}, 2.2, 2.2);
    const double bellows = box(m - Vec3(0.5, 0, 0.5), {8, 9, 7.5}, 2);
    return kCellBlend.join({engine(m), wagon(m), coupling, bellows});
}

constexpr std::array<Deformation, 3> kTrain2Deformation{Sway{.along = 0, .towards = 1, .amount = 16, .rate = 0.0413},
                                                        Twist{.axis = 0, .rate = 0.004},
                                                        Bend{.along = 0, .towards = 2, .radius = 170}};

}  // namespace

constinit const Solid kTrain2{
    .distance = tram, .transition = kCellTransition, .half = {76, 20, 16.5}, .main = 0, .deformation = kTrain2Deformation};

}  // namespace subvol::detail::model
