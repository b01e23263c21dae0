// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "subvol/kernel_hierarchy.h"

namespace subvol::detail {

inline constexpr std::size_t kLeafSize = 8;  // the most kernels of a leaf

/// Makes the nodes of a tree, or of a part of it whose nodes are numbered as those of a tree.
class NodeMerger {
public:
    /// volume: of the kernels; referred to
    explicit NodeMerger(const RbfVolume& volume);

    /// Makes room for so many nodes.
    void allocate(KernelHierarchy& tree, std::size_t nodes) const;

    /// Makes a leaf of kernels of the volume; at most kLeafSize, at least one.
    void merge_kernels(KernelHierarchy& tree, std::size_t node, std::span<const Index> kernels) const;

    /// Makes a node of its two children.
    void merge_nodes(KernelHierarchy& tree, std::size_t node) const;

private:
    struct Part;

    [[nodiscard]] Part kernel_part(std::size_t i) const;
    static void merge(std::span<const Part> parts, KernelHierarchy& tree, std::size_t node);

    const RbfVolume& volume_;
    double radius_;
};

/// Copies a node between trees of the same channels.
void copy_node(const KernelHierarchy& from, std::size_t i, KernelHierarchy& to, std::size_t j);

}  // namespace subvol::detail
