// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel_hierarchy.h"

#include <algorithm>
#include <span>
#include <string>

#include "node_merger.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol {

namespace {

KernelHierarchy build(const RbfVolume& volume, Progress* progress) {
    KernelHierarchy hierarchy;
    std::size_t leaves = 1;
    while (leaves * detail::kLeafSize < volume.size()) leaves *= 2;
    report_progress(progress, "sort kernels", 0);
    hierarchy.order = detail::median_order(volume.centers, leaves);
    const detail::NodeMerger merger(volume);
    merger.allocate(hierarchy, volume.size() == 0 ? 0 : 2 * leaves - 1);
    constexpr std::size_t kLeavesOfTurn = 1 << 14;  // leaves between two reports of progress
    for (std::size_t first = 0; first < leaves && volume.size() > 0; first += kLeavesOfTurn) {
        report_progress(progress, "merge kernels", 0.5 * static_cast<double>(first) / static_cast<double>(leaves));
        const std::size_t count = std::min(kLeavesOfTurn, leaves - first);
        detail::parallel_each(count, [&](std::size_t leaf) {
            const std::size_t node = leaves - 1 + first + leaf;
            const auto [begin, end] = hierarchy.slots(node);
            merger.merge_kernels(hierarchy, node, std::span(hierarchy.order).subspan(begin, end - begin));
        });
    }
    for (std::size_t width = leaves / 2; width > 0; width /= 2) {
        report_progress(progress, "merge kernels", 1 - static_cast<double>(width) / static_cast<double>(leaves));
        detail::parallel_each(width, [&](std::size_t k) { merger.merge_nodes(hierarchy, width - 1 + k); });
    }
    report_progress(progress, "merge kernels", 1);
    return hierarchy;
}

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
    return build(volume, progress);
}

}  // namespace subvol
