// SPDX-License-Identifier: Apache-2.0
#include "gl_scan.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "shader_find_ranges_comp.h"
#include "shader_scan_blocks_comp.h"
#include "shader_scan_plan_comp.h"
#include "shader_scan_sums_comp.h"
#include "shader_sort_count_comp.h"
#include "shader_sort_move_comp.h"
#include "shader_sort_plan_comp.h"

namespace subvol::detail {

namespace {

constexpr int kDigitBits = 8;
constexpr GLint kBinsLocation = 2, kShiftLocation = 4, kBitsLocation = 5;
constexpr std::uint32_t kCountsWord = 4;  // of the plan: the number of digit counts

void use_for_digit(const GlProgram& program, int shift, int bits) {
    program.use();
    glUniform1ui(kShiftLocation, static_cast<GLuint>(shift));
    glUniform1ui(kBitsLocation, static_cast<GLuint>(bits));
}

}  // namespace

GlSort::GlSort()
    : plan_program_(make_primitive("sort_plan.comp", kShader_sort_plan_comp)),
      count_program_(make_primitive("sort_count.comp", kShader_sort_count_comp)),
      move_program_(make_primitive("sort_move.comp", kShader_sort_move_comp)) {
}

void GlSort::radix_sort(GlBuffer& keys, GlBuffer& values, const GlCount& count, int bits) {
    assert(bits >= 1 && bits <= 32);
    check_room("the keys of a sort", keys, count);
    check_room("the values of a sort", values, count);
    if (count.most == 0) return;
    other_keys_.grow(keys.bytes());
    other_values_.grow(values.bytes());
    int planned = 0;
    for (int shift = 0; shift < bits; shift += kDigitBits) {
        const int digit = std::min(kDigitBits, bits - shift);
        if (digit != planned) plan(count, digit);
        planned = digit;
        pass(keys, values, shift, digit);
    }
}

void GlSort::plan(const GlCount& count, int bits) {
    const std::uint32_t bins = 1U << bits, most_counts = bins * gl_blocks(count.most);
    plan_.grow(sizeof(std::uint32_t) * 2 * 4);
    counts_.grow(sizeof(std::uint32_t) * (most_counts + 1));
    plan_program_.use();
    set_count(count);
    plan_.bind(0);
    glUniform1ui(kBinsLocation, bins);
    dispatch(1);
    scan_.plan({plan_, kCountsWord, most_counts});
}

void GlSort::pass(GlBuffer& keys, GlBuffer& values, int shift, int bits) {
    use_for_digit(count_program_, shift, bits);
    keys.bind(0);
    counts_.bind(1);
    plan_.bind(2);
    dispatch(plan_, 0);
    scan_.scan_as_planned(counts_);

    use_for_digit(move_program_, shift, bits);
    keys.bind(0);
    values.bind(1);
    other_keys_.bind(2);
    other_values_.bind(3);
    counts_.bind(4);
    plan_.bind(5);
    dispatch(plan_, 0);
    std::swap(keys, other_keys_);
    std::swap(values, other_values_);
}

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

namespace {

constexpr std::size_t kPlan_bytes = 16;  // for each level
constexpr GLint kLevelLocation = 2, kTopLocation = 3;

}  // namespace

GlScan::GlScan()
    : plan_program_(make_primitive("scan_plan.comp", kShader_scan_plan_comp)),
      sums_program_(make_primitive("scan_sums.comp", kShader_scan_sums_comp)),
      blocks_program_(make_primitive("scan_blocks.comp", kShader_scan_blocks_comp)) {
}

void GlScan::exclusive_scan(GlBuffer& values, const GlCount& count) {
    check_room("a scan", values, count, 1);
    plan(count);
    scan_as_planned(values);
}

void GlScan::plan(const GlCount& count) {
    levels_ = 1;
    for (std::uint32_t items = count.most + 1; items > kGlBlock; ++levels_) {
        items = gl_blocks(items);
        if (sums_.size() < levels_) sums_.emplace_back();
        sums_[levels_ - 1].grow(sizeof(std::uint32_t) * items);
    }
    plan_.grow(levels_ * kPlan_bytes);
    plan_program_.use();
    set_count(count);
    plan_.bind(0);
    glUniform1ui(kLevelLocation, static_cast<GLuint>(levels_));
    dispatch(1);
}

void GlScan::dispatch_level(const GlProgram& program, GlBuffer& values, std::size_t level) {
    program.use();
    glUniform1ui(kLevelLocation, static_cast<GLuint>(level));
    (level == 0 ? values : sums_[level - 1]).bind(0);
    if (level + 1 < levels_) sums_[level].bind(1);
    plan_.bind(2);
    dispatch(plan_, level * kPlan_bytes);
}

void GlScan::scan_as_planned(GlBuffer& values) {
    assert(levels_ > 0);
    for (std::size_t level = 0; level + 1 < levels_; ++level) dispatch_level(sums_program_, values, level);
    for (std::size_t level = levels_; level-- > 0;) {
        blocks_program_.use();
        glUniform1i(kTopLocation, level + 1 == levels_);
        dispatch_level(blocks_program_, values, level);
    }
}

}  // namespace subvol::detail
