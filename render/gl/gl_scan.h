// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gl_dispatch.h"

namespace subvol::detail {

/// Sums of what comes before, on the current context.
class GlScan {
public:
    GlScan();

    /// Each value becomes the sum of those before it, modulo 2^32; values[count] becomes the sum of all.
    ///
    /// values: count + 1 words
    /// throws: Error(InvalidInput) if they are fewer; Error(MissingCapability) if the device has no room
    /// cost:   reads the values twice and writes them once; changes the program and bindings 0..2 and 7
    void exclusive_scan(GlBuffer& values, const GlCount& count);

    /// exclusive_scan in two steps, for scans of the same count one after the other.
    void plan(const GlCount& count);
    void scan_as_planned(GlBuffer& values);

private:
    void dispatch_level(const GlProgram& program, GlBuffer& values, std::size_t level);

    GlProgram plan_program_, sums_program_, blocks_program_;
    GlBuffer plan_;               // a dispatch a level, and how many items it has
    std::vector<GlBuffer> sums_;  // of the blocks of each level but the last
    std::size_t levels_ = 0;
};

}  // namespace subvol::detail
