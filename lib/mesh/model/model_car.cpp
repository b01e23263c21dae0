// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

constexpr Vec3 kWheel{24, 17.5, -10};  // centre of the left front wheel; the others mirror it

double hull(const Vec3& m) {
    const double tub = box(m - Vec3(0, 0, -5), {38.5, 18, 6.5}, 4);
    const Vec3 narrow(m.x, 0.6 * m.y, m.z);  // round parts are wider than high in it
    const double bonnet = rod(narrow, {12, 0, 0}, {32, 0, -3}, 4.5, 3.5);
    const double boot = rod(narrow, {-20, 0, 0}, {-34, 0, -2}, 4.5, 3.5);
    return kCellBlend.join({tub, bonnet, boot});
}

/// The cabin is narrower towards the roof, and has posts at its four corners and in the middle of each side.
double cabin(const Vec3& m) {
    const Vec3 level(0, 0, 7.5);  // of the windows
    const double shell = box(m - Vec3(-5, 0, 7), {22, 16, 9.5}, 4);
    const double front = behind(m - Vec3(17, 0, 2), {2, 0, 1}), rear = behind(m - Vec3(-27, 0, 2), {-3, 0, 1});
    const double side = behind(m - Vec3(0, 16, 2), {0, 4, 1});
    const double front_windows = box(m - level - Vec3(4, 0, 0), {6, 40, 4.6}, 2);
    const double rear_windows = box(m - level - Vec3(-13.5, 0, 0), {6.5, 40, 4.6}, 2);
    const double screens = box(m - level, {80, 10, 4.6}, 2);
    return kCellBlend.meet({shell, front, rear, side, -front_windows, -rear_windows, -screens});
}

double wheel(const Vec3& m) {
    const Vec3 q = m - kWheel;
    const double tyre = kCellBlend.cut(cylinder(q, 1, 8, 3.6), ring(q - Vec3(0, 3.8, 0), 1, 4.6, 1.5));
    const double axle = cylinder(m - Vec3(kWheel.x, 0, kWheel.z), 1, 2.2, kWheel.y);
    return kCellBlend.join({tyre, ellipsoid(q - Vec3(0, 3, 0), {2.6, 2, 2.6}), axle});
}

double lamps(const Vec3& m) {
    return kCellBlend.join({ball(m - Vec3(37, 11, -1.5), 4.2), box(m - Vec3(-38.5, 13, -3), {1.6, 2.2, 2.6})});
}

/// A toy car driving to +x, 83 long; left and right are mirror images.
double car(const Vec3& q) {
    const Vec3 m(q.x, std::abs(q.y), q.z);
    const Vec3 quarter(std::abs(m.x), m.y, m.z);  // front and rear have the same wheels and bumpers
    const double bumper = rod(quarter, {39.5, 0, -9}, {39.5, 15, -9}, 2, 2);
    const double arch = cylinder(quarter - kWheel, 1, 9.6, 6);
    const double grille = box(m - Vec3(40, 0, -3), {2.5, 5, 2});
    const double body = kCellBlend.meet({kCellBlend.join({hull(m), cabin(m)}), -arch, -grille});
    return kCellBlend.join({body, wheel(quarter), lamps(m), bumper});
}

constexpr std::array<Deformation, 3> kCarDeformation{Swell{.along = 0, .amount = 0.15, .rate = 0.036, .phase = 0.3},
                                                     Twist{.axis = 0, .rate = 0.006},
                                                     Bend{.along = 0, .towards = 2, .radius = 62}};

}  // namespace

constinit const Solid kCar{
    .distance = car, .transition = kCellTransition, .half = {44, 25, 19.5}, .main = 0, .deformation = kCarDeformation};

}  // namespace subvol::detail::model
