// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/cell_locator.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

// Rounding of a determinant of three edges, in units of the product of their lengths: some 50 roundings of 1.1e-16.
constexpr double kRounding = 1e-14;
// Below this a tetrahedron is flat; above it the tolerance of the barycentric coordinates stays under 1 %.
constexpr double kFlat = 1e-12;

constexpr int kNewtonSteps = 10;
constexpr double kNewtonTolerance = 1e-8;  // of the cell's size: below the rounding of a float
constexpr double kOutside = 0.25;          // how far a bent face may lie beyond its two triangles, in parameters

Vec3 parameters_of(std::size_t corner) {
    const auto& uvw = kCornerParameters[corner];
    return {uvw[0], uvw[1], uvw[2]};
}

std::array<double, 8> trilinear_weights(const Vec3& uvw) {
    std::array<double, 8> weights;
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3 corner = parameters_of(k);
        const Vec3 factors = corner * uvw + (1.0 - corner) * (1.0 - uvw);
        weights[k] = factors.x * factors.y * factors.z;
    }
    return weights;
}

std::array<Vec3, 8> polynomial_of(const std::array<Vec3, 8>& c) {
    return {c[0],
            c[1] - c[0],
            c[3] - c[0],
            c[4] - c[0],
            c[0] - c[1] + c[2] - c[3],
            c[0] - c[3] + c[7] - c[4],
            c[0] - c[1] + c[5] - c[4],
            c[1] - c[0] + c[3] - c[2] + c[4] - c[5] + c[6] - c[7]};
}

}  // namespace

CellLocator::CellLocator(const HexMesh& mesh, Index cell) : origin_(mesh.points[mesh.cells[cell][0]]) {
    const auto& ids = mesh.cells[cell];
    Box box;
    for (std::size_t k = 0; k < 8; ++k) {
        corners_[k] = mesh.points[ids[k]] - origin_;
        box.add(corners_[k]);
    }
    size_ = std::max({box.size().x, box.size().y, box.size().z});
    polynomial_ = polynomial_of(corners_);
    for (const auto& tetrahedron : split_cell(ids)) {
        std::array<std::size_t, 4> corners;
        for (std::size_t k = 0; k < 4; ++k) {
            corners[k] = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), tetrahedron[k]) - ids.begin());
        }
        add_tetrahedron(corners);
    }
}

void CellLocator::add_tetrahedron(const std::array<std::size_t, 4>& corners) {
    const Vec3 first = corners_[corners[0]];
    const Vec3 a = corners_[corners[1]] - first;
    const Vec3 b = corners_[corners[2]] - first;
    const Vec3 c = corners_[corners[3]] - first;
    const double determinant = glm::dot(a, glm::cross(b, c));
    const double scale = glm::length(a) * glm::length(b) * glm::length(c);
    if (!(std::abs(determinant) > kFlat * scale)) return;
    tetrahedra_[tetrahedron_count_++] = {
        corners,
        first,
        {glm::cross(b, c) / determinant, glm::cross(c, a) / determinant, glm::cross(a, b) / determinant},
        kRounding * scale / std::abs(determinant)};
}

std::array<double, 4> CellLocator::Tetrahedron::barycentric(const Vec3& p) const {
    const Vec3 d = p - first;
    const double b = glm::dot(gradients[0], d), c = glm::dot(gradients[1], d), e = glm::dot(gradients[2], d);
    return {1.0 - b - c - e, b, c, e};
}

bool CellLocator::Tetrahedron::holds(const Vec3& p) const {
    const auto lambda = barycentric(p);
    return std::min({lambda[0], lambda[1], lambda[2], lambda[3]}) >= -tolerance;
}

std::optional<std::size_t> CellLocator::find_tetrahedron(const Vec3& x) const {
    const Vec3 p = x - origin_;
    for (std::size_t t = 0; t < tetrahedron_count_; ++t) {
        if (tetrahedra_[t].holds(p)) return t;
    }
    return std::nullopt;
}

std::optional<Vec3> CellLocator::parameters_at(const Tetrahedron& tetrahedron, const Vec3& p) const {
    const auto lambda = tetrahedron.barycentric(p);
    Vec3 start(0.0);
    for (std::size_t k = 0; k < 4; ++k) start += lambda[k] * parameters_of(tetrahedron.corners[k]);
    return invert(start, p);
}

std::array<double, 8> CellLocator::weights(std::size_t tetrahedron, const Vec3& x) const {
    const Tetrahedron& within = tetrahedra_[tetrahedron];
    if (const auto uvw = parameters_at(within, x - origin_)) return trilinear_weights(*uvw);

    const auto lambda = within.barycentric(x - origin_);
    std::array<double, 8> linear{};
    for (std::size_t k = 0; k < 4; ++k) linear[within.corners[k]] = lambda[k];
    return linear;
}

Vec3 CellLocator::gradient(std::size_t tetrahedron, const Vec3& x, const std::array<double, 8>& values) const {
    const Tetrahedron& within = tetrahedra_[tetrahedron];
    const double first = values[within.corners[0]];
    Vec3 linear(0.0);
    for (std::size_t k = 1; k < 4; ++k) linear += (values[within.corners[k]] - first) * within.gradients[k - 1];

    const auto uvw = parameters_at(within, x - origin_);
    if (!uvw) return linear;
    const Mat3 j = jacobian(*uvw);
    const double determinant = glm::determinant(j);
    if (determinant == 0.0) return linear;
    Vec3 by_parameters(0.0);
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3 corner = parameters_of(k);
        const Vec3 factors = corner * *uvw + (1.0 - corner) * (1.0 - *uvw), signs = 2.0 * corner - 1.0;
        by_parameters += values[k] * signs * Vec3(factors.y * factors.z, factors.z * factors.x, factors.x * factors.y);
    }
    // ∇f = J⁻ᵀ (∂f/∂u, ∂f/∂v, ∂f/∂w): the rows of J⁻¹ are cross products of J's columns.
    return (by_parameters.x * glm::cross(j[1], j[2]) + by_parameters.y * glm::cross(j[2], j[0]) +
            by_parameters.z * glm::cross(j[0], j[1])) /
           determinant;
}

Vec3 CellLocator::position(const Vec3& q) const {
    const auto& c = polynomial_;
    return c[0] + q.x * c[1] + q.y * c[2] + q.z * c[3] + q.x * q.y * c[4] + q.y * q.z * c[5] + q.z * q.x * c[6] +
           q.x * q.y * q.z * c[7];
}

Mat3 CellLocator::jacobian(const Vec3& q) const {
    const auto& c = polynomial_;
    return {c[1] + q.y * c[4] + q.z * c[6] + q.y * q.z * c[7], c[2] + q.x * c[4] + q.z * c[5] + q.z * q.x * c[7],
            c[3] + q.y * c[5] + q.x * c[6] + q.x * q.y * c[7]};
}

std::optional<Vec3> CellLocator::invert(const Vec3& start, const Vec3& p) const {
    const double tolerance = kNewtonTolerance * size_;
    Vec3 uvw = start;
    for (int step = 0; step <= kNewtonSteps; ++step) {
        const Vec3 residual = p - position(uvw);
        if (glm::dot(residual, residual) <= tolerance * tolerance) {
            const Vec3 beyond = glm::abs(uvw - 0.5) - 0.5;
            const bool near = std::max({beyond.x, beyond.y, beyond.z}) <= kOutside;
            return near ? std::optional(uvw) : std::nullopt;
        }
        const Mat3 j = jacobian(uvw);
        const Vec3 across = glm::cross(j[1], j[2]);
        const double determinant = glm::dot(j[0], across);
        if (determinant == 0.0) return std::nullopt;
        // Cramer's rule. A value that is not finite never passes the comparison above, so the loop ends after all steps.
        uvw += Vec3(glm::dot(residual, across), glm::dot(j[0], glm::cross(residual, j[2])),
                    glm::dot(j[0], glm::cross(j[1], residual))) /
               determinant;
    }
    return std::nullopt;
}

}  // namespace subvol::detail
