// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/median_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace subvol::detail {

namespace {

constexpr std::size_t kSerialLeaves = 256;  // subtrees below this are sorted by one thread

class MedianSort {
public:
    MedianSort(std::span<const Vec3> centers, std::size_t leaves, std::vector<Index>& order)
        : centers_(centers), leaves_(leaves), order_(order) {}

    /// Sorts the items of `count` leaves.
    void sort(std::size_t first_leaf, std::size_t count) const {
        if (count == 1) return;
        const std::size_t half = count / 2;
        const auto first = slot(first_leaf), middle = slot(first_leaf + half), last = slot(first_leaf + count);
        Box box;
        for (auto i = first; i != last; ++i) box.add(centers_[*i]);
        const Vec3 size = box.size();
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        std::nth_element(first, middle, last, [&](Index a, Index b) {
            return centers_[a][axis] != centers_[b][axis] ? centers_[a][axis] < centers_[b][axis] : a < b;
        });
        const auto left = [&] { sort(first_leaf, half); };
        const auto right = [&] { sort(first_leaf + half, half); };
        if (count > kSerialLeaves) {
            tbb::parallel_invoke(left, right);
        } else {
            left();
            right();
        }
    }

private:
    [[nodiscard]] std::vector<Index>::iterator slot(std::size_t leaf) const {
        return order_.begin() + static_cast<std::ptrdiff_t>(leaf * order_.size() / leaves_);
    }

    std::span<const Vec3> centers_;
    std::size_t leaves_;
    std::vector<Index>& order_;
};

}  // namespace

std::vector<Index> median_order(std::span<const Vec3> centers, std::size_t leaves) {
    std::vector<Index> order(centers.size());
    std::iota(order.begin(), order.end(), Index{0});
    MedianSort(centers, leaves, order).sort(0, leaves);
    return order;
}

void each_leaf(std::size_t leaves, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, leaves, body);
}

}  // namespace subvol::detail
