// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/median_tree.h"
#include "lib/random_vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace subvol::detail {
namespace median_tree_test {

std::vector<Box> random_boxes(std::size_t count) {
    std::mt19937 random(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> place(0, 10), size(0, 1);
    std::vector<Box> boxes(count);
    for (Box& box : boxes) {
        box.add(Vec3(1, 1, 2) * test::random_vector(place, random));
        box.add(box.lower + test::random_vector(size, random));
    }
    return boxes;
}

MedianTree<Box> tree_of(const std::vector<Box>& boxes) {
    std::vector<Vec3> centers;
    for (const Box& box : boxes) centers.push_back(box.center());
    return {centers, 4, [&](Index item) { return boxes[item]; }};
}

bool holds(const Box& box, const Vec3& x) {
    return glm::all(glm::lessThanEqual(box.lower, x)) && glm::all(glm::lessThanEqual(x, box.upper));
}

TEST(MedianTree, FindsTheBoxesThatHoldAPoint) {
    for (const std::size_t count : {1u, 3u, 17u, 3000u}) {
        const std::vector<Box> boxes = random_boxes(count);
        const MedianTree<Box> tree = tree_of(boxes);
        ASSERT_EQ(tree.size(), count);
        for (const Box& near : random_boxes(50)) {
            const Vec3 x = near.center();
            std::vector<Index> found, expected;
            tree.visit_leaves([&](const Box& box) { return holds(box, x); },
                              [&](std::size_t first, std::size_t last) {
                                  for (std::size_t slot = first; slot < last; ++slot) {
                                      if (holds(boxes[tree.item(slot)], x)) found.push_back(tree.item(slot));
                                  }
                                  return false;
                              });
            for (Index i = 0; i < count; ++i) {
                if (holds(boxes[i], x)) expected.push_back(i);
            }
            std::ranges::sort(found);
            EXPECT_EQ(found, expected);
        }
    }
}

class CentersInChunks : public ItemCenters {
public:
    explicit CentersInChunks(std::vector<Vec3> centers) : centers_(std::move(centers)) {}
    std::size_t size() const override { return centers_.size(); }
    void read(std::span<const Index> items, std::span<Vec3> centers) const override {
        EXPECT_TRUE(std::ranges::is_sorted(items));
        for (std::size_t i = 0; i < items.size(); ++i) centers[i] = centers_[items[i]];
    }
    const std::vector<Vec3>& all() const { return centers_; }

private:
    std::vector<Vec3> centers_;
};

TEST(MedianTree, TheOrderIsTheSameWithoutAllCentersInMemory) {
    std::mt19937 random(3);
    for (const int steps : {4, 1000000}) {  // many equal coordinates, and hardly any
        std::vector<Vec3> places;
        for (int i = 0; i < 70001; ++i) {
            const auto next = [&] { return static_cast<double>(random() % static_cast<unsigned>(steps)); };
            places.emplace_back(next(), 1.1 * next(), 0.9 * next());
        }
        const CentersInChunks centers(std::move(places));
        for (const std::size_t leaves : {1u, 2u, 64u, 16384u}) {
            const std::vector<Index> order = median_order(centers.all(), leaves);
            for (const std::size_t at_once : {1u, 1000u, 20000u, 100000u}) {
                EXPECT_TRUE(median_order(centers, leaves, at_once) == order) << leaves << " leaves, " << at_once;
            }
        }
    }
}

TEST(MedianTree, EverySlotBelongsToOneLeaf) {
    const MedianTree<Box> tree = tree_of(random_boxes(1001));
    std::vector<Index> items;
    std::size_t next = 0;
    tree.visit_leaves([](const Box&) { return true; },
                      [&](std::size_t first, std::size_t last) {
                          EXPECT_EQ(first, next);
                          EXPECT_LE(last - first, 4u);
                          next = last;
                          for (std::size_t slot = first; slot < last; ++slot) items.push_back(tree.item(slot));
                          return false;
                      });
    std::ranges::sort(items);
    std::vector<Index> all(1001);
    std::iota(all.begin(), all.end(), Index{0});
    EXPECT_EQ(items, all);
}

TEST(MedianTree, EndsAtTheFirstLeafThatIsEnoughAndHasNoneWithoutItems) {
    std::size_t visits = 0;
    const auto visit = [&](std::size_t, std::size_t) { return ++visits == 2; };
    tree_of(random_boxes(100)).visit_leaves([](const Box&) { return true; }, visit);
    EXPECT_EQ(visits, 2u);
    const MedianTree<Box> none = tree_of({});
    EXPECT_EQ(none.size(), 0u);
    EXPECT_TRUE(none.box(0).empty());
    EXPECT_EQ(none.slots(0), std::pair(std::size_t{0}, std::size_t{0}));
}

}  // namespace median_tree_test
}  // namespace subvol::detail
