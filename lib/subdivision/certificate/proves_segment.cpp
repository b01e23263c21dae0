// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "edge_kind.h"
#include "subvol/vec.h"

namespace subvol::detail {

double spectral_norm(const Eigen::Matrix2d& m) {
    const double turning = std::hypot(m(0, 0) + m(1, 1), m(1, 0) - m(0, 1));
    const double mirroring = std::hypot(m(0, 0) - m(1, 1), m(1, 0) + m(0, 1));
    return (turning + mirroring) / 2 * (1 + 1e-12);
}

// Any A and ρ with P = 1 c + χ A + ρ would do but for the drift; those that are computed are near the true ones.
namespace {

/// The fit of χ and ψ to the values of a window: row c of A is a[c], row c of C A is slow[c].
struct Fit {
    Vec3 center{0.0}, size{0.0};
    Mat3 a{0.0};
    std::array<Vec3, 2> slow{Vec3(0.0), Vec3(0.0)};

    Fit(const EdgeKind& kind, std::span<const Vec3> values) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            const Vec3 x = values[k] - values[0];
            const auto& left = kind.left[k];
            center += x * left[0];
            for (int c = 0; c < 3; ++c) a[c] += x * left[static_cast<std::size_t>(c) + 1];
            for (std::size_t c = 0; c < 2; ++c) slow[c] += x * kind.slow_left[k][c];
            size = glm::max(size, glm::abs(x));
        }
    }
    [[nodiscard]] Vec3 rest(const EdgeKind& kind, std::span<const Vec3> values, std::size_t k) const {
        const auto& map = kind.characteristic[k];
        const auto& psi = kind.slow[k];
        return values[k] - values[0] - center - a[0] * map[0] - a[1] * map[1] - a[2] * map[2] - slow[0] * psi[0] -
               slow[1] * psi[1];
    }
};

/// |C₁₂| and |C₃| of a matrix with two rows.
struct SlowSize {
    double across = 0, along = 0;

    explicit SlowSize(const std::array<Vec3, 2>& c)
        : across(spectral_norm((Eigen::Matrix2d() << c[0].x, c[0].y, c[1].x, c[1].y).finished())),
          along(std::hypot(c[0].z, c[1].z)) {}
};

double frobenius(const Mat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

}  // namespace

bool proves_segment(const EdgeKind& kind, std::span<const Vec3> points, std::span<const Vec3> motion, double error) {
    if (!kind.is_bounded() || points.size() != kind.weights.size()) return false;
    const Fit fit(kind, points), moved(kind, motion);
    const Mat3& a = fit.a;
    const double det = glm::determinant(a);
    if (!(det > 1e-12 * glm::length(a[0]) * glm::length(a[1]) * glm::length(a[2]))) return false;
    const Mat3 inverse = glm::inverse(a);  // q = inverse · ρ, with A transposed
    double height = 0, residual = 0;
    const Mat3 unit = inverse * a - Mat3(1.0);
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
            height += std::abs(inverse[c][r]);
            residual += std::abs(unit[c][r]);
        }
    }
    constexpr double kOfRests = 1e-8;  // of L, χ and of sums of some hundred products
    const Vec3 size = fit.size + moved.size;
    const Mat3 turning = inverse * moved.a;  // N, transposed
    const double turned = motion.empty() ? 0 : frobenius(turning) + kOfRests * height * (size.x + size.y + size.z);
    if (!(turned < 0.9)) return false;
    const double factor = turned / (1 - turned);  // of (1 + s N)⁻¹ − 1
    const double slack = kind.spread * (2 * error + kOfRests * std::max({size.x, size.y, size.z})) * height * (1 + factor);
    if (!(residual < 1e-6) || !(slack < 1e-2)) return false;
    double across = 0, along = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3 q = inverse * fit.rest(kind, points, k);
        const Vec3 r = motion.empty() ? Vec3(0.0) : inverse * moved.rest(kind, motion, k) - turning * q;
        const double more = factor * glm::length(r);
        across = std::max(across, (std::hypot(q.x, q.y) + std::hypot(r.x, r.y) + more) / kind.weights[k]);
        along = std::max(along, (std::abs(q.z) + std::abs(r.z) + more) / kind.weights[k]);
    }
    // C becomes C + s (C_M − C N)(1 + s N)⁻¹ in time.
    std::array<Vec3, 2> slow{}, change{};
    for (std::size_t c = 0; c < 2; ++c) {
        slow[c] = inverse * fit.slow[c];
        change[c] = motion.empty() ? Vec3(0.0) : inverse * moved.slow[c] - turning * slow[c];
    }
    const SlowSize of_slow(slow), of_change(change);
    const double more = factor * std::hypot(glm::length(change[0]), glm::length(change[1]));
    const auto with_error = [&](double q) { return (q + 2 * slack * (1 + across + along)) * (1 + 1e-5); };
    const double bend_across = kind.slow_size * with_error(of_slow.across + of_change.across + more);
    const double bend_along = kind.slow_size * with_error(of_slow.along + of_change.along + more);
    return bend_across < 1 &&
           with_error(across) * (kind.across + bend_along * kind.along) / (1 - bend_across) + kind.along * with_error(along) <
               1;
}

}  // namespace subvol::detail
