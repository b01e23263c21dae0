// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/spill_file.h"

#include <gmock/gmock.h>

#include <array>
#include <random>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace spill_file_test {

using test::error_of;
using testing::HasSubstr;

using SpilledRecords = test::TempFolder;

TEST_F(SpilledRecords, ComeBackFromTheirPlaces) {
    using Record = std::array<std::int64_t, 5>;
    SpillFile file(path(""), sizeof(Record));
    EXPECT_EQ(file_count(), 0U) << "the file has no name";
    constexpr Index kRecords = 20'000;
    std::vector<Record> memory(kRecords, Record{});  // what was never written is 0
    std::mt19937 random(3);
    for (int round = 0; round < 40; ++round) {
        // Neighbours, short gaps and gaps of more than a page.
        std::vector<Index> numbers;
        for (Index n = static_cast<Index>(random() % 100); n < kRecords;
             n += 1 + (random() % 4 == 0 ? static_cast<Index>(random() % 1500) : 0)) {
            numbers.push_back(n);
        }
        std::vector<Record> some(numbers.size());
        if (round % 2 == 0) {
            for (std::size_t i = 0; i < some.size(); ++i) {
                for (auto& value : some[i]) value = static_cast<std::int64_t>(random());
                memory[numbers[i]] = some[i];
            }
            file.write_some(numbers, records_of(some));
        } else {
            file.read_some(numbers, records_of(some));
            for (std::size_t i = 0; i < some.size(); ++i) ASSERT_EQ(some[i], memory[numbers[i]]) << numbers[i];
        }
    }
    std::vector<Record> all(kRecords + 10);
    file.read(0, records_of(all));
    memory.resize(kRecords + 10, Record{});
    EXPECT_EQ(all, memory);
    EXPECT_THAT(error_of([&] { SpillFile(path("no folder"), 8); }, ErrorCode::Io),
                HasSubstr("no folder: a temporary file in it"));
    SpillBuckets<std::uint32_t> buckets(path(""), 3);
    for (std::uint32_t k = 0; k < 10'000; ++k) buckets.add(k % 7 % 3, k);
    for (std::size_t b = 0; b < 3; ++b) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t k = 0; k < 10'000; ++k) {
            if (k % 7 % 3 == b) expected.push_back(k);
        }
        EXPECT_EQ(buckets.take(b), expected);
        EXPECT_TRUE(buckets.take(b).empty()) << "they are taken once";
    }
}

}  // namespace spill_file_test
}  // namespace subvol::detail
