// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/part_of_progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace subvol::detail {
namespace part_of_progress_test {

class Seen : public Progress {
public:
    void report(std::string_view stage, double fraction) override {
        stages.emplace_back(stage);
        fractions.push_back(fraction);
    }
    [[nodiscard]] bool cancelled() const override { return stopped; }

    std::vector<std::string> stages;
    std::vector<double> fractions;
    bool stopped = false;
};

TEST(PartOfProgress, PartsFillTheWholeInTheirOrder) {
    Seen whole;
    for (std::size_t k = 0; k < 4; ++k) {
        PartOfProgress part(&whole, "bricks", k, 4);
        part.report("read", 0);
        part.report("sample", 1);
    }
    EXPECT_EQ(whole.fractions, (std::vector<double>{0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1}));
    EXPECT_EQ(whole.stages, std::vector<std::string>(8, "bricks"));
}

TEST(PartOfProgress, TheFractionNeverShrinks) {
    Seen whole;
    PartOfProgress part(&whole, "frames", 1, 2);
    for (const double fraction : {0.5, 0.0, 1.0, 0.25, 7.0}) part.report("a stage of it", fraction);
    EXPECT_EQ(whole.fractions, (std::vector<double>{0.75, 0.75, 1, 1, 1}));
}

TEST(PartOfProgress, IsCancelledWithTheWhole) {
    Seen whole;
    const PartOfProgress part(&whole, "frames", 0, 2);
    EXPECT_FALSE(part.cancelled());
    whole.stopped = true;
    EXPECT_TRUE(part.cancelled());
}

TEST(PartOfProgress, NobodyNeedsToSeeIt) {
    PartOfProgress part(nullptr, "frames", 0, 1);
    part.report("drawn", 0.5);
    EXPECT_FALSE(part.cancelled());
}

}  // namespace part_of_progress_test
}  // namespace subvol::detail
