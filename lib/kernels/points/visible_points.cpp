// SPDX-License-Identifier: Apache-2.0
#include "subvol/visible_points.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/points_range.h"
#include "subvol/error.h"

namespace subvol {

namespace {

using detail::parallel_each;

struct RangeOfValues {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();

    void add(const RangeOfValues& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
};

/// One kernel, and the values that it can have within a box.
class KernelInBox {
public:
    KernelInBox(const RbfVolume& volume, const RbfChannel& channel, std::size_t i)
        : center_(volume.centers[i]), value_(channel.values[i]), moment_(channel.moments[i]) {
        const auto& g = channel.gradients[i];
        inverse_ = glm::inverse(matrix(volume.frames[i]));
        gradient_ = {g[0], g[1], g[2]};
        if (!channel.hessians.empty()) hessian_ = channel.hessians[i];
    }

    /// center, half: of the box; returns nothing if the box lies outside the support
    [[nodiscard]] std::optional<RangeOfValues> range(const Vec3& center, const Vec3& half) const {
        const Vec3 d = center - center_;
        const double at = std::sqrt(std::max(0.0, glm::dot(d, inverse_ * d))), around = std::sqrt(product(inverse_, half));
        if (at - around > 1) return std::nullopt;
        const double nearest = std::max(0.0, at - around), farthest = std::min(1.0, at + around);
        const Vec3 reach = glm::abs(d) + half;
        const auto& h = hessian_;
        const double bent =
            .5 *
                (std::abs(h[0]) * reach.x * reach.x + std::abs(h[3]) * reach.y * reach.y + std::abs(h[5]) * reach.z * reach.z) +
            std::abs(h[1]) * reach.x * reach.y + std::abs(h[2]) * reach.x * reach.z + std::abs(h[4]) * reach.y * reach.z;
        const double spread = glm::dot(glm::abs(gradient_), half) + bent, middle = value_ + glm::dot(gradient_, d);
        const double near_moment = moment_ * nearest * nearest, far_moment = moment_ * farthest * farthest;
        const double slack = 1e-5 * (std::abs(middle) + spread + std::abs(moment_));  // more than rounding
        return RangeOfValues{static_cast<float>(middle - spread + std::min(near_moment, far_moment) - slack),
                             static_cast<float>(middle + spread + std::max(near_moment, far_moment) + slack)};
    }

private:
    /// A bound of vᵀMv for the vectors v within a box about 0.
    static double product(const Mat3& m, const Vec3& half) {
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) sum += std::abs(m[a][b]) * half[a] * half[b];
        }
        return sum;
    }

    Vec3 center_;
    double value_, moment_;
    Mat3 inverse_;
    Vec3 gradient_;
    Symmetric3 hessian_{};
};

/// Boxes over the volume, half the distance of two kernels wide, each with the range of all kernels' values in it.
class RangeGrid {
public:
    RangeGrid(const RbfVolume& volume, const RbfChannel& channel) : volume_(volume), channel_(channel) {
        Box box;
        for (const Vec3& x : volume.centers) box.add(x);
        for (const Vec3& x : volume.boundary.points) box.add(x);
        const Vec3 size = box.size();
        const double spacing = std::cbrt(std::max({size.x * size.y * size.z, 1e-300}) / static_cast<double>(volume.size()));
        const double longest = std::max({size.x, size.y, size.z, 1e-300});
        const double edge = std::max(.5 * spacing, longest / kMostBoxes);
        lower_ = box.lower;
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = static_cast<int>(a);
            counts_[a] = std::max(1, static_cast<int>(std::ceil(size[axis] / edge)));
        }
        edge_ = edge;
        ranges_.resize(static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
                       static_cast<std::size_t>(counts_[2]));
        parallel_each(volume.size(), [&](std::size_t i) { each_box(i, widen); });
    }

    /// The range of the field in the support of a kernel.
    [[nodiscard]] RangeOfValues about(std::size_t i) {
        RangeOfValues range;
        each_box(i, [&](const RangeOfValues& box, const RangeOfValues&) { range.add(box); });
        return range;
    }

private:
    static constexpr double kMostBoxes = 512;  // along an axis

    /// The least and the largest do not depend on the order of the threads.
    static void widen(RangeOfValues& box, const RangeOfValues& range) {
        const std::atomic_ref low(box.low), high(box.high);
        for (float now = low.load(); range.low < now && !low.compare_exchange_weak(now, range.low);) {
        }
        for (float now = high.load(); range.high > now && !high.compare_exchange_weak(now, range.high);) {
        }
    }

    /// Calls visit(box, range of the kernel in it) for the boxes that the support of a kernel meets.
    template <class Visit>
    void each_box(std::size_t i, const Visit& visit) {
        constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
        const KernelInBox kernel(volume_, channel_, i);
        std::array<std::array<int, 2>, 3> span{};
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = static_cast<int>(a);
            const double at = volume_.centers[i][axis] - lower_[axis], half = std::sqrt(volume_.frames[i][kDiagonal[a]]);
            const auto box = [&](double x) {
                return static_cast<int>(std::clamp(std::floor(x / edge_), 0.0, counts_[a] - 1.0));
            };
            span[a] = {box(at - half), box(at + half)};
        }
        for (int z = span[2][0]; z <= span[2][1]; ++z) {
            for (int y = span[1][0]; y <= span[1][1]; ++y) {
                for (int x = span[0][0]; x <= span[0][1]; ++x) {
                    const Vec3 center = lower_ + edge_ * Vec3(x + .5, y + .5, z + .5);
                    if (const auto range = kernel.range(center, Vec3(.5 * edge_))) visit(ranges_[place(x, y, z)], *range);
                }
            }
        }
    }

    [[nodiscard]] std::size_t place(int x, int y, int z) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(counts_[0]) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(counts_[1]) * static_cast<std::size_t>(z));
    }

    const RbfVolume& volume_;
    const RbfChannel& channel_;
    Vec3 lower_{0.0};
    double edge_ = 0;
    std::array<int, 3> counts_{};
    std::vector<RangeOfValues> ranges_;
};

bool is_visible(const TransferFunction& function, const RangeOfValues& range) {
    const auto& knots = function.opacity;
    if (alpha_at(function, range.low) > 0 || alpha_at(function, range.high) > 0) return true;
    return std::any_of(knots.begin(), knots.end(),
                       [&](const auto& k) { return k.alpha > 0 && k.value > range.low && k.value < range.high; });
}

bool has_negative_lobes(const Kernel& kernel) {
    return !(std::holds_alternative<CompactKernel>(kernel) || std::holds_alternative<GaussianKernel>(kernel) ||
             std::holds_alternative<WendlandC2Kernel>(kernel) || std::holds_alternative<WendlandC4Kernel>(kernel));
}

}  // namespace

VisibleVolume drop_invisible(const RbfVolume& volume, std::size_t channel, const TransferFunction& function) {
    validate(function);
    if (channel >= volume.channels.size()) {
        throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(channel), {},
                    "the points have " + std::to_string(volume.channels.size()));
    }
    if (has_negative_lobes(volume.kernel)) {
        throw Error(ErrorCode::InvalidInput, "points whose kernel has negative lobes cannot be dropped", {},
                    "a compact, Gaussian or Wendland kernel");
    }
    VisibleVolume result{volume, 0};
    if (volume.size() == 0) return result;
    RangeGrid grid(volume, volume.channels[channel]);
    std::vector<std::uint8_t> visible(volume.size());
    parallel_each(volume.size(), [&](std::size_t i) { visible[i] = is_visible(function, grid.about(i)); });
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        if (visible[i]) kept.push_back(i);
    }
    result.dropped = volume.size() - kept.size();
    detail::keep_kernels(result.volume, kept);
    return result;
}

TransferFunction opaque_above(double value) {
    const double next = std::nextafter(value, std::numeric_limits<double>::infinity());
    return {.color = {{value, Vec3(1.0)}}, .opacity = {{value, 0}, {next, 1}}};
}

}  // namespace subvol
