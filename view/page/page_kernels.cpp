// SPDX-License-Identifier: Apache-2.0
#include "page_kernels.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "subvol/detail/principal_axes.h"

namespace subvol::detail {

namespace {

/// S^(1/2), symmetric; a flat frame gets a little thickness, so that it has an inverse.
Mat3 symmetric_root(const Symmetric3& frame) {
    constexpr double kThinnest = 1e-4;
    const PrincipalAxes axes = principal_axes(frame);
    Mat3 root(0.0);
    for (int a = 0; a < 3; ++a) {
        const double half = std::max(axes.half_axes[a], kThinnest * axes.half_axes[0]);
        root += half * glm::outerProduct(axes.directions[a], axes.directions[a]);
    }
    return root;
}

}  // namespace

std::vector<double> place_numbers(const RbfVolume& volume) {
    std::vector<double> numbers(kPlaceNumbers * volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(), [&](std::size_t i) {
        const Vec3& x = volume.centers[i];
        const Mat3 r = symmetric_root(volume.frames[i]);
        const double trace = r[0][0] + r[1][1] + r[2][2];
        const double all[kPlaceNumbers]{x.x,
                                        x.y,
                                        x.z,
                                        std::log2(trace),
                                        r[0][0] / trace,
                                        r[1][0] / trace,
                                        r[2][0] / trace,
                                        r[1][1] / trace,
                                        r[2][1] / trace,
                                        r[2][2] / trace};
        std::copy(std::begin(all), std::end(all), numbers.data() + kPlaceNumbers * i);
    });
    return numbers;
}

std::vector<double> value_numbers(const RbfVolume& volume, const RbfChannel& channel) {
    std::vector<double> numbers(kValueNumbers * volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(), [&](std::size_t i) {
        const auto& g = channel.gradients[i];
        const Vec3 change = symmetric_root(volume.frames[i]) * Vec3(g[0], g[1], g[2]);
        double* to = numbers.data() + kValueNumbers * i;
        to[0] = static_cast<double>(channel.values[i]);
        for (int a = 0; a < 3; ++a) to[1 + a] = change[a];
        to[4] = static_cast<double>(channel.moments[i]);
    });
    return numbers;
}

RbfVolume kernels_of_numbers(std::span<const double> places, std::span<const double> values, const Kernel& kernel) {
    const std::size_t count = places.size() / kPlaceNumbers;
    RbfVolume volume{.centers = std::vector<Vec3>(count),
                     .frames = std::vector<Symmetric3>(count),
                     .channels = {{.name = "value",
                                   .values = std::vector<float>(count),
                                   .gradients = std::vector<std::array<float, 3>>(count),
                                   .moments = std::vector<float>(count)}},
                     .kernel = kernel,
                     .boundary = {},
                     .bounds = {}};
    RbfChannel& channel = volume.channels.front();
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const double* p = places.data() + kPlaceNumbers * i;
        const double* v = values.data() + kValueNumbers * i;
        volume.centers[i] = {p[0], p[1], p[2]};
        const Mat3 root = std::exp2(p[3]) * Mat3(Vec3(p[4], p[5], p[6]), Vec3(p[5], p[7], p[8]), Vec3(p[6], p[8], p[9]));
        volume.frames[i] = symmetric3(root * root);
        const Vec3 gradient = glm::inverse(root) * Vec3(v[1], v[2], v[3]);
        channel.values[i] = static_cast<float>(v[0]);
        for (int a = 0; a < 3; ++a) channel.gradients[i][static_cast<std::size_t>(a)] = static_cast<float>(gradient[a]);
        channel.moments[i] = static_cast<float>(v[4]);
    });
    for (const Vec3& x : volume.centers) volume.bounds.add(x);
    return volume;
}

// Fewer kernels for the same field, without solving for anything. The kernels are halved again and again, across the direction
// in which a part is longest in units of its kernels, until there are as many parts as kernels are wanted. Each part becomes
// one kernel. With d the offsets from the mean of the centres, and means over the part:
//
//     S' = mean S + 12 R² mean d dᵀ          n samples in a row, at distance h, have the variance (n² − 1) h² / 12, so R h
//                                            becomes n R h
//     g' = mean g
//     v' = mean v − ½ mean g·d               exact for a field of the second degree
//     m' = mean m + 2 R² mean g·d            as m = H : S / 6, and mean g·d = H : mean d dᵀ

namespace {

using KernelRange = std::span<std::uint32_t>;

class Merger {
public:
    Merger(const RbfVolume& from, RbfVolume& to) : from_(from), to_(to) {
        const double radius = support_radius(from.kernel);
        radius_squared_ = radius * radius;
    }

    /// Merges the part into kernels first … first + count − 1.
    void merge(KernelRange part, std::size_t first, std::size_t count) const {
        if (count == 1) {
            merge_into_one(part, first);
            return;
        }
        const int axis = long_axis(part);
        const std::size_t left = count / 2, middle = part.size() * left / count;
        std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double xa = from_.centers[a][axis], xb = from_.centers[b][axis];
                             return xa != xb ? xa < xb : a < b;
                         });
        const auto front = [&] { merge(part.first(middle), first, left); };
        const auto back = [&] { merge(part.subspan(middle), first + left, count - left); };
        if (part.size() > 4096) {
            tbb::parallel_invoke(front, back);
        } else {
            front();
            back();
        }
    }

private:
    [[nodiscard]] int long_axis(KernelRange part) const {
        constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
        Box box;
        std::array<double, 3> sizes{};
        for (const auto i : part) {
            box.add(from_.centers[i]);
            for (std::size_t a = 0; a < 3; ++a) sizes[a] += std::sqrt(static_cast<double>(from_.frames[i][kDiagonal[a]]));
        }
        int longest = 0;
        std::array<double, 3> lengths;
        for (std::size_t a = 0; a < 3; ++a) {
            lengths[a] = box.size()[static_cast<int>(a)] / sizes[a];
            if (lengths[a] > lengths[static_cast<std::size_t>(longest)]) longest = static_cast<int>(a);
        }
        return longest;
    }

    void merge_into_one(KernelRange part, std::size_t to) const {
        std::ranges::sort(part);  // sums do not depend on how the part was found
        const double share = 1 / static_cast<double>(part.size());
        Vec3 middle(0.0);
        for (const auto i : part) middle += share * from_.centers[i];
        Mat3 frame(0.0);
        for (const auto i : part) {
            const Vec3 d = from_.centers[i] - middle;
            frame += share * (matrix(from_.frames[i]) + 12 * radius_squared_ * glm::outerProduct(d, d));
        }
        to_.centers[to] = middle;
        to_.frames[to] = symmetric3(frame);
        for (std::size_t c = 0; c < from_.channels.size(); ++c) {
            const RbfChannel& channel = from_.channels[c];
            double value = 0, moment = 0, along = 0;
            Vec3 gradient(0.0);
            for (const auto i : part) {
                const auto& g = channel.gradients[i];
                gradient += share * Vec3(g[0], g[1], g[2]);
                along += share * glm::dot(Vec3(g[0], g[1], g[2]), from_.centers[i] - middle);
                value += share * static_cast<double>(channel.values[i]);
                moment += share * static_cast<double>(channel.moments[i]);
            }
            RbfChannel& merged = to_.channels[c];
            merged.values[to] = static_cast<float>(value - 0.5 * along);
            merged.moments[to] = static_cast<float>(moment + 2 * radius_squared_ * along);
            for (int a = 0; a < 3; ++a) merged.gradients[to][static_cast<std::size_t>(a)] = static_cast<float>(gradient[a]);
        }
    }

    const RbfVolume& from_;
    RbfVolume& to_;
    double radius_squared_;
};

}  // namespace

RbfVolume merged_kernels(const RbfVolume& volume, std::size_t count) {
    count = std::clamp<std::size_t>(count, 1, volume.size());
    RbfVolume merged{.centers = std::vector<Vec3>(count),
                     .frames = std::vector<Symmetric3>(count),
                     .channels = {},
                     .kernel = volume.kernel,
                     .boundary = {},
                     .bounds = volume.bounds};
    for (const RbfChannel& channel : volume.channels) {
        merged.channels.push_back({.name = channel.name,
                                   .values = std::vector<float>(count),
                                   .gradients = std::vector<std::array<float, 3>>(count),
                                   .moments = std::vector<float>(count)});
    }
    std::vector<std::uint32_t> all(volume.size());
    std::iota(all.begin(), all.end(), 0u);
    Merger(volume, merged).merge(all, 0, count);
    return merged;
}

}  // namespace subvol::detail
