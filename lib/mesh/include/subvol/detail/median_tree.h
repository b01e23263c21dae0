// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The items in the order of a complete tree: each node is halved at the median of its centres, along the longest side of
/// their box. Of n items, leaf k gets those from k·n/leaves on, ascending.
///
/// leaves: a power of two
[[nodiscard]] std::vector<Index> median_order(std::span<const Vec3> centers, std::size_t leaves);

/// Centres of items that may lie in files.
class ItemCenters {
public:
    virtual ~ItemCenters() = default;
    [[nodiscard]] virtual std::size_t size() const = 0;

    /// The centres of some items, whose numbers ascend.
    virtual void read(std::span<const Index> items, std::span<Vec3> centers) const = 0;
};

/// The same order, without all centres in memory.
///
/// at_once: so many items are sorted in memory; at least 1
/// cost:    memory: 16 bytes an item while the first half is found, 24 for each of `at_once`
[[nodiscard]] std::vector<Index> median_order(const ItemCenters& centers, std::size_t leaves, std::size_t at_once);

/// Calls body(leaf) for every leaf, in parallel.
void each_leaf(std::size_t leaves, const std::function<void(std::size_t)>& body);

/// A complete binary tree of boxes over items. Node 0 is the root, node n has the children 2n+1 and 2n+2. The items of a leaf
/// are in consecutive slots, where the owner keeps what it needs of them. The tree depends on its input alone.
///
/// NodeBox: a box with add(const NodeBox&)
template <class NodeBox>
class MedianTree {
public:
    /// box_of(item): the box of an item, called in parallel
    template <class BoxOf>
    MedianTree(std::span<const Vec3> centers, std::size_t leaf_size, const BoxOf& box_of) {
        std::size_t leaves = 1;
        while (leaves * leaf_size < centers.size()) leaves *= 2;
        order_ = median_order(centers, leaves);
        first_leaf_ = leaves - 1;
        boxes_.resize(2 * leaves - 1);
        each_leaf(leaves, [&](std::size_t leaf) {
            const std::size_t node = first_leaf_ + leaf;
            const auto [first, last] = slots(node);
            for (std::size_t slot = first; slot < last; ++slot) {
                const NodeBox box = box_of(item(slot));
                if (slot == first) boxes_[node] = box;
                boxes_[node].add(box);
            }
        });
        for (std::size_t node = first_leaf_; node-- > 0;) {
            boxes_[node] = boxes_[2 * node + 1];
            boxes_[node].add(boxes_[2 * node + 2]);
        }
    }

    [[nodiscard]] std::size_t size() const { return order_.size(); }
    [[nodiscard]] Index item(std::size_t slot) const { return order_[slot]; }
    [[nodiscard]] const NodeBox& box(std::size_t node) const { return boxes_[node]; }
    [[nodiscard]] bool is_leaf(std::size_t node) const { return node >= first_leaf_; }

    /// The first slot of a leaf, given as a node, and the one behind its last.
    [[nodiscard]] std::pair<std::size_t, std::size_t> slots(std::size_t node) const {
        const std::size_t leaves = first_leaf_ + 1, k = node - first_leaf_;
        return {k * size() / leaves, (k + 1) * size() / leaves};
    }

    /// Calls visit(first slot, end) for the leaves where enter(box) is true from the root down, until one call returns true.
    template <class Enter, class Visit>
    void visit_leaves(const Enter& enter, const Visit& visit) const {
        std::array<std::size_t, 64> open;
        std::size_t count = 0;
        open[count++] = 0;
        while (count > 0) {
            const std::size_t node = open[--count];
            if (!enter(boxes_[node])) continue;
            if (!is_leaf(node)) {
                open[count++] = 2 * node + 2;
                open[count++] = 2 * node + 1;
                continue;
            }
            const auto [first, last] = slots(node);
            if (visit(first, last)) return;
        }
    }

private:
    std::vector<Index> order_;  // the item in each slot
    std::vector<NodeBox> boxes_;
    std::size_t first_leaf_ = 0;  // of 2ᵏ leaves it is 2ᵏ − 1
};

}  // namespace subvol::detail
