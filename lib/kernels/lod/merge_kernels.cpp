// SPDX-License-Identifier: Apache-2.0
#include "merge_kernels.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernel_tree.h"

namespace subvol::detail {

namespace {

constexpr double kFlattest = 1e-6;  // of the trace of a covariance: the square of a relative thickness, as floats can hold it
constexpr double kDamping = 1e-3;   // of second derivatives that the places do not decide

Mat3 outer(const Vec3& d) {
    return glm::outerProduct(d, d);
}

double trace(const Mat3& m) {
    return m[0][0] + m[1][1] + m[2][2];
}

/// L of S = L Lᵀ, lower triangular.
struct Root {
    double xx, yx, yy, zx, zy, zz;

    explicit Root(const Mat3& s) {
        const double least = std::max(kFlattest * trace(s), std::numeric_limits<double>::min());
        xx = std::sqrt(std::max(s[0][0], least));
        yx = s[0][1] / xx;
        zx = s[0][2] / xx;
        yy = std::sqrt(std::max(s[1][1] - yx * yx, least));
        zy = (s[1][2] - zx * yx) / yy;
        zz = std::sqrt(std::max(s[2][2] - zx * zx - zy * zy, least));
    }
    [[nodiscard]] Mat3 matrix() const { return {Vec3(xx, yx, zx), Vec3(0, yy, zy), Vec3(0, 0, zz)}; }
    [[nodiscard]] Vec3 solve(const Vec3& d) const {
        const double x = d.x / xx, y = (d.y - yx * x) / yy;
        return {x, y, (d.z - zx * x - zy * y) / zz};
    }
    [[nodiscard]] Vec3 solve_transposed(const Vec3& d) const {
        const double z = d.z / zz, y = (d.y - zy * z) / yy;
        return {(d.x - yx * y - zx * z) / xx, y, z};
    }
    [[nodiscard]] double determinant() const { return xx * yy * zz; }
};

/// Mean, linear and quadratic terms in the coordinates y = L⁻¹ (x − centre), in which the whole has the unit covariance.
constexpr int kFull = 10, kAlong = 5;
using Terms = std::array<double, kFull>;

/// Without Hessians the last term is |y|², which S⁻¹ is in these coordinates.
Terms terms_at(const Vec3& y, bool full) {
    if (!full) return {1, y.x, y.y, y.z, glm::dot(y, y)};
    return {1, y.x, y.y, y.z, y.x * y.x, y.y * y.y, y.z * y.z, y.x * y.y, y.x * y.z, y.y * y.z};
}

double sum_of(const Terms& factors, const Terms& terms, int count) {
    double sum = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) sum += factors[k] * terms[k];
    return sum;
}

Terms mean_of(std::span<const Moments> parts, std::span<const Quadratic> quadratics, const Moments& whole, const Mat3& l,
              bool full) {
    Terms mean{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const double share = parts[i].mass / whole.mass;
        const Vec3 d = whole.center - parts[i].center;
        const Vec3 b = glm::transpose(l) * quadratics[i].gradient_at(d);
        const Mat3 q = 0.5 * (glm::transpose(l) * quadratics[i].bend * l);
        const double along = trace(q) / 3;
        const Terms terms =
            full ? Terms{quadratics[i].at(d), b.x, b.y, b.z, q[0][0], q[1][1], q[2][2], 2 * q[0][1], 2 * q[0][2], 2 * q[1][2]}
                 : Terms{quadratics[i].at(d), b.x, b.y, b.z, along};
        for (std::size_t k = 0; k < terms.size(); ++k) mean[k] += share * terms[k];
    }
    return mean;
}

struct Place {
    Vec3 d;
    double share;
};

/// Places about a part's centre that have its mass, mean and covariance.
std::array<Place, 7> places_of(const Moments& part) {
    const Mat3 l = Root(part.covariance).matrix();
    constexpr double kStep = 2, kShare = 1 / (2 * kStep * kStep);
    return {{{Vec3(0.0), 1 - 6 * kShare},
             {kStep * l[0], kShare},
             {-kStep * l[0], kShare},
             {kStep * l[1], kShare},
             {-kStep * l[1], kShare},
             {kStep * l[2], kShare},
             {-kStep * l[2], kShare}}};
}

}  // namespace

/// S = R² J Jᵀ, and a cube of side 1 has the covariance 1/12. n cells in a row then have n² times that of one, as n kernels in
/// a row are to become one that is n times as long.
Moments moments_of(const Vec3& center, const Symmetric3& frame, double radius) {
    const InverseRoot root = inverse_root(frame);
    return {1 / (root.a[0] * root.a[2] * root.a[5]), center, 1 / (12 * radius * radius) * matrix(frame)};
}

Moments merged(std::span<const Moments> parts) {
    Moments whole;
    const Vec3& origin = parts.front().center;  // differences of large coordinates are exact, their sums are not
    Vec3 mean(0.0);
    for (const Moments& part : parts) {
        whole.mass += part.mass;
        mean += part.mass * (part.center - origin);
    }
    whole.center = origin + mean / whole.mass;
    for (const Moments& part : parts) {
        whole.covariance += (part.mass / whole.mass) * (part.covariance + outer(part.center - whole.center));
    }
    return whole;
}

Symmetric3 frame_of(const Moments& moments) {
    const Mat3 c = moments.covariance + kFlattest * trace(moments.covariance) * Mat3(1.0);
    const double ratio = moments.mass / Root(c).determinant();
    return symmetric3(std::cbrt(ratio * ratio) * c);
}

Quadratic quadratic_of(const RbfVolume& volume, const RbfChannel& channel, std::size_t i) {
    const auto& g = channel.gradients[i];
    Quadratic q{double(channel.values[i]), Vec3(g[0], g[1], g[2]), Mat3(0.0)};
    if (channel.moments[i] != 0) {
        const InverseRoot root = inverse_root(volume.frames[i]);
        for (int k = 0; k < 3; ++k) {
            Vec3 unit(0.0);
            unit[k] = 1;
            q.bend[k] = 2.0 * double(channel.moments[i]) * root.transposed_times(root.times(unit));
        }
    }
    if (!channel.hessians.empty()) q.bend += matrix(channel.hessians[i]);
    return q;
}

void store(const Quadratic& q, const RbfVolume& volume, RbfChannel& channel, std::size_t i) {
    const Mat3 s = matrix(volume.frames[i]);
    const auto moment = static_cast<float>(trace(q.bend * s) / 6);
    const Vec3 g = q.gradient;
    const std::array<float, 3> gradient{static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
    Symmetric3 hessian{};
    if (!channel.hessians.empty()) {
        const InverseRoot root = inverse_root(volume.frames[i]);
        Mat3 rest = q.bend;
        for (int k = 0; k < 3; ++k) {
            Vec3 unit(0.0);
            unit[k] = 1;
            rest[k] -= 2.0 * double(moment) * root.transposed_times(root.times(unit));
        }
        hessian = symmetric3(rest);
    }
    channel.values[i] = static_cast<float>(q.value);
    bool finite = std::isfinite(moment);
    for (const float x : gradient) finite = finite && std::isfinite(x);
    for (const float x : hessian) finite = finite && std::isfinite(x);
    if (!finite) return;
    channel.gradients[i] = gradient;
    channel.moments[i] = moment;
    if (!channel.hessians.empty()) channel.hessians[i] = hessian;
}

/// The mean of the parts' polynomials is taken first, and then what it leaves at places in the parts is fitted: terms that the
/// places do not decide stay those of the mean.
Quadratic merged(std::span<const Moments> parts, std::span<const Quadratic> quadratics, const Moments& whole, bool full) {
    const Root root(whole.covariance + kFlattest * trace(whole.covariance) * Mat3(1.0));
    const Mat3 l = root.matrix();
    const int count = full ? kFull : kAlong;
    Terms factors = mean_of(parts, quadratics, whole, l, full);
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kFull, kFull>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFull, 1>;
    Matrix normal = Matrix::Zero(count, count);
    Vector right = Vector::Zero(count);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (const Place& place : places_of(parts[i])) {
            const Terms terms = terms_at(root.solve(parts[i].center + place.d - whole.center), full);
            const double rest = quadratics[i].at(place.d) - sum_of(factors, terms, count);
            const double weight = place.share * parts[i].mass / whole.mass;
            const Eigen::Map<const Vector> row(terms.data(), count);
            normal.noalias() += weight * row * row.transpose();
            right += weight * rest * row;
        }
    }
    for (int k = 4; k < count; ++k) normal(k, k) += kDamping;
    const Vector change = normal.ldlt().solve(right);
    for (int k = 0; k < count; ++k) factors[static_cast<std::size_t>(k)] += change[k];

    Mat3 q(factors[4]);
    if (full) {
        q = {Vec3(factors[4], factors[7] / 2, factors[8] / 2), Vec3(factors[7] / 2, factors[5], factors[9] / 2),
             Vec3(factors[8] / 2, factors[9] / 2, factors[6])};
    }
    Quadratic result{factors[0], root.solve_transposed({factors[1], factors[2], factors[3]}), Mat3(0.0)};
    Mat3 half;  // L⁻ᵀ Q, then its transpose again from the left
    for (int k = 0; k < 3; ++k) half[k] = root.solve_transposed(q[k]);
    half = glm::transpose(half);
    for (int k = 0; k < 3; ++k) result.bend[k] = 2.0 * root.solve_transposed(half[k]);
    return result;
}

double largest_difference(const Quadratic& a, const Vec3& a_center, const Quadratic& b, const Vec3& b_center, const Box& box) {
    const Vec3 middle = box.center(), half = 0.5 * box.size();
    const Vec3 gradient = a.gradient_at(middle - a_center) - b.gradient_at(middle - b_center);
    double sum = std::abs(a.at(middle - a_center) - b.at(middle - b_center)) + glm::dot(glm::abs(gradient), half);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) sum += 0.5 * std::abs(a.bend[i][j] - b.bend[i][j]) * half[i] * half[j];
    }
    return sum;
}

}  // namespace subvol::detail
