// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/limit_place.h"

#include <algorithm>
#include <cmath>

#include "corner_of.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

// A step is no longer than this in any parameter: farther away, the Jacobian of one place means little.
constexpr double kLongestStep = 0.75;
// A part of the product of the lengths of the Jacobian's columns: cells that are flatter have no inverse.
constexpr double kFlat = 1e-9;

Vec3 parameters_of(std::size_t corner) {
    const auto& p = kCornerParameters[corner];
    return {p[0], p[1], p[2]};
}

/// Solves the columns whose bit is set in `free` in the sense of least squares, slightly damped so that flat cells do no harm.
Vec3 solve(const Mat3& jacobian, unsigned free, const Vec3& offset) {
    Mat3 normal(1.0);
    Vec3 right(0.0);
    double scale = 0;
    for (int a = 0; a < 3; ++a) scale = std::max(scale, glm::dot(jacobian[a], jacobian[a]));
    if (!(scale > 0)) return Vec3(0.0);
    for (int a = 0; a < 3; ++a) {
        if ((free >> a & 1) == 0) continue;
        right[a] = glm::dot(jacobian[a], offset);
        for (int b = 0; b < 3; ++b) normal[b][a] = (free >> b & 1) != 0 ? glm::dot(jacobian[a], jacobian[b]) : 0;
        normal[a][a] += 1e-14 * scale;
    }
    for (int a = 0; a < 3; ++a) {
        if ((free >> a & 1) == 0) normal[a] = Vec3(a == 0, a == 1, a == 2);
    }
    const double determinant = glm::determinant(normal);
    if (!(std::abs(determinant) > 0)) return Vec3(0.0);
    return glm::inverse(normal) * right;
}

Vec3 solve_all(const Mat3& jacobian, const Vec3& offset) {
    const double determinant = glm::determinant(jacobian);
    const double size = glm::length(jacobian[0]) * glm::length(jacobian[1]) * glm::length(jacobian[2]);
    if (!(std::abs(determinant) > kFlat * size)) return solve(jacobian, 7, offset);
    return glm::inverse(jacobian) * offset;
}

}  // namespace

bool CellSteps::on_hull(Index cell, std::size_t axis, bool side) const {
    return topology_.face_on_hull(topology_.cell_faces[cell][2 * axis + (side ? 1 : 0)]);
}

void CellSteps::enter(LimitPlace& place) const {
    for (int crossed = 0; crossed < 3; ++crossed) {
        // The face that is farthest behind is crossed first.
        double most = 0;
        std::size_t axis = 3;
        bool side = false;
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = place.uvw[static_cast<int>(a)];
            const double beyond = std::max(-t, t - 1);
            if (beyond <= most || on_hull(place.cell, a, t > 1)) continue;
            most = beyond;
            axis = a;
            side = t > 1;
        }
        if (axis == 3) break;
        cross(place, axis, side);
    }
    place.uvw = glm::clamp(place.uvw, Vec3(0.0), Vec3(1.0));
}

void CellSteps::cross(LimitPlace& place, std::size_t axis, bool side) const {
    const std::size_t number = 2 * axis + (side ? 1 : 0);
    const auto& corners = kCellFaces[number];
    const auto& pair = topology_.face_cells[topology_.cell_faces[place.cell][number]];
    const Index other = pair[0] == place.cell ? pair[1] : pair[0];
    const auto& from = mesh_.cells[place.cell];
    const auto& to = mesh_.cells[other];
    const auto image = [&](std::size_t k) { return parameters_of(corner_of(to, from[corners[k]])); };
    const auto origin = parameters_of(corners[0]);
    const Vec3 along = parameters_of(corners[1]) - origin;
    const Vec3 across = parameters_of(corners[3]) - origin;
    const Vec3 offset = place.uvw - origin;
    const Vec3 start = image(0), first = image(1) - start, second = image(3) - start;
    const double t = place.uvw[static_cast<int>(axis)];
    const double depth = side ? t - 1 : -t;
    // Inwards in the other cell: the axis that is not in its face.
    const Vec3 free = Vec3(1.0) - glm::abs(first) - glm::abs(second);
    const Vec3 inwards = free * (Vec3(1.0) - 2.0 * start);
    place.cell = other;
    place.uvw = start + glm::dot(offset, along) * first + glm::dot(offset, across) * second + depth * inwards;
}

LimitStep step_towards(const Vec3& offset, const Mat3& jacobian, const LimitPlace& from, const CellSteps& steps) {
    LimitStep step;
    step.by = solve_all(jacobian, offset);
    unsigned free = 7;
    Vec3 held(0.0);  // the steps of the axes that are not free
    for (int again = 0; again < 3; ++again) {
        bool more = false;
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = static_cast<int>(a);
            const double to = from.uvw[axis] + step.by[axis];
            if ((free >> a & 1) == 0 || (to >= 0 && to <= 1) || !steps.on_hull(from.cell, a, to > 1)) continue;
            free &= ~(1U << a);
            held[axis] = (to > 1 ? 1.0 : 0.0) - from.uvw[axis];
            more = true;
        }
        if (!more) break;
        step.by = held + solve(jacobian, free, offset - jacobian * held);
        step.held = true;
    }
    const double longest = std::max({std::abs(step.by.x), std::abs(step.by.y), std::abs(step.by.z)});
    if (longest > kLongestStep) step.by *= kLongestStep / longest;
    step.left = offset - jacobian * step.by;
    return step;
}

Vec3 world_gradient(const Mat3& jacobian, const Vec3& derivatives) {
    const double determinant = glm::determinant(jacobian);
    const double size = glm::length(jacobian[0]) * glm::length(jacobian[1]) * glm::length(jacobian[2]);
    if (!(std::abs(determinant) > kFlat * size)) return Vec3(0.0);
    return glm::transpose(glm::inverse(jacobian)) * derivatives;
}

}  // namespace subvol::detail
