// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gl_dispatch.h"

namespace subvol::detail {

/// Where the parts of a sorted list begin, on the current context.
class GlRanges {
public:
    GlRanges();

    /// offsets[b] = how many keys are less than b, for b = 0..bins: bin b has those from offsets[b] to offsets[b + 1]. Keys
    /// from `bins` on are in no bin.
    ///
    /// keys:    sorted; offsets grows to bins + 1 words
    /// throws:  Error(InvalidInput) for fewer keys than `count` may be, or more than kMostGlItems bins;
    ///          Error(MissingCapability) if the device has no room
    /// cost:    log2(count) reads a bin; changes the program and bindings 0, 1 and 7
    void find_ranges(GlBuffer& keys, const GlCount& count, std::uint32_t bins, GlBuffer& offsets);

private:
    GlProgram program_;
};

}  // namespace subvol::detail
