// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/median_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace subvol::detail {

namespace {

constexpr std::size_t kSerialLeaves = 256;                   // subtrees below this are sorted by one thread
constexpr std::size_t kItemsOfChunk = std::size_t{1} << 16;  // items whose centres are read together

int longest_axis(const Box& box) {
    const Vec3 size = box.size();
    return size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
}

/// Sorts the items of some leaves: their places in `centers`.
///
/// slots: the first slot of each leaf, counted from that of the first one
template <class SlotOfLeaf>
class MedianSort {
public:
    MedianSort(std::span<const Vec3> centers, const SlotOfLeaf& slots, std::span<Index> order)
        : centers_(centers), slots_(slots), order_(order) {}

    void sort(std::size_t first_leaf, std::size_t count) const {
        const auto first = slot(first_leaf), last = slot(first_leaf + count);
        if (count == 1) {
            std::sort(first, last);
            return;
        }
        const std::size_t half = count / 2;
        const auto middle = slot(first_leaf + half);
        Box box;
        for (auto i = first; i != last; ++i) box.add(centers_[*i]);
        const int axis = longest_axis(box);
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
    [[nodiscard]] std::span<Index>::iterator slot(std::size_t leaf) const {
        return order_.begin() + static_cast<std::ptrdiff_t>(slots_(leaf));
    }

    std::span<const Vec3> centers_;
    const SlotOfLeaf& slots_;
    std::span<Index> order_;
};

/// Halves ranges of items whose centres are read as they are needed, until they fit into memory. The items of a range ascend.
class OutsideSort {
public:
    OutsideSort(const ItemCenters& centers, std::size_t leaves, std::size_t at_once, std::span<Index> order)
        : centers_(centers), leaves_(leaves), at_once_(at_once), order_(order) {}

    void sort(std::size_t first_leaf, std::size_t count) const {
        const std::size_t first = slot(first_leaf), last = slot(first_leaf + count);
        const std::span<Index> items = order_.subspan(first, last - first);
        if (items.size() <= at_once_ || count == 1) {
            sort_in_memory(items, first_leaf, count);
            return;
        }
        halve(items, slot(first_leaf + count / 2) - first);
        sort(first_leaf, count / 2);
        sort(first_leaf + count / 2, count / 2);
    }

private:
    [[nodiscard]] std::size_t slot(std::size_t leaf) const { return leaf * order_.size() / leaves_; }

    void sort_in_memory(std::span<Index> items, std::size_t first_leaf, std::size_t count) const {
        std::vector<Vec3> centers(items.size());
        centers_.read(items, centers);
        std::vector<Index> places(items.size());
        std::iota(places.begin(), places.end(), Index{0});
        const auto slots = [&](std::size_t leaf) { return slot(first_leaf + leaf) - slot(first_leaf); };
        MedianSort(std::span<const Vec3>(centers), slots, std::span(places)).sort(0, count);
        for (Index& place : places) place = items[place];
        std::ranges::copy(places, items.begin());
    }

    template <class Call>
    void each_center(std::span<const Index> items, const Call& call) const {
        std::vector<Vec3> centers(std::min(items.size(), kItemsOfChunk));
        for (std::size_t begin = 0; begin < items.size(); begin += kItemsOfChunk) {
            const auto some = items.subspan(begin, std::min(kItemsOfChunk, items.size() - begin));
            centers_.read(some, std::span(centers).first(some.size()));
            for (std::size_t i = 0; i < some.size(); ++i) call(some[i], centers[i]);
        }
    }

    void halve(std::span<Index> items, std::size_t middle) const {
        Box box;
        each_center(items, [&](Index, const Vec3& x) { box.add(x); });
        const int axis = longest_axis(box);
        double at = 0;
        std::size_t equal_below = middle;  // so many of those at the border are below it, the first ones
        {
            std::vector<double> places;
            places.reserve(items.size());
            each_center(items, [&](Index, const Vec3& x) { places.push_back(x[axis]); });
            const auto border = places.begin() + static_cast<std::ptrdiff_t>(middle);
            std::nth_element(places.begin(), border, places.end());
            at = *border;
            equal_below -= static_cast<std::size_t>(std::count_if(places.begin(), border, [&](double x) { return x < at; }));
        }
        std::vector<Index> below, above;
        below.reserve(middle);
        above.reserve(items.size() - middle);
        each_center(items, [&](Index i, const Vec3& x) {
            const bool is_below = x[axis] < at || (x[axis] == at && equal_below > 0);
            if (is_below && x[axis] == at) --equal_below;
            (is_below ? below : above).push_back(i);
        });
        std::ranges::copy(above, std::ranges::copy(below, items.begin()).out);
    }

    const ItemCenters& centers_;
    std::size_t leaves_, at_once_;
    std::span<Index> order_;
};

}  // namespace

std::vector<Index> median_order(std::span<const Vec3> centers, std::size_t leaves) {
    std::vector<Index> order(centers.size());
    std::iota(order.begin(), order.end(), Index{0});
    const auto slots = [&](std::size_t leaf) { return leaf * centers.size() / leaves; };
    MedianSort(centers, slots, std::span(order)).sort(0, leaves);
    return order;
}

std::vector<Index> median_order(const ItemCenters& centers, std::size_t leaves, std::size_t at_once) {
    std::vector<Index> order(centers.size());
    std::iota(order.begin(), order.end(), Index{0});
    OutsideSort(centers, leaves, at_once, order).sort(0, leaves);
    return order;
}

void each_leaf(std::size_t leaves, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, leaves, body);
}

}  // namespace subvol::detail
