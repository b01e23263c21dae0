// SPDX-License-Identifier: Apache-2.0
#include "gl_splat_bins.h"

#include <algorithm>
#include <bit>

#include "shader_gl_groups_glsl.h"
#include "shader_splat_emit_comp.h"
#include "shader_splat_eye_comp.h"
#include "shader_splat_frame_glsl.h"
#include "work_groups.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kSplat_bytes = 64, kVector_bytes = 16;

GlProgram bins_program(const char* file, const char* source, const std::string& defines) {
    return {
        file, source, defines, {{"gl_groups.glsl", kShader_gl_groups_glsl}, {"splat_frame.glsl", kShader_splat_frame_glsl}}};
}

}  // namespace

GlSplatBins::GlSplatBins(const std::string& defines, std::uint32_t extras)
    : extras_(extras),
      eye_(bins_program("splat_eye.comp", kShader_splat_eye_comp, defines)),
      emit_(bins_program("splat_emit.comp", kShader_splat_emit_comp, defines)),
      total_(2 * kWord_bytes) {
}

std::size_t GlSplatBins::kernel_bytes(std::uint32_t extras) {
    return std::max(kSplat_bytes, extras * kVector_bytes);
}

void GlSplatBins::upload(const GlKernelData& data) {
    kernels_ = static_cast<std::uint32_t>(data.kernels.size() / GlKernelData::kFloats);
    kernel_buffer_.grow(data.kernels.size() * sizeof(float));
    kernel_buffer_.upload(data.kernels.size() * sizeof(float), data.kernels.data());
    if (extras_ > 0) {
        kernel_extras_.grow(data.extras.size() * sizeof(float));
        kernel_extras_.upload(data.extras.size() * sizeof(float), data.extras.data());
    }
    const std::size_t count = kernels_;
    splats_.grow(count * kSplat_bytes);
    splat_extras_.grow(count * extras_ * kVector_bytes);
    ranges_.grow(count * 2 * kWord_bytes);
    rects_.grow(count * kVector_bytes);
    counts_.grow((count + 1) * kWord_bytes);
}

void GlSplatBins::count(GlStages& stages) {
    stages.begin("kernels");
    total_.clear();
    eye_.use();
    kernel_buffer_.bind(0);
    kernel_extras_.bind(1);
    splats_.bind(2);
    splat_extras_.bind(3);
    ranges_.bind(4);
    rects_.bind(5);
    counts_.bind(6);
    total_.bind(7);
    dispatch(groups_for(kernels_));
    stages.begin("bins");
    scan_.exclusive_scan(counts_, kernels_);
    stages.begin("");
}

std::uint64_t GlSplatBins::entries() const {
    std::uint32_t words[2];
    total_.read(sizeof words, words);
    return std::uint64_t{words[1]} << 32 | words[0];
}

void GlSplatBins::list(const GlSplatFrame& frame, GlStages& stages) {
    const std::uint32_t most = frame.most_entries;
    stages.begin("bins");
    keys_.grow(std::size_t{most} * kWord_bytes);
    ids_.grow(std::size_t{most} * kWord_bytes);
    emit_.use();
    counts_.bind(0);
    rects_.bind(1);
    keys_.bind(2);
    ids_.bind(3);
    dispatch(groups_for(most));
    stages.begin("sort");
    const GlCount entries(counts_, kernels_, most);
    const std::uint32_t bins = frame.bins();
    sort_.radix_sort(keys_, ids_, entries, std::max(1, static_cast<int>(std::bit_width(bins - 1))));
    find_.find_ranges(keys_, entries, bins, offsets_);
    stages.begin("");
}

void GlSplatBins::bind() {
    splats_.bind(0);
    splat_extras_.bind(1);
    ranges_.bind(2);
    offsets_.bind(3);
    ids_.bind(4);
}

}  // namespace subvol::detail
