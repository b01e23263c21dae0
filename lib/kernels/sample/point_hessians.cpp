// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>

#include "direction_sums.h"
#include "subvol/detail/bucket_sort.h"

namespace subvol::detail {

namespace {

using Six = Eigen::Matrix<double, 6, 1>;  // xx xy xz yy yz zz

Eigen::Vector3d vector(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Eigen::Vector3d vector(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

Eigen::Matrix3d symmetric(const Six& s) {
    Eigen::Matrix3d m;
    m << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
    return m;
}

/// The matrix that takes the six numbers of a symmetric matrix M to the product M d.
Eigen::Matrix<double, 3, 6> product_rows(const Eigen::Vector3d& d) {
    Eigen::Matrix<double, 3, 6> rows = Eigen::Matrix<double, 3, 6>::Zero();
    rows.row(0).head<3>() = d;
    rows.row(1) << 0, d.x(), 0, d.y(), d.z(), 0;
    rows.row(2) << 0, 0, d.x(), 0, d.y(), d.z();
    return rows;
}

/// Fits the Hessian of one point, in coordinates in which its frame is the ball of one sample interval.
class HessianFit {
public:
    void begin(const Symmetric3& frame, double radius) {
        Six s;
        for (int k = 0; k < 6; ++k) s[k] = frame[static_cast<std::size_t>(k)] / (radius * radius);
        root_ = symmetric(s).llt().matrixL();
        normal_.setZero();
        used_ = 0;
    }

    /// along: ½ dᵀHd from the values; gradient: H d from the gradients
    void add(const Eigen::Vector3d& offset, double along, const Eigen::Vector3d& gradient) {
        const Eigen::Vector3d d = root_.triangularView<Eigen::Lower>().solve(offset);
        const Eigen::Vector3d change = root_.transpose() * gradient;
        const Eigen::Matrix<double, 3, 6> product = product_rows(d);
        const Six row = .5 * product.transpose() * d;
        const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose() / d.squaredNorm();
        const Eigen::Matrix<double, 3, 6> rows = across * product;
        if (used_++ == 0) right_.setZero();
        normal_ += 4 * row * row.transpose() + rows.transpose() * rows;
        right_ += 4 * along * row + rows.transpose() * (across * change);
    }

    [[nodiscard]] Mat3 finish() const {
        if (used_ < 3) return Mat3(0.0);
        const Eigen::Matrix3d h = symmetric((normal_ + 1e-9 * Eigen::Matrix<double, 6, 6>::Identity()).ldlt().solve(right_));
        const Eigen::Matrix3d inverse = root_.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
        const Eigen::Matrix3d world = inverse.transpose() * h * inverse;
        Mat3 hessian;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) hessian[a][b] = world(a, b);
        }
        return hessian;
    }

private:
    Eigen::Matrix3d root_;
    Eigen::Matrix<double, 6, 6> normal_;
    Six right_;
    int used_ = 0;
};

}  // namespace

void fit_hessians(const PointLines& lines, RbfVolume& volume) {
    const double radius = support_radius(volume.kernel);
    parallel_each(volume.size(), [&](std::size_t p) {
        HessianFit fit;
        for (RbfChannel& channel : volume.channels) {
            fit.begin(volume.frames[p], radius);
            const Eigen::Vector3d g = vector(channel.gradients[p]);
            for (std::size_t i = lines.starts[p]; i < lines.end(p); ++i) {
                const Index q = lines.neighbours[i];
                if (q == kNone) continue;
                const Eigen::Vector3d offset = vector(volume.centers[q] - volume.centers[p]);
                const double rise = double(channel.values[q]) - double(channel.values[p]);
                fit.add(offset, rise - g.dot(offset), vector(channel.gradients[q]) - g);
            }
            channel.hessians[p] = without_moment(fit.finish(), volume.frames[p]);
        }
    });
}

}  // namespace subvol::detail
