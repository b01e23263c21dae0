// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/principal_axes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace subvol::detail {

namespace {

constexpr double kFlattest = 1e-6;

}  // namespace

PrincipalAxes principal_axes(const Symmetric3& frame) {
    const Mat3 s = matrix(frame);
    Eigen::Matrix3d m;
    m << s[0][0], s[1][0], s[2][0], s[0][1], s[1][1], s[2][1], s[0][2], s[1][2], s[2][2];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
    const Eigen::Vector3d& squares = solver.eigenvalues();
    std::array<int, 3> order{0, 1, 2};  // of equal axes the first one stays the first
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return squares[a] > squares[b]; });
    PrincipalAxes axes;
    const double longest = std::sqrt(std::max(squares[order[0]], 0.0));
    for (int k = 0; k < 3; ++k) {
        const int from = order[static_cast<std::size_t>(k)];
        const auto direction = solver.eigenvectors().col(from);
        axes.half_axes[k] = std::max(std::sqrt(std::max(squares[from], 0.0)), kFlattest * longest);
        axes.directions[k] = glm::normalize(Vec3(direction[0], direction[1], direction[2]));
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
