// SPDX-License-Identifier: Apache-2.0
#include "box_tree.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kLeafBoxes = 8;

std::vector<Vec3> centers_of(const std::vector<Box>& boxes) {
    std::vector<Vec3> centers;
    centers.reserve(boxes.size());
    for (const Box& box : boxes) centers.push_back(box.center());
    return centers;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes)
    : tree_(centers_of(boxes), kLeafBoxes, [&](Index item) { return boxes[item]; }) {
    boxes_.reserve(boxes.size());
    for (std::size_t slot = 0; slot < boxes.size(); ++slot) boxes_.push_back(boxes[tree_.item(slot)]);
}

}  // namespace subvol::detail
