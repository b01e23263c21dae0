// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "model_solid.h"

namespace subvol::detail::model {
namespace {

/// A disk with a groove between rim and hub, about an axle across the whole train. center.y: of the wheel, > 0
double wheel(const Vec3& m, const Vec3& center, double radius) {
    const Vec3 q = m - center;
    const double groove = ring(q - Vec3(0, 2.4, 0), 1, 0.58 * radius, 0.2 * radius);
    const double axle = cylinder(m - Vec3(center.x, 0, center.z), 1, 1.8, center.y);
    return kCellBlend.join({kCellBlend.cut(cylinder(q, 1, radius, 2.4), groove), axle});
}

double wheels(const Vec3& m) {
    constexpr double kY = 14, kZ = -13.5;
    const double drivers =
        kCellBlend.join({wheel(m, {-27, kY, kZ}, 7.6), wheel(m, {-10, kY, kZ}, 7.6), wheel(m, {7, kY, kZ}, 7.6)});
    const double leaders = kCellBlend.join({wheel(m, {25, kY, -16}, 5), wheel(m, {37, kY, -16}, 5)});
    const double coupling_rod = rod(m, {-27, 17.5, kZ}, {7, 17.5, kZ}, 1.7, 1.7);
    const double piston =
        kCellBlend.join({cylinder(m - Vec3(31, 13.5, -9), 0, 4, 6.5), rod(m, {7, 17.5, kZ}, {28, 14.5, -9}, 1.6, 1.6)});
    return kCellBlend.join({drivers, leaders, coupling_rod, piston});
}

double boiler(const Vec3& m) {
    const double barrel = cylinder(m - Vec3(8, 0, 3), 0, 9.8, 30);
    const double smokebox = cylinder(m - Vec3(38, 0, 3), 0, 10.8, 7);
    const double door =
        kCellBlend.join({cylinder(m - Vec3(45, 0, 3), 0, 7.2, 2), ellipsoid(m - Vec3(46, 0, 3), {3.5, 4.5, 4.5})});
    const double bands = kCellBlend.join({ring(m - Vec3(-8, 0, 3), 0, 9.8, 1.5), ring(m - Vec3(18, 0, 3), 0, 9.8, 1.5)});
    return kCellBlend.join({barrel, smokebox, door, bands});
}

double on_top(const Vec3& m) {
    const double stack =
        kCellBlend.join({rod(m, {38, 0, 12}, {38, 0, 17}, 3.2, 4.2), cylinder(m - Vec3(38, 0, 19), 2, 5.8, 2)});
    const double chimney = kCellBlend.cut(stack, cylinder(m - Vec3(38, 0, 22), 2, 3, 5));
    const double domes =
        kCellBlend.join({ellipsoid(m - Vec3(24, 0, 12), {4.5, 4.5, 6}), ellipsoid(m - Vec3(5, 0, 12), {5.5, 5.5, 7})});
    const double lamp = cylinder(m - Vec3(45, 0, 15), 0, 2.6, 2.6);
    return kCellBlend.join({chimney, domes, lamp});
}

/// Open at the back, with a window in each side and a vaulted roof.
double cab(const Vec3& m) {
    const double walls = box(m - Vec3(-33, 0, 5), {15, 15.5, 13});
    const double room = box(m - Vec3(-38, 0, 6), {15, 11.5, 10});
    const double window = box(m - Vec3(-32, 0, 8), {6.5, 40, 5.5}, 1.5);
    const double vault = cylinder(m - Vec3(-34, 0, -16), 0, 37.5, 19), ceiling = box(m - Vec3(-34, 0, 12), {17, 11.5, 5});
    const double roof = kCellBlend.meet({box(m - Vec3(-34, 0, 18), {19, 18.5, 4}), vault, -ceiling});
    return kCellBlend.join({kCellBlend.meet({walls, -room, -window}), roof});
}

/// A wedge before the front wheels, slatted.
double cow_catcher(const Vec3& m) {
    const Vec3 q = m - Vec3(44, 0, -21);
    const double wedge = kCellBlend.meet({behind(q - Vec3(10, 0, 0), {13, 9, 7}), 8.5 - q.x, q.x + 1, q.z, 11 - q.z});
    const double beam = box(m - Vec3(44, 0, -8.5), {2.2, 15, 2.6}, 1);
    return kCellBlend.join({wedge, beam});
}

/// A steam engine driving to +x, 106 long, its wheels' rims at z = -21; left and right are mirror images.
double steam_train(const Vec3& q) {
    const Vec3 m(q.x, std::abs(q.y), q.z);
    const double frame = box(m - Vec3(-2, 0, -10), {46, 9, 4});
    const double footplate = box(m - Vec3(-4, 0, -6.6), {46, 16, 1.7});
    return kCellBlend.join({frame, footplate, wheels(m), boiler(m), on_top(m), cab(m), cow_catcher(m)});
}

constexpr std::array<Deformation, 3> kTrain1Deformation{Swell{.along = 0, .amount = 0.15, .rate = 0.028},
                                                        Sway{.along = 0, .towards = 2, .amount = 6, .rate = 0.05, .phase = 0.6},
                                                        Bend{.along = 0, .towards = 1, .radius = 75}};

}  // namespace

constinit const Solid kTrain1{.distance = steam_train,
                              .transition = kCellTransition,
                              .half = {56, 22, 23.5},
                              .main = 0,
                              .deformation = kTrain1Deformation};

}  // namespace subvol::detail::model
