// SPDX-License-Identifier: Apache-2.0
#include "gl_ranges.h"

#include "shader_find_ranges_comp.h"

namespace subvol::detail {

namespace {

constexpr std::uint32_t kRangeThreads = 256;  // of a group; each thread finds one bin
constexpr GLint kRangeBinsLocation = 2;

}  // namespace

GlRanges::GlRanges() : program_(make_primitive("find_ranges.comp", kShader_find_ranges_comp)) {
}

void GlRanges::find_ranges(GlBuffer& keys, const GlCount& count, std::uint32_t bins, GlBuffer& offsets) {
    check_room("the keys of ranges", keys, count);
    if (bins <= kMostGlItems) offsets.grow(sizeof(std::uint32_t) * (std::size_t{bins} + 1));
    check_room("the offsets of ranges", offsets, bins, 1);
    program_.use();
    set_count(count);
    keys.bind(0);
    offsets.bind(1);
    glUniform1ui(kRangeBinsLocation, bins);
    dispatch(bins / kRangeThreads + 1);
}

}  // namespace subvol::detail
