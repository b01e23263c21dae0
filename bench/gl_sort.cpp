// SPDX-License-Identifier: Apache-2.0
// Sort, scan and ranges on a GL device. Arguments: millions of keys, bits, device.

#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "gl_context.h"
#include "gl_scan.h"
#include "measure.h"

int main(int argc, char** argv) {
    using namespace subvol::detail;
    const auto count = static_cast<std::uint32_t>(1e6 * (argc > 1 ? std::atof(argv[1]) : 4.0));
    const int bits = argc > 2 ? std::atoi(argv[2]) : 32;
    const GlContext context(argc > 3 ? std::optional(std::atoi(argv[3])) : std::nullopt);
    std::mt19937 random(1);
    std::vector<std::uint32_t> numbers(count);
    for (auto& number : numbers) number = static_cast<std::uint32_t>(random() >> (32 - bits));
    GlBuffer source(1, 4 * std::size_t{count}, numbers.data()), keys(4 * std::size_t{count} + 4),
        values(4 * std::size_t{count});
    GlBuffer offsets;
    GlScan scan;
    GlSort sort;
    GlRanges ranges;

    const auto measure = [&](const char* what, double items, bool fresh, const auto& work) {
        double best = 1e30;
        for (int i = 0; i < 4; ++i) {  // the first run allocates scratch memory and warms up
            if (fresh) glCopyNamedBufferSubData(source.id(), keys.id(), 0, 0, 4 * GLsizeiptr{count});
            glFinish();
            best = std::min(best, subvol::bench::seconds_of([&] { work(), glFinish(); }, 1));
        }
        check_gl(what);
        std::printf("%-16s %9.3f ms  %10.2f million/s\n", what, 1e3 * best, 1e-6 * items / best);
    };
    std::printf("%s, %u keys, %d bits\n", context.renderer().c_str(), count, bits);
    measure("exclusive_scan", count, true, [&] { scan.exclusive_scan(keys, count); });
    measure("radix_sort", count, true, [&] { sort.radix_sort(keys, values, count, bits); });
    const std::uint32_t bins = 1U << std::min(bits, 20);
    measure("find_ranges", bins, false, [&] { ranges.find_ranges(keys, count, bins, offsets); });
}
