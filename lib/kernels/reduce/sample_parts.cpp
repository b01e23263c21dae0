// SPDX-License-Identifier: Apache-2.0
#include "sample_parts.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel_tree.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/space_order.h"

namespace subvol::detail {
namespace {

constexpr std::size_t kLeastSamples = 12;  // of a half: two a direction, so that its frame has three dimensions
constexpr double kThin = 1e-6;             // of the largest variance: slopes along thinner directions are not fitted

/// Normals of planes that may halve a part: its principal axes, the world's axes, and the field's slope.
std::array<Vec3, 7> candidates(const LinearFit& fit) {
    Eigen::Matrix3d c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) c(i, j) = fit.covariance[i][j];
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(c);
    std::array<Vec3, 7> result{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (int k = 0; k < 3; ++k) {
        const auto v = axes.eigenvectors().col(2 - k);
        result[static_cast<std::size_t>(3 + k)] = {v[0], v[1], v[2]};
    }
    const double steep = glm::length(fit.slope);
    result[6] = steep > 0 ? fit.slope / steep : Vec3(1, 0, 0);
    return result;
}

}  // namespace

void LinearSums::add(double weight, const Vec3& d, double value) {
    const Vec3 wd = weight * d;
    w += weight;
    f += weight * value;
    ff += weight * value * value;
    x += wd;
    fx += value * wd;
    xx += glm::outerProduct(wd, d);
}

LinearSums LinearSums::operator-(const LinearSums& other) const {
    return {w - other.w, f - other.f, ff - other.ff, x - other.x, fx - other.fx, xx - other.xx};
}

LinearFit fit_linear(const LinearSums& s) {
    LinearFit fit;
    if (!(s.w > 0)) return fit;
    fit.mean = s.x / s.w;
    fit.value = s.f / s.w;
    fit.covariance = s.xx / s.w - glm::outerProduct(fit.mean, fit.mean);
    const Vec3 mixed = s.fx / s.w - fit.value * fit.mean;
    const double largest = std::max({fit.covariance[0][0], fit.covariance[1][1], fit.covariance[2][2]});
    if (largest > 0) fit.slope = glm::inverse(fit.covariance + Mat3(kThin * largest)) * mixed;
    const double explained = glm::dot(fit.slope, 2.0 * mixed - fit.covariance * fit.slope);
    fit.error = std::max(0.0, s.ff - s.w * (fit.value * fit.value + explained));
    return fit;
}

SampleParts::SampleParts(const FieldSamples& samples) : samples_(samples), order_(space_order(samples.points)) {
    parts_.emplace_back().end = order_.size();
    analyse(parts_[0]);
}

void SampleParts::analyse(SamplePart& part) const {
    // Sums are relative to a sample, to avoid cancellation far from the origin.
    const Vec3 origin = samples_.points[order_[part.begin]];
    const auto each = [&](const auto& visit) {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const Index i = order_[k];
            visit(samples_.weights[i], samples_.points[i] - origin, samples_.values[i]);
        }
    };
    LinearSums all;
    each([&](double w, const Vec3& d, double f) { all.add(w, d, f); });
    part.fit = fit_linear(all);
    part.gain = -1;
    if (part.end - part.begin >= 2 * kLeastSamples) {
        const auto normals = candidates(part.fit);
        std::array<LinearSums, 7> below;
        std::array<std::size_t, 7> count{};
        each([&](double w, const Vec3& d, double f) {
            for (std::size_t k = 0; k < normals.size(); ++k) {
                if (glm::dot(normals[k], d - part.fit.mean) >= 0) continue;
                below[k].add(w, d, f);
                ++count[k];
            }
        });
        for (std::size_t k = 0; k < normals.size(); ++k) {
            if (count[k] < kLeastSamples || part.end - part.begin - count[k] < kLeastSamples) continue;
            const double gain = part.fit.error - fit_linear(below[k]).error - fit_linear(all - below[k]).error;
            if (gain <= part.gain) continue;
            part.gain = gain;
            part.normal = normals[k];
        }
    }
    // A sample represents the space around it: a single layer of samples has a thickness.
    const double spacing = std::cbrt(all.w / static_cast<double>(part.end - part.begin));
    part.fit.covariance += Mat3(spacing * spacing / 12);
    part.fit.mean += origin;
}

std::size_t SampleParts::partition(const SamplePart& part) {
    const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
    const Vec3 origin = samples_.points[order_[part.begin]], mean = part.fit.mean - origin;
    const auto middle = std::stable_partition(
        at(part.begin), at(part.end), [&](Index i) { return glm::dot(part.normal, samples_.points[i] - origin - mean) < 0; });
    return static_cast<std::size_t>(middle - order_.begin());
}

void SampleParts::split(const std::vector<std::size_t>& numbers) {
    const std::size_t first = parts_.size();
    parts_.resize(first + numbers.size());
    tbb::parallel_for(std::size_t{0}, numbers.size(), [&](std::size_t k) {
        SamplePart &low = parts_[numbers[k]], &high = parts_[first + k];
        const std::size_t middle = partition(low);
        high.begin = middle;
        high.end = low.end;
        low.end = middle;
        analyse(low);
        analyse(high);
    });
}

SampleGroups group_by_kernel(const RbfVolume& volume, const FieldSamples& samples) {
    const KernelTree tree(volume.centers, volume.frames);
    std::vector<std::size_t> owner(samples.size(), volume.size());
    parallel_each(samples.size(), [&](std::size_t i) {
        double nearest = 1;
        tree.visit_at(samples.points[i], [&](std::size_t slot, const Vec3&, const Vec3&, double e) {
            if (e >= nearest) return;
            nearest = e;
            owner[i] = tree.kernel(slot);
        });
    });
    SampleGroups groups{.order = std::vector<Index>(samples.size()), .starts = std::vector<std::size_t>(volume.size() + 2)};
    for (const std::size_t kernel : owner) ++groups.starts[kernel + 1];
    for (std::size_t k = 0; k <= volume.size(); ++k) groups.starts[k + 1] += groups.starts[k];
    auto next = groups.starts;
    for (const Index i : space_order(samples.points)) groups.order[next[owner[i]]++] = i;
    return groups;
}

ThinSamples thin_samples(const FieldSamples& samples, std::span<const Index> order, std::span<const std::size_t> starts,
                         std::size_t most) {
    const std::size_t groups = starts.size() - 1;
    ThinSamples result;
    result.starts.assign(groups + 1, 0);
    for (std::size_t g = 0; g < groups; ++g)
        result.starts[g + 1] = result.starts[g] + std::min(starts[g + 1] - starts[g], most);
    auto& points = result.samples.points;
    auto &values = result.samples.values, &weights = result.samples.weights;
    points.resize(result.starts.back());
    values.resize(points.size());
    weights.resize(points.size());
    parallel_each(groups, [&](std::size_t g) {
        const std::size_t all = starts[g + 1] - starts[g], first = result.starts[g], count = result.starts[g + 1] - first;
        double whole = 0, chosen = 0;
        for (std::size_t k = 0; k < all; ++k) whole += samples.weights[order[starts[g] + k]];
        for (std::size_t k = 0; k < count; ++k) {
            const Index i = order[starts[g] + k * all / count];
            points[first + k] = samples.points[i];
            values[first + k] = samples.values[i];
            chosen += weights[first + k] = samples.weights[i];
        }
        for (std::size_t k = 0; k < count; ++k) weights[first + k] *= chosen > 0 ? whole / chosen : 1;
    });
    return result;
}

}  // namespace subvol::detail
