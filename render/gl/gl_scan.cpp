// SPDX-License-Identifier: Apache-2.0
#include "gl_scan.h"

#include <cassert>

#include "shader_scan_blocks_comp.h"
#include "shader_scan_plan_comp.h"
#include "shader_scan_sums_comp.h"

namespace subvol::detail {

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
