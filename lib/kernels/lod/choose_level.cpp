// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "node_test.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/kernel_hierarchy.h"

namespace subvol {

namespace {

constexpr int kSerialDepth = 8;  // subtrees below it are cut in parallel

class Cutter {
public:
    Cutter(const KernelHierarchy& hierarchy, const detail::NodeTest& test) : h_(hierarchy), test_(test) {}

    [[nodiscard]] KernelCut cut() {
        KernelCut whole;
        if (h_.nodes.size() == 0) return whole;
        descend(0, 0);
        std::vector<KernelCut> cuts(open_.size());
        tbb::parallel_for(std::size_t{0}, open_.size(), [&](std::size_t k) { collect(open_[k], cuts[k]); });
        std::vector<char> kept(h_.order.size());
        for (const KernelCut& part : cuts) {
            whole.nodes.insert(whole.nodes.end(), part.nodes.begin(), part.nodes.end());
            for (const Index kernel : part.kernels) kept[kernel] = 1;
            whole.error = std::max(whole.error, part.error);
        }
        for (Index i = 0; i < kept.size(); ++i) {
            if (kept[i] != 0) whole.kernels.push_back(i);
        }
        return whole;
    }

private:
    /// Lists the subtrees that are cut in parallel.
    void descend(std::size_t node, int depth) {
        if (depth == kSerialDepth || h_.is_last(node) || takes(node)) {
            open_.push_back(node);
            return;
        }
        descend(2 * node + 1, depth + 1);
        descend(2 * node + 2, depth + 1);
    }

    void collect(std::size_t node, KernelCut& part) const {
        if (takes(node)) {
            part.nodes.push_back(static_cast<Index>(node));
            part.error = std::max(part.error, double(h_.errors[test_.channel()][node]));
        } else if (h_.is_last(node)) {
            const auto [first, last] = h_.slots(node);
            for (std::size_t slot = first; slot < last; ++slot) part.kernels.push_back(h_.order[slot]);
        } else {
            collect(2 * node + 1, part);
            collect(2 * node + 2, part);
        }
    }

    [[nodiscard]] bool takes(std::size_t node) const {
        return test_.takes(h_.nodes.centers[node], h_.widths[node], h_.errors[test_.channel()][node]);
    }

    const KernelHierarchy& h_;
    const detail::NodeTest& test_;
    std::vector<std::size_t> open_;
};

/// The chosen entries of one list, then those of another; none if there are none, as of Hessians.
template <class T>
std::vector<T> gathered(const std::vector<T>& kernels, const std::vector<T>& nodes, const KernelCut& cut) {
    std::vector<T> result;
    if (kernels.empty()) return result;
    result.resize(cut.size());
    detail::parallel_each(cut.kernels.size(), [&](std::size_t k) { result[k] = kernels[cut.kernels[k]]; });
    detail::parallel_each(cut.nodes.size(), [&](std::size_t k) { result[cut.kernels.size() + k] = nodes[cut.nodes[k]]; });
    return result;
}

KernelCut cut_of(const KernelHierarchy& hierarchy, const View* view, const LevelOptions& options) {
    const detail::NodeTest test(view, options, hierarchy.order.size(), hierarchy.errors.size());
    return Cutter(hierarchy, test).cut();
}

}  // namespace

detail::NodeTest::NodeTest(const View* view, const LevelOptions& options, std::size_t kernels, std::size_t channels)
    : view_(view), options_(options), single_(kernels == 1) {
    if (!(options.pixels >= 0 && std::isfinite(options.pixels))) {
        throw Error(ErrorCode::InvalidInput, "the width of kernels is " + detail::number_text(options.pixels) + " pixels", {},
                    "0 or more");
    }
    if (!(options.error >= 0)) {
        throw Error(ErrorCode::InvalidInput, "the error is " + detail::number_text(options.error), {}, "0 or more");
    }
    if (options.channel >= channels) {
        throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(options.channel), {},
                    "the hierarchy has " + std::to_string(channels));
    }
    if (view == nullptr || !view->perspective()) return;
    const Vec2 corner = view->slopes(0, 0);
    widest_ = std::sqrt(1 + glm::dot(corner, corner));
}

KernelCut choose_cut(const KernelHierarchy& hierarchy, const View& view, const LevelOptions& options) {
    return cut_of(hierarchy, &view, options);
}

KernelCut choose_cut(const KernelHierarchy& hierarchy, double error, std::size_t channel) {
    return cut_of(hierarchy, nullptr, {.error = error, .channel = channel});
}

KernelCut level_cut(const KernelHierarchy& hierarchy, std::size_t most) {
    KernelCut cut;
    const std::size_t nodes = hierarchy.nodes.size();  // 2ⁿ − 1
    if (nodes == 0) return cut;
    std::size_t first = nodes / 2;
    while (first + 1 > most && first > 0) first /= 2;
    cut.nodes.resize(first + 1);
    std::iota(cut.nodes.begin(), cut.nodes.end(), static_cast<Index>(first));
    for (const Index node : cut.nodes)
        for (const std::vector<float>& errors : hierarchy.errors) cut.error = std::max(cut.error, double(errors[node]));
    return cut;
}

RbfVolume kernels_of_cut(const KernelHierarchy& hierarchy, const RbfVolume& volume, const KernelCut& cut) {
    const RbfVolume& nodes = hierarchy.nodes;
    if (volume.size() != hierarchy.order.size() || volume.channels.size() != nodes.channels.size()) {
        throw Error(ErrorCode::InvalidInput, "the hierarchy was made of other kernels", {}, "the volume that it was built of");
    }
    if (cut.nodes.empty()) return volume;
    RbfVolume result;
    result.kernel = volume.kernel;
    result.boundary = volume.boundary;
    result.bounds = volume.bounds;
    result.centers = gathered(volume.centers, nodes.centers, cut);
    result.frames = gathered(volume.frames, nodes.frames, cut);
    for (std::size_t c = 0; c < volume.channels.size(); ++c) {
        const RbfChannel &kernel = volume.channels[c], &node = nodes.channels[c];
        result.channels.push_back({.name = kernel.name,
                                   .values = gathered(kernel.values, node.values, cut),
                                   .gradients = gathered(kernel.gradients, node.gradients, cut),
                                   .moments = gathered(kernel.moments, node.moments, cut),
                                   .hessians = gathered(kernel.hessians, node.hessians, cut)});
    }
    return result;
}

RbfVolume choose_level(const KernelHierarchy& hierarchy, const RbfVolume& volume, const View& view,
                       const LevelOptions& options) {
    return kernels_of_cut(hierarchy, volume, choose_cut(hierarchy, view, options));
}

}  // namespace subvol
