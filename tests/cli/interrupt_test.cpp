// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "lib/temp_folder.h"
#include "subvol/detail/atomic_file.h"

namespace subvol::cli {
namespace interrupt_test {

using Interrupts = test::TempFolder;

/// Writes files one after the other, each opened again by its name, as libraries of pictures do.
[[noreturn]] void write_files(const std::string& name) {
    for (;;) {
        const detail::AtomicFile file{name};
        for (int k = 0; k < 20; ++k) std::ofstream(file.path()) << "text";
    }
}

TEST_F(Interrupts, LeaveNoFileThatAnotherThreadIsWriting) {
    constexpr int kThreads = 8, kTimes = 20;
    GTEST_FLAG_SET(death_test_style, "fast");
    for (int time = 0; time < kTimes; ++time) {
        EXPECT_EXIT(
            {
                catch_interrupts(true);
                std::vector<std::thread> writers;
                for (int k = 0; k < kThreads; ++k) writers.emplace_back(write_files, path("a" + std::to_string(k)));
                usleep(20'000);
                std::raise(SIGPIPE);
            },
            testing::ExitedWithCode(128 + SIGPIPE), "");
        ASSERT_EQ(file_count(), 0U) << time;
    }
}

TEST_F(Interrupts, OfManyThreadsAtOnceEndTheProgramOnce) {
    constexpr int kThreads = 8;
    GTEST_FLAG_SET(death_test_style, "fast");
    EXPECT_EXIT(
        {
            catch_interrupts(true);
            std::vector<std::thread> others;
            for (int k = 0; k < kThreads; ++k) others.emplace_back([] { std::raise(SIGPIPE); });
            for (;;) pause();
        },
        testing::ExitedWithCode(128 + SIGPIPE), "");
}

// A process that fails while it writes a file ends with a sentence, and the file is gone.
class Failures : public test::TempFolder {
protected:
    void expect_end(const auto& end, void (*fail)()) {
        GTEST_FLAG_SET(death_test_style, "fast");
        EXPECT_EXIT(
            {
                catch_failures();
                const detail::AtomicFile file{path("a.vtu")};
                fail();
            },
            end, "^subvol: [^\n]* memory [^\n]*\n$");
        EXPECT_EQ(file_count(), 0U);
    }
};

TEST_F(Failures, OfLibrariesThatAbortEndWithASentence) {
    expect_end(testing::ExitedWithCode(3), [] { std::abort(); });
}

TEST_F(Failures, OfWhatCannotCatchEndWithASentence) {
    expect_end(testing::ExitedWithCode(3), [] { std::thread([] { throw std::bad_alloc(); }).join(); });
}

TEST_F(Failures, ThatAreCrashesStayCrashes) {
    expect_end(testing::KilledBySignal(SIGSEGV), [] { std::raise(SIGSEGV); });
    expect_end(testing::KilledBySignal(SIGFPE), [] { std::thread([] { std::raise(SIGFPE); }).join(); });
}

}  // namespace interrupt_test
}  // namespace subvol::cli
