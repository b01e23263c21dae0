// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "class_graph.h"
#include "descent_worker.h"
#include "subvol/detail/patch.h"

namespace subvol::detail {

/// Evaluates places whose surroundings have no class, by refining the patch around them, level by level, until two levels agree
/// or the surroundings have one.
///
/// What has been refined is kept between calls, because callers that move places by Newton's method ask again for places in the
/// same cells: a cell that so many others surround that they have no class, as at an axis of many cells, is refined once.
class PatchTree {
public:
    /// The mesh is kept by reference.
    PatchTree(const HexMesh& control, const SchemeOptions& scheme);
    ~PatchTree();
    PatchTree(const PatchTree&) = delete;
    PatchTree& operator=(const PatchTree&) = delete;

    /// Evaluates places that have been left. Thread-safe: one call waits for the other.
    ///
    /// classes: to which places are given below the level at which they were left, as soon as their surroundings have one
    /// returns: the places that these left again, further down
    [[nodiscard]] std::vector<LeftPlace> run(const DescentTask& task, std::span<const LeftPlace> places, ClassGraph& classes);

private:
    struct Node;
    struct Task;
    struct Place;

    void run_part(Task& task, std::span<const LeftPlace> left);
    void visit(Node& node, std::vector<Place>& places, Task& task);
    void descend(Node& node, std::vector<Place>& places, Task& task);
    [[nodiscard]] Node* add_node(Patch patch, int level);

    const HexMesh& control_;
    SchemeOptions scheme_;
    std::mutex mutex_;
    std::unique_ptr<PatchSource> source_;  // made when it is needed first
    struct Child {
        Node* node = nullptr;
        Index first = 0;  // of its eight children in the node; of a control cell its own number there
    };
    std::vector<Child> control_cells_;
    std::vector<std::unique_ptr<Node>> nodes_;
    std::size_t bytes_ = 0;  // of the nodes
};

}  // namespace subvol::detail
