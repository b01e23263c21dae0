// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// The flags that the system keeps of the mapping that contains `place`, such as "rd wr mr mw me ac hg".
std::string mapping_flags(const void* place) {
    const auto address = reinterpret_cast<std::uintptr_t>(place);
    std::ifstream mappings("/proc/self/smaps");
    bool here = false;
    for (std::string line; std::getline(mappings, line);) {
        std::istringstream words(line);
        std::uintptr_t begin = 0, end = 0;
        char dash = 0;
        if (words >> std::hex >> begin >> dash >> end && dash == '-') here = begin <= address && address < end;
        if (here && line.starts_with("VmFlags:")) return line;
    }
    return {};
}

bool in_huge_pages(const void* place) {
    return mapping_flags(place).find(" hg") != std::string::npos;
}

bool system_has_huge_pages() {
    constexpr std::size_t kBytes = 4 << 20;
    void* block = mmap(nullptr, kBytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    const bool taken = block != MAP_FAILED && madvise(block, kBytes, MADV_HUGEPAGE) == 0;
    if (block != MAP_FAILED) munmap(block, kBytes);
    return taken;
}

TEST(HugePages, ServeLargeArraysAlone) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer allocates by itself";
#endif
    const std::vector<char> small(1 << 20);
    if (!system_has_huge_pages() || mapping_flags(small.data()).empty()) GTEST_SKIP() << "no huge pages on this system";
    EXPECT_FALSE(in_huge_pages(small.data())) << mapping_flags(small.data());
    for (const std::size_t megabytes : {4, 5, 33, 100}) {
        const std::vector<char> large(megabytes << 20);
        EXPECT_TRUE(in_huge_pages(large.data() + large.size() / 2)) << megabytes;
    }
}

TEST(HugePages, LeaveWhatTheyContain) {
    std::vector<std::uint32_t> values;
    for (std::uint32_t i = 0; i < 10'000'000; ++i) values.push_back(i);  // grows through small and large blocks
    for (std::uint32_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], i);
}

TEST(HugePages, WhatCannotBeHadIsSaid) {
    const std::size_t too_much = std::size_t{1} << 62;
    EXPECT_THROW({ const std::vector<char> none(too_much); }, std::bad_alloc);
}

}  // namespace
