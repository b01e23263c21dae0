// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "gl_context.h"
#include "gl_scan.h"
#include "subvol/error.h"

namespace subvol {
namespace gl_primitives_test {

using detail::GlBuffer;
using detail::GlCount;
using detail::GlRanges;
using detail::GlScan;
using detail::GlSort;
using Words = std::vector<std::uint32_t>;

/// Below, at and beyond the width of a work group and of a block; 100003 needs two levels of a scan, 2.3 million two rows of
/// groups, of which one group has nothing to do.
constexpr std::uint32_t kSizes[] = {0, 1, 7, 255, 256, 257, 2047, 2048, 2049, 4095, 100003, 2303000};
constexpr std::uint32_t kGuard = 0xdeadbeef;

class GlPrimitives : public testing::Test {
protected:
    void SetUp() override {
        if (!find_gl_device()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
        context_ = std::make_unique<detail::GlContext>();
    }

private:
    std::unique_ptr<detail::GlContext> context_;
};

GlBuffer buffer_of(const Words& words) {
    GlBuffer buffer(4 * words.size());
    buffer.upload(4 * words.size(), words.data());
    return buffer;
}

Words words_of(const GlBuffer& buffer, std::size_t count) {
    Words words(count);
    buffer.read(4 * count, words.data());
    return words;
}

Words random_words(std::size_t count, std::uint32_t most) {
    std::mt19937 random(static_cast<std::uint32_t>(count) + 1);
    std::uniform_int_distribution<std::uint32_t> any(0, most);
    Words words(count);
    for (auto& word : words) word = any(random);
    return words;
}

constexpr std::uint32_t kAny = std::numeric_limits<std::uint32_t>::max();

/// Several kinds of keys that are difficult for a radix sort.
struct KeyKind {
    const char* name;
    std::function<Words(std::uint32_t)> make;
};

const KeyKind kKeyKinds[] = {
    {"random", [](std::uint32_t n) { return random_words(n, kAny); }},
    {"few bins", [](std::uint32_t n) { return random_words(n, 2); }},
    {"all zero", [](std::uint32_t n) { return Words(n, 0); }},
    {"all ones", [](std::uint32_t n) { return Words(n, kAny); }},
    {"descending",
     [](std::uint32_t n) {
         Words words(n);
         for (std::uint32_t i = 0; i < n; ++i) words[i] = 3 * (n - i);
         return words;
     }},
    {"one digit a time",
     [](std::uint32_t n) {
         Words words(n);
         for (std::uint32_t i = 0; i < n; ++i) words[i] = (i % 255 + 1) << (8 * (i % 4));
         return words;
     }},
};

Words in_order_of(const Words& keys, int bits) {
    const std::uint32_t mask = bits == 32 ? kAny : (1U << bits) - 1;
    Words order(keys.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return keys[i] & mask; });
    return order;
}

Words picked(const Words& words, const Words& order) {
    Words result;
    for (const std::uint32_t i : order) result.push_back(words[i]);
    return result;
}

/// Sorts the first `count` keys, with their numbers as values; the count is a number or in a buffer.
void expect_sorted(GlSort& sort, const Words& keys, std::uint32_t count, int bits, bool count_on_device) {
    Words numbers(keys.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    GlBuffer key_buffer = buffer_of(keys), value_buffer = buffer_of(numbers);
    const GlBuffer count_buffer = buffer_of({kGuard, count});
    const auto most = static_cast<std::uint32_t>(keys.size());
    sort.radix_sort(key_buffer, value_buffer, count_on_device ? GlCount{count_buffer, 1, most} : GlCount{count}, bits);
    const Words order = in_order_of({keys.begin(), keys.begin() + count}, bits);
    EXPECT_EQ(words_of(value_buffer, count), order);
    EXPECT_EQ(words_of(key_buffer, count), picked(keys, order));
    EXPECT_NO_THROW(detail::check_gl("sort"));
}

void expect_scanned(GlScan& scan, std::uint32_t count, std::uint32_t most) {
    Words words = random_words(count, most);
    words.insert(words.end(), {kGuard, kGuard});
    GlBuffer buffer = buffer_of(words);
    scan.exclusive_scan(buffer, count);
    std::exclusive_scan(words.begin(), words.end() - 1, words.begin(), 0U);
    EXPECT_EQ(words_of(buffer, count + 2), words) << count << " values up to " << most;
}

TEST_F(GlPrimitives, ScanIsThatOfTheStandardLibrary) {
    GlScan scan;
    for (const std::uint32_t count : kSizes) {
        for (const std::uint32_t most : {1U, 1000U, kAny}) expect_scanned(scan, count, most);  // the last wraps around
    }
    expect_scanned(scan, detail::kGlBlock * detail::kGlBlock - 1, 9);  // with the total, two full levels
    expect_scanned(scan, detail::kGlBlock * detail::kGlBlock, 9);      // three levels
    expect_scanned(scan, 6000000, 9);
    EXPECT_NO_THROW(detail::check_gl("scan"));
}

TEST_F(GlPrimitives, ScanTakesItsCountFromABuffer) {
    GlScan scan;
    const std::uint32_t room = 100003;
    for (const std::uint32_t count : {0U, 1U, 2047U, 2048U, 70000U, room, room + 9}) {
        const std::uint32_t used = std::min(count, room);  // a count beyond the room is reduced
        const GlBuffer counts = buffer_of({count});
        Words words = random_words(room + 1, 100);
        GlBuffer buffer = buffer_of(words);
        scan.exclusive_scan(buffer, {counts, 0, room});
        std::exclusive_scan(words.begin(), words.begin() + used + 1, words.begin(), 0U);
        EXPECT_EQ(words_of(buffer, room + 1), words) << count;
    }
}

TEST_F(GlPrimitives, SortIsThatOfTheStandardLibrary) {
    GlSort sort;
    for (const std::uint32_t count : kSizes) {
        for (const KeyKind& kind : kKeyKinds) {
            SCOPED_TRACE(std::to_string(count) + " keys, " + kind.name);
            expect_sorted(sort, kind.make(count), count, 32, false);
        }
    }
}

TEST_F(GlPrimitives, SortLooksAtTheLowestBitsOnly) {
    GlSort sort;
    for (const int bits : {1, 3, 4, 5, 8, 9, 12, 20, 23, 31}) {
        SCOPED_TRACE(std::to_string(bits) + " bits");
        expect_sorted(sort, random_words(10007, kAny), 10007, bits, false);
    }
}

TEST_F(GlPrimitives, SortTakesItsCountFromABuffer) {
    GlSort sort;
    const Words keys = random_words(100003, kAny);
    for (const std::uint32_t count : {0U, 1U, 2048U, 2049U, 65000U, 100003U}) {
        SCOPED_TRACE(std::to_string(count) + " of 100003 keys");
        expect_sorted(sort, keys, count, 24, true);
    }
}

TEST_F(GlPrimitives, SortIgnoresItemsBeyondTheCount) {
    GlSort sort;
    Words keys(3000, 0);
    std::fill(keys.begin(), keys.begin() + 2500, 5U);
    expect_sorted(sort, keys, 2500, 8, true);
}

TEST_F(GlPrimitives, RangesAreLowerBounds) {
    GlRanges ranges;
    GlBuffer offsets;
    for (const std::uint32_t count : kSizes) {
        for (const std::uint32_t bins : {1U, 3U, 256U, 70001U}) {
            Words keys = random_words(count, bins + bins / 4);  // some beyond the last bin
            std::ranges::sort(keys);
            GlBuffer buffer = buffer_of(keys);
            const GlBuffer counts = buffer_of({count});
            ranges.find_ranges(buffer, {counts, 0, count}, bins, offsets);
            Words expected;
            for (std::uint32_t bin = 0; bin <= bins; ++bin) {
                expected.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(keys, bin) - keys.begin()));
            }
            EXPECT_EQ(words_of(offsets, bins + 1), expected) << count << " keys, " << bins << " bins";
        }
    }
    EXPECT_NO_THROW(detail::check_gl("ranges"));
}

TEST_F(GlPrimitives, RefuseWhatDoesNotFit) {
    GlScan scan;
    GlSort sort;
    GlRanges ranges;
    GlBuffer small(16), other(16);
    EXPECT_THROW(scan.exclusive_scan(small, 4), Error) << "no place for the total";
    EXPECT_NO_THROW(scan.exclusive_scan(small, 3));
    EXPECT_THROW(sort.radix_sort(small, other, 5, 8), Error);
    EXPECT_THROW(sort.radix_sort(small, other, detail::kMostGlItems + 1, 8), Error);
    EXPECT_THROW(ranges.find_ranges(small, 4, detail::kMostGlItems + 1, other), Error);
}

}  // namespace gl_primitives_test
}  // namespace subvol
