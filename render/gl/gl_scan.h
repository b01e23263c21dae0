// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gl_dispatch.h"

namespace subvol::detail {

/// Prefix sums, on the current context.
class GlScan {
public:
    GlScan();

    /// Replaces each value by the sum of those before it, modulo 2^32; values[count] becomes the sum of all.
    ///
    /// values: count + 1 words
    /// throws: Error(InvalidInput) if there are fewer; Error(MissingCapability) if the device has no room
    /// cost:   reads the values twice and writes them once; changes the program and bindings 0..2 and 7
    void exclusive_scan(GlBuffer& values, const GlCount& count);

    /// exclusive_scan in two steps, for several scans of the same count.
    void plan(const GlCount& count);
    void scan_as_planned(GlBuffer& values);

private:
    void dispatch_level(const GlProgram& program, GlBuffer& values, std::size_t level);

    GlProgram plan_program_, sums_program_, blocks_program_;
    GlBuffer plan_;               // for each level the dispatch and its number of items
    std::vector<GlBuffer> sums_;  // of the blocks of each level but the last
    std::size_t levels_ = 0;
};

/// Sorts by integer keys, on the current context.
class GlSort {
public:
    GlSort();

    /// Sorts pairs of a key and a value by the lowest bits of the key; the sort is stable.
    ///
    /// keys, values: words; the sort may exchange the buffers for others of at least the same room: bind them again
    /// bits:         1..32
    /// throws:       Error(InvalidInput) for fewer words than `count` can be;
    ///               Error(MissingCapability) if the device has no room
    /// cost:         a pass for each 8 bits, which reads 12 bytes and writes 8 for each pair; scratch memory of 8.5 bytes a
    ///               pair; changes the program and bindings 0..5 and 7
    void radix_sort(GlBuffer& keys, GlBuffer& values, const GlCount& count, int bits);

private:
    void plan(const GlCount& count, int bits);
    void pass(GlBuffer& keys, GlBuffer& values, int shift, int bits);

    GlProgram plan_program_, count_program_, move_program_;
    GlScan scan_;
    GlBuffer plan_, counts_, other_keys_, other_values_;
};

/// Finds where the bins of a sorted list begin, on the current context.
class GlRanges {
public:
    GlRanges();

    /// offsets[b] = the number of keys less than b, for b = 0..bins, so that bin b has the keys from offsets[b] to
    /// offsets[b + 1]. Keys of `bins` and more are in no bin.
    ///
    /// keys:    sorted; offsets grows to bins + 1 words
    /// throws:  Error(InvalidInput) for fewer keys than `count` can be, or more than kMostGlItems bins;
    ///          Error(MissingCapability) if the device has no room
    /// cost:    log2(count) reads for each bin; changes the program and bindings 0, 1 and 7
    void find_ranges(GlBuffer& keys, const GlCount& count, std::uint32_t bins, GlBuffer& offsets);

private:
    GlProgram program_;
};

}  // namespace subvol::detail
