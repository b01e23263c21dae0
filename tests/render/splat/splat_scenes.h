// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/test_meshes.h"
#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/sample.h"

namespace subvol::test {

/// Nested cubes mapped onto the unit ball: extraordinary edges and vertices inside, curved outside.
inline HexMesh nested_ball(Index n) {
    HexMesh mesh = make_nested_cubes(n);
    for (auto& p : mesh.points) {
        const double cube = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (cube > 0) p *= (1 - cube) + cube * cube / glm::length(p);
    }
    return mesh;
}

/// Gives a mesh around the origin a field of two waves between 0 and 1.
inline HexMesh with_waves(HexMesh mesh) {
    add_field(mesh, "f", [](const Vec3& p) { return .5 + .3 * std::sin(2.5 * p.x + p.y) + .2 * std::cos(2 * p.z - p.y); });
    add_field(mesh, "g", [](const Vec3& p) { return .5 + .5 * std::cos(3 * p.x * p.y + 2 * p.z); });
    return mesh;
}

/// A box of side 2 about the origin, its inner points moved.
inline HexMesh jittered_box_about_origin() {
    HexMesh mesh = jittered_box(4, .2, 3);
    for (Vec3& p : mesh.points) p = 2.0 * p - 1.0;
    return mesh;
}

/// A cube from 0 to 1 with a layer of thin cells at its face x = 0, in which the field rises steeply from 0.3 to 0.8.
inline HexMesh cube_with_layer() {
    HexMesh mesh = box(20);
    for (Vec3& p : mesh.points) {
        const double k = std::round(20 * p.x);
        p.x = k <= 12 ? .02 * k / 12 : .02 + .98 * (k - 12) / 8;
    }
    add_field(mesh, "f", [](const Vec3& p) { return .3 + .1 * std::sin(3 * p.y + p.z) + .5 * (1 - std::exp(-p.x / .005)); });
    return mesh;
}

/// Knots lie on the cells of the table: multiples of 1/4096 of the range.
inline Optics smooth_optics() {
    return Optics({.color = {{0, {.1, .2, .9}}, {.5, {.9, .9, .3}}, {1, {.9, .2, .1}}}, .opacity = {{0, 0}, {1, .5}}}, .5);
}

inline Optics sharp_optics() {
    return Optics({.color = {{0, {.1, .2, .9}}, {.5, {.9, .9, .3}}, {1, {.9, .2, .1}}},
                   .opacity = {{0, 0}, {.4375, 0}, {.46875, .9}, {.5, 0}, {1, 0}}},
                  .2);
}

inline Camera perspective_camera() {
    return {.eye = {2.6, -4.2, 2.0}, .target = {.05, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 36};
}

inline Camera orthographic_camera() {
    return {.eye = {3, -4, 2.5}, .target = {0, .03, 0}, .up = {0, 0, 1}, .ortho_height = 3.2};
}

}  // namespace subvol::test
