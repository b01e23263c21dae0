// SPDX-License-Identifier: Apache-2.0
#include "run_nested.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace subvol {
namespace run_nested_test {

/// Waits until the condition holds, for a limited time: with a single thread it never holds.
template <class Condition>
void wait_for(const Condition& condition) {
    for (int i = 0; i < 200 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(RunNested, ALoopWithinIsFinishedThoughItsNeighbourThrows) {
    constexpr int kSteps = 1000;
    std::atomic<bool> begun = false, thrown = false;
    std::atomic<int> steps = 0;
    const auto loop = [&] {
        tbb::parallel_for(0, kSteps, [&](int) {
            begun = true;
            wait_for([&] { return thrown.load(); });
            ++steps;
        });
        EXPECT_EQ(steps, kSteps);
    };
    const auto both = [&] {
        tbb::parallel_for(0, 2, [&](int part) {
            if (part == 0) return detail::run_nested(loop);
            wait_for([&] { return begun.load(); });
            thrown = true;
            throw std::runtime_error("the neighbour's");
        });
    };
    EXPECT_THROW(both(), std::runtime_error);
}

TEST(RunNested, HandsOnWhatTheWorkThrows) {
    EXPECT_THROW(detail::run_nested([] { throw std::runtime_error("its own"); }), std::runtime_error);
}

}  // namespace run_nested_test
}  // namespace subvol
