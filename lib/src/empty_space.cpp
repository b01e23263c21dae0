#include "subvol/empty_space.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "bucket_sort.h"
#include "subvol/error.h"

namespace subvol {

namespace {

using detail::parallel_each;

struct ValueRange {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();

    void add(const ValueRange& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
};

/// All that a kernel can stand for within its support, outwards by more than rounding.
ValueRange corrected_range(const RbfVolume& volume, const RbfChannel& channel, std::size_t i) {
    const auto& s = volume.frames[i];
    const auto& g = channel.gradients[i];
    const double x = g[0], y = g[1], z = g[2];
    const double reach2 = x * x * s[0] + y * y * s[3] + z * z * s[5] + 2 * (x * y * s[1] + x * z * s[2] + y * z * s[4]);
    const double reach = std::sqrt(std::max(reach2, 0.0)), moment = channel.moments[i], value = channel.values[i];
    const double slack = 1e-5 * (std::abs(value) + reach + std::abs(moment));
    return {static_cast<float>(value - reach + std::min(moment, 0.0) - slack),
            static_cast<float>(value + reach + std::max(moment, 0.0) + slack)};
}

/// Boxes over the volume, each with the range of all kernels that reach into it.
class RangeGrid {
public:
    RangeGrid(const RbfVolume& volume, const RbfChannel& channel) : volume_(volume), box_(bounds()) {
        const Vec3 size = box_.size();
        const double wanted = std::cbrt(size.x * size.y * size.z / static_cast<double>(volume.size()));
        const double edge = std::max({wanted, size.x / kMostBoxes, size.y / kMostBoxes, size.z / kMostBoxes});
        for (int a = 0; a < 3; ++a) {
            counts_[static_cast<std::size_t>(a)] = std::max(1, static_cast<int>(std::ceil(size[a] / edge)));
            scale_[a] = size[a] > 0 ? counts_[static_cast<std::size_t>(a)] / size[a] : 0;
        }
        ranges_.resize(static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
                       static_cast<std::size_t>(counts_[2]));
        parallel_each(volume.size(), [&](std::size_t i) {
            const ValueRange range = corrected_range(volume, channel, i);
            each_box(i, [&](ValueRange& box) { widen(box, range); });
        });
    }

    [[nodiscard]] ValueRange about(std::size_t i) {
        ValueRange range;
        each_box(i, [&](const ValueRange& box) { range.add(box); });
        return range;
    }

private:
    static constexpr double kMostBoxes = 256;  // along an axis

    [[nodiscard]] Box bounds() const {
        Box box;
        for (const Vec3& x : volume_.centers) box.add(x);
        return box;
    }

    /// The least and the largest do not depend on the order in which threads come.
    static void widen(ValueRange& box, const ValueRange& range) {
        const std::atomic_ref low(box.low), high(box.high);
        for (float now = low.load(); range.low < now && !low.compare_exchange_weak(now, range.low);) {
        }
        for (float now = high.load(); range.high > now && !high.compare_exchange_weak(now, range.high);) {
        }
    }

    template <class Visit>
    void each_box(std::size_t i, const Visit& visit) {
        constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
        std::array<std::array<int, 2>, 3> span{};
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = static_cast<int>(a);
            const double at = volume_.centers[i][axis] - box_.lower[axis];
            const double half = std::sqrt(std::max(0.0f, volume_.frames[i][kDiagonal[a]])) * (1 + 1e-6);
            const auto box = [&](double x) {
                return static_cast<int>(std::clamp(std::floor(x * scale_[axis]), 0.0, counts_[a] - 1.0));
            };
            span[a] = {box(at - half), box(at + half)};
        }
        for (int z = span[2][0]; z <= span[2][1]; ++z) {
            for (int y = span[1][0]; y <= span[1][1]; ++y) {
                for (int x = span[0][0]; x <= span[0][1]; ++x) {
                    visit(ranges_[static_cast<std::size_t>(x) +
                                  static_cast<std::size_t>(counts_[0]) *
                                      (static_cast<std::size_t>(y) +
                                       static_cast<std::size_t>(counts_[1]) * static_cast<std::size_t>(z))]);
                }
            }
        }
    }

    const RbfVolume& volume_;
    Box box_;
    std::array<int, 3> counts_{};
    Vec3 scale_{0.0};
    std::vector<ValueRange> ranges_;
};

bool is_visible(const TransferFunction& function, const ValueRange& range) {
    const auto& knots = function.opacity;
    const auto alpha_at = [&](double value) {
        if (value <= knots.front().value) return knots.front().alpha;
        if (value >= knots.back().value) return knots.back().alpha;
        const auto above_it =
            std::upper_bound(knots.begin(), knots.end(), value, [](double v, const auto& k) { return v < k.value; });
        const auto& a = *(above_it - 1);
        return a.alpha + (value - a.value) / (above_it->value - a.value) * (above_it->alpha - a.alpha);
    };
    if (alpha_at(range.low) > 0 || alpha_at(range.high) > 0) return true;
    return std::any_of(knots.begin(), knots.end(),
                       [&](const auto& k) { return k.alpha > 0 && k.value > range.low && k.value < range.high; });
}

template <class T>
void keep(std::vector<T>& values, const std::vector<std::size_t>& kept) {
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
    values.resize(kept.size());
    values.shrink_to_fit();
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
    keep(result.volume.centers, kept);
    keep(result.volume.frames, kept);
    for (RbfChannel& c : result.volume.channels) {
        keep(c.values, kept);
        keep(c.gradients, kept);
        keep(c.moments, kept);
    }
    return result;
}

TransferFunction above(double value) {
    const double next = std::nextafter(value, std::numeric_limits<double>::infinity());
    return {.color = {{value, Vec3(1.0)}}, .opacity = {{value, 0}, {next, 1}}};
}

}  // namespace subvol
