// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/principal_axes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace subvol::detail {

namespace {

constexpr int kSweeps = 12;  // convergence is quadratic: five make a double exact
constexpr double kFlattest = 1e-6;

/// Turns the axes p and q so that s's entry between them vanishes (Jacobi).
void rotate(Mat3& s, Mat3& directions, int p, int q) {
    if (s[p][q] == 0) return;
    const double theta = (s[q][q] - s[p][p]) / (2 * s[p][q]);
    const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
    const double cosine = 1 / std::hypot(t, 1.0), sine = t * cosine;
    Mat3 turn(1.0);
    turn[p][p] = turn[q][q] = cosine;
    turn[q][p] = sine;
    turn[p][q] = -sine;
    s = glm::transpose(turn) * s * turn;
    s[p][q] = s[q][p] = 0;
    directions = directions * turn;
}

}  // namespace

PrincipalAxes principal_axes(const Symmetric3& frame) {
    Mat3 s = matrix(frame);
    Mat3 directions(1.0);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        rotate(s, directions, 0, 1);
        rotate(s, directions, 0, 2);
        rotate(s, directions, 1, 2);
    }
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return s[a][a] > s[b][b]; });
    PrincipalAxes axes;
    const double longest = std::sqrt(std::max(s[order[0]][order[0]], 0.0));
    for (int k = 0; k < 3; ++k) {
        const int from = order[static_cast<std::size_t>(k)];
        axes.half_axes[k] = std::max(std::sqrt(std::max(s[from][from], 0.0)), kFlattest * longest);
        axes.directions[k] = glm::normalize(directions[from]);
    }
    if (glm::determinant(axes.directions) < 0) axes.directions[2] = -axes.directions[2];
    return axes;
}

std::array<double, 4> quaternion(const Mat3& rotation) {
    const glm::dquat q = glm::normalize(glm::quat_cast(rotation));
    const double sign = q.w < 0 ? -1 : 1;
    return {sign * q.w, sign * q.x, sign * q.y, sign * q.z};
}

}  // namespace subvol::detail
