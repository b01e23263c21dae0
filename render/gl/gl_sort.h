// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gl_scan.h"

namespace subvol::detail {

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

}  // namespace subvol::detail
