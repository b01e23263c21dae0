// SPDX-License-Identifier: Apache-2.0
#include "node_merger.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "merge_kernels.h"
#include "subvol/detail/principal_axes.h"

namespace subvol::detail {

/// What a node is made of: kernels of the volume, or nodes.
///
/// errors: of the nodes; null: a kernel
struct NodeMerger::Part {
    const RbfVolume* volume;
    std::size_t number;
    Moments moments;
    Box box;
    float width;
    const std::vector<std::vector<float>>* errors;
};

namespace {

float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

NodeMerger::NodeMerger(const RbfVolume& volume) : volume_(volume), radius_(support_radius(volume.kernel)) {
}

void NodeMerger::allocate(KernelHierarchy& tree, std::size_t nodes) const {
    tree.nodes.kernel = volume_.kernel;
    tree.nodes.bounds = volume_.bounds;
    tree.nodes.centers.resize(nodes);
    tree.nodes.frames.resize(nodes);
    tree.masses.resize(nodes);
    tree.covariances.resize(nodes);
    tree.boxes.resize(nodes);
    tree.widths.resize(nodes);
    for (const RbfChannel& channel : volume_.channels) {
        RbfChannel& to = tree.nodes.channels.emplace_back();
        to.name = channel.name;
        to.values.resize(nodes);
        to.gradients.resize(nodes);
        to.moments.resize(nodes);
        if (!channel.hessians.empty()) to.hessians.resize(nodes);
        tree.errors.emplace_back(nodes);
    }
}

NodeMerger::Part NodeMerger::kernel_part(std::size_t i) const {
    const Vec3& x = volume_.centers[i];
    return {&volume_, i, moments_of(x, volume_.frames[i], radius_), {x, x}, 0, nullptr};
}

void NodeMerger::merge_kernels(KernelHierarchy& tree, std::size_t node, std::span<const Index> kernels) const {
    std::array<Part, kLeafSize> parts;
    for (std::size_t k = 0; k < kernels.size(); ++k) parts[k] = kernel_part(kernels[k]);
    merge(std::span(parts).first(kernels.size()), tree, node);
}

void NodeMerger::merge_nodes(KernelHierarchy& tree, std::size_t node) const {
    const auto part = [&](std::size_t n) {
        const Moments moments{tree.masses[n], tree.nodes.centers[n], matrix(tree.covariances[n])};
        return Part{&tree.nodes, n, moments, tree.boxes[n], tree.widths[n], &tree.errors};
    };
    const std::array parts{part(2 * node + 1), part(2 * node + 2)};
    merge(parts, tree, node);
}

void NodeMerger::merge(std::span<const Part> parts, KernelHierarchy& tree, std::size_t node) {
    std::array<Moments, kLeafSize> of_parts;
    for (std::size_t i = 0; i < parts.size(); ++i) of_parts[i] = parts[i].moments;
    const auto moments = std::span<const Moments>(of_parts).first(parts.size());
    const Moments whole = merged(moments);
    tree.masses[node] = whole.mass;
    tree.nodes.centers[node] = whole.center;
    tree.covariances[node] = symmetric3(whole.covariance);
    tree.nodes.frames[node] = frame_of(whole);
    tree.widths[node] = rounded_up(2 * principal_axes(tree.nodes.frames[node]).half_axes[0]);
    for (const Part& part : parts) {
        tree.boxes[node].add(part.box);
        tree.widths[node] = std::max(tree.widths[node], part.width);
    }
    for (std::size_t c = 0; c < tree.errors.size(); ++c) {
        std::array<Quadratic, kLeafSize> of_channel;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            of_channel[i] = quadratic_of(*parts[i].volume, parts[i].volume->channels[c], parts[i].number);
        }
        const auto quadratics = std::span<const Quadratic>(of_channel).first(parts.size());
        RbfChannel& channel = tree.nodes.channels[c];
        store(merged(moments, quadratics, whole, !channel.hessians.empty()), tree.nodes, channel, node);
        const Quadratic stored = quadratic_of(tree.nodes, channel, node);
        double error = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const double below = parts[i].errors == nullptr ? 0 : double((*parts[i].errors)[c][parts[i].number]);
            const double own = largest_difference(stored, whole.center, quadratics[i], moments[i].center, parts[i].box);
            error = std::max(error, below + own);
        }
        tree.errors[c][node] = rounded_up(error);
    }
}

void copy_node(const KernelHierarchy& from, std::size_t i, KernelHierarchy& to, std::size_t j) {
    to.nodes.centers[j] = from.nodes.centers[i];
    to.nodes.frames[j] = from.nodes.frames[i];
    to.masses[j] = from.masses[i];
    to.covariances[j] = from.covariances[i];
    to.boxes[j] = from.boxes[i];
    to.widths[j] = from.widths[i];
    for (std::size_t c = 0; c < to.errors.size(); ++c) {
        to.errors[c][j] = from.errors[c][i];
        const RbfChannel& a = from.nodes.channels[c];
        RbfChannel& b = to.nodes.channels[c];
        b.values[j] = a.values[i];
        b.gradients[j] = a.gradients[i];
        b.moments[j] = a.moments[i];
        if (!b.hessians.empty()) b.hessians[j] = a.hessians[i];
    }
}

}  // namespace subvol::detail
