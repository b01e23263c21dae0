// SPDX-License-Identifier: Apache-2.0
#include "gl_sort.h"

#include <algorithm>
#include <cassert>
#include <utility>

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

}  // namespace subvol::detail
