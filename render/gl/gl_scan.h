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

}  // namespace subvol::detail
