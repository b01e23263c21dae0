// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "merge_kernels.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/principal_axes.h"
#include "subvol/error.h"

namespace subvol {

namespace {

constexpr std::size_t kLeafSize = 8;

float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

class Builder {
public:
    Builder(const RbfVolume& volume, Progress* progress) : volume_(volume), progress_(progress) {
        radius_ = support_radius(volume.kernel);
    }

    [[nodiscard]] KernelHierarchy build() {
        std::size_t leaves = 1;
        while (leaves * kLeafSize < volume_.size()) leaves *= 2;
        report_progress(progress_, "sort kernels", 0);
        h_.order = detail::median_order(volume_.centers, leaves);
        allocate(volume_.size() == 0 ? 0 : 2 * leaves - 1);
        constexpr std::size_t kTurn = 1 << 14;  // leaves between two reports of progress
        for (std::size_t first = 0; first < leaves && volume_.size() > 0; first += kTurn) {
            report_progress(progress_, "merge kernels", 0.5 * static_cast<double>(first) / static_cast<double>(leaves));
            const std::size_t count = std::min(kTurn, leaves - first);
            detail::parallel_each(count, [&](std::size_t leaf) { merge_kernels(leaves - 1 + first + leaf); });
        }
        for (std::size_t width = leaves / 2; width > 0; width /= 2) {
            report_progress(progress_, "merge kernels", 1 - static_cast<double>(width) / static_cast<double>(leaves));
            detail::parallel_each(width, [&](std::size_t k) { merge_nodes(width - 1 + k); });
        }
        report_progress(progress_, "merge kernels", 1);
        return std::move(h_);
    }

private:
    void allocate(std::size_t nodes) {
        h_.nodes.kernel = volume_.kernel;
        h_.nodes.bounds = volume_.bounds;
        h_.nodes.centers.resize(nodes);
        h_.nodes.frames.resize(nodes);
        h_.masses.resize(nodes);
        h_.covariances.resize(nodes);
        h_.boxes.resize(nodes);
        h_.widths.resize(nodes);
        for (const RbfChannel& channel : volume_.channels) {
            RbfChannel& to = h_.nodes.channels.emplace_back();
            to.name = channel.name;
            to.values.resize(nodes);
            to.gradients.resize(nodes);
            to.moments.resize(nodes);
            if (!channel.hessians.empty()) to.hessians.resize(nodes);
            h_.errors.emplace_back(nodes);
        }
    }

    /// What a node is made of: kernels of the volume, or nodes.
    struct Part {
        const RbfVolume* of;
        std::size_t number;
        detail::Moments moments;
        Box box;
        float width;
    };

    [[nodiscard]] Part kernel_part(std::size_t i) const {
        const Vec3& x = volume_.centers[i];
        return {&volume_, i, detail::moments_of(x, volume_.frames[i], radius_), {x, x}, 0};
    }

    [[nodiscard]] Part node_part(std::size_t n) const {
        return {&h_.nodes, n, {h_.masses[n], h_.nodes.centers[n], matrix(h_.covariances[n])}, h_.boxes[n], h_.widths[n]};
    }

    void merge_kernels(std::size_t node) {
        const auto [first, last] = h_.slots(node);
        std::array<Part, kLeafSize> parts;
        for (std::size_t slot = first; slot < last; ++slot) parts[slot - first] = kernel_part(h_.order[slot]);
        merge(std::span(parts).first(last - first), node);
    }

    void merge_nodes(std::size_t node) {
        const std::array parts{node_part(2 * node + 1), node_part(2 * node + 2)};
        merge(parts, node);
    }

    void merge(std::span<const Part> parts, std::size_t node) {
        std::array<detail::Moments, kLeafSize> moments;
        for (std::size_t i = 0; i < parts.size(); ++i) moments[i] = parts[i].moments;
        const detail::Moments whole = detail::merged(std::span(moments).first(parts.size()));
        h_.masses[node] = whole.mass;
        h_.nodes.centers[node] = whole.center;
        h_.covariances[node] = symmetric3(whole.covariance);
        h_.nodes.frames[node] = detail::frame_of(whole);
        h_.widths[node] = rounded_up(2 * detail::principal_axes(h_.nodes.frames[node]).half_axes[0]);
        for (const Part& part : parts) {
            h_.boxes[node].add(part.box);
            h_.widths[node] = std::max(h_.widths[node], part.width);
        }
        for (std::size_t c = 0; c < h_.errors.size(); ++c) merge_channel(parts, moments, whole, c, node);
    }

    void merge_channel(std::span<const Part> parts, std::span<const detail::Moments> moments, const detail::Moments& whole,
                       std::size_t c, std::size_t node) {
        std::array<detail::Quadratic, kLeafSize> quadratics;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            quadratics[i] = detail::quadratic_of(*parts[i].of, parts[i].of->channels[c], parts[i].number);
        }
        RbfChannel& channel = h_.nodes.channels[c];
        const bool full = !channel.hessians.empty();
        detail::store(detail::merged(moments.first(parts.size()), std::span(quadratics).first(parts.size()), whole, full),
                      h_.nodes, channel, node);
        const detail::Quadratic stored = detail::quadratic_of(h_.nodes, channel, node);
        double error = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const double below = parts[i].of == &h_.nodes ? double(h_.errors[c][parts[i].number]) : 0;
            const double own = detail::largest_difference(stored, whole.center, quadratics[i], moments[i].center, parts[i].box);
            error = std::max(error, below + own);
        }
        h_.errors[c][node] = rounded_up(error);
    }

    const RbfVolume& volume_;
    Progress* progress_;
    double radius_;
    KernelHierarchy h_;
};

}  // namespace

std::pair<std::size_t, std::size_t> KernelHierarchy::slots(std::size_t node) const {
    const std::size_t leaves = (nodes.size() + 1) / 2;
    std::size_t first = node, last = node;
    while (!is_last(first)) {
        first = 2 * first + 1;
        last = 2 * last + 2;
    }
    const std::size_t from = first - (leaves - 1), to = last - (leaves - 1) + 1;
    return {from * order.size() / leaves, to * order.size() / leaves};
}

KernelHierarchy build_kernel_hierarchy(const RbfVolume& volume, Progress* progress) {
    validate(volume);
    if (volume.size() >= kNone) {
        throw Error(ErrorCode::InvalidInput, std::to_string(volume.size()) + " kernels are too many", {}, "fewer than 2³²");
    }
    return Builder(volume, progress).build();
}

}  // namespace subvol
