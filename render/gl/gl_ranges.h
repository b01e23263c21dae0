// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gl_dispatch.h"

namespace subvol::detail {

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
