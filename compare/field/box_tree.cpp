// SPDX-License-Identifier: Apache-2.0
#include "box_tree.h"

#include <tbb/parallel_invoke.h>

#include <numeric>

namespace subvol::detail {

namespace {

constexpr std::size_t kLeafBoxes = 8;
constexpr std::size_t kSerialBoxes = 4096;

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), Index{0});
    std::size_t leaves = 1;
    while (leaves * kLeafBoxes < boxes.size()) leaves *= 2;
    first_leaf_ = leaves - 1;
    nodes_.resize(2 * leaves - 1);
    sort_below(boxes, 0, leaves);
    boxes_.reserve(boxes.size());
    for (const Index item : order_) boxes_.push_back(boxes[item]);
    for (std::size_t node = nodes_.size(); node-- > 0;) {
        if (node < first_leaf_) {
            for (const std::size_t child : {2 * node + 1, 2 * node + 2}) {
                nodes_[node].add(nodes_[child].lower);
                nodes_[node].add(nodes_[child].upper);
            }
            continue;
        }
        for (std::size_t slot = first_slot(node - first_leaf_); slot < first_slot(node - first_leaf_ + 1); ++slot) {
            nodes_[node].add(boxes_[slot].lower);
            nodes_[node].add(boxes_[slot].upper);
        }
    }
}

void BoxTree::sort_below(std::span<const Box> boxes, std::size_t begin_leaf, std::size_t leaves) {
    if (leaves == 1) return;
    const auto at = [&](std::size_t leaf) { return order_.begin() + static_cast<std::ptrdiff_t>(first_slot(leaf)); };
    Box centers;
    for (auto item = at(begin_leaf); item != at(begin_leaf + leaves); ++item) centers.add(boxes[*item].center());
    const Vec3 size = centers.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto before = [&](Index a, Index b) {
        const double p = boxes[a].center()[axis], q = boxes[b].center()[axis];
        return p < q || (p == q && a < b);
    };
    const std::size_t middle = begin_leaf + leaves / 2;
    std::nth_element(at(begin_leaf), at(middle), at(begin_leaf + leaves), before);
    const auto left = [&] { sort_below(boxes, begin_leaf, leaves / 2); };
    const auto right = [&] { sort_below(boxes, middle, leaves / 2); };
    if (leaves * kLeafBoxes > kSerialBoxes) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

}  // namespace subvol::detail
