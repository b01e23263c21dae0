// SPDX-License-Identifier: Apache-2.0
#include "gl_dispatch.h"

#include "shader_gl_count_glsl.h"
#include "shader_gl_group_scan_glsl.h"
#include "shader_gl_groups_glsl.h"
#include "shader_sort_digit_glsl.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr GLuint kCountBinding = 7;
constexpr std::uint32_t kMostInRow = 1024;  // as in shaders/gl_groups.glsl

void show_to_later_shaders() {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
}

}  // namespace

void check_room(const char* what, const GlBuffer& buffer, const GlCount& count, std::uint32_t beyond) {
    if (count.most > kMostGlItems) {
        throw Error(ErrorCode::InvalidInput, std::to_string(count.most) + " items are too many", what,
                    "at most " + std::to_string(kMostGlItems));
    }
    const std::size_t needed = sizeof(std::uint32_t) * (std::size_t{count.most} + beyond);
    if (buffer.bytes() >= needed) return;
    throw Error(ErrorCode::InvalidInput,
                "a buffer of " + std::to_string(buffer.bytes()) + " bytes holds less than " + std::to_string(needed), what);
}

GlProgram make_primitive(const char* file, const char* source) {
    return {file,
            source,
            {},
            {{"gl_groups.glsl", kShader_gl_groups_glsl},
             {"gl_group_scan.glsl", kShader_gl_group_scan_glsl},
             {"gl_count.glsl", kShader_gl_count_glsl},
             {"sort_digit.glsl", kShader_sort_digit_glsl}}};
}

void set_count(const GlCount& count) {
    glUniform1ui(0, count.most);
    glUniform1i(1, count.buffer ? static_cast<GLint>(count.word) : -1);
    if (count.buffer) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kCountBinding, count.buffer->id());
}

void dispatch(std::uint32_t groups) {
    const std::uint32_t y = (groups + kMostInRow - 1) / kMostInRow;
    if (groups > 0) glDispatchCompute((groups + y - 1) / y, y, 1);
    show_to_later_shaders();
}

void dispatch(const GlBuffer& plan, std::size_t at_byte) {
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, plan.id());
    glDispatchComputeIndirect(static_cast<GLintptr>(at_byte));
    show_to_later_shaders();
}

}  // namespace subvol::detail
