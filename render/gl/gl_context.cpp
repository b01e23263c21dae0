// SPDX-License-Identifier: Apache-2.0
#include "gl_context.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr int kMostErrors = 64;  // a lost context, or none, may report errors without end

OpenedGl open_gl(std::optional<int> index) {
    GlFinder finder;
    const EglState before = EglState::current();
    while (const auto opened = finder.next()) {
        if (!index || opened->device.index == *index) return *opened;
        opened->context.destroy();
    }
    before.restore();
    throw_no_gl(index);
}

std::string error_name(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "an invalid enumerant";
        case GL_INVALID_VALUE:
            return "an invalid value";
        case GL_INVALID_OPERATION:
            return "an invalid operation";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "an incomplete framebuffer";
        default:
            return "error " + std::to_string(error);
    }
}

std::string reset_message(GLenum status) {
    const char* cause = status == GL_GUILTY_CONTEXT_RESET     ? "by this work"
                        : status == GL_INNOCENT_CONTEXT_RESET ? "by other work on it"
                                                              : "for an unknown reason";
    return std::string("the GL device was reset ") + cause;
}

}  // namespace

GlContext::GlContext(std::optional<int> device) : opened_(open_gl(device)) {
}

GlScope::GlScope(const GlContext& context) {
    if (context.make_current()) return;
    throw Error(ErrorCode::MissingCapability, "the GL context is in use by another thread", context.renderer());
}

void check_picture_size(int width, int height, const char* allowed) {
    GLint most = 0;
    std::array<GLint, 2> viewport{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
    most = std::min({most, viewport[0], viewport[1]});
    const int longest = std::max(width, height);
    if (longest <= most) return;
    throw Error(
        ErrorCode::MissingCapability,
        "the GL device draws up to " + std::to_string(most) + " pixels in a row or column, not " + std::to_string(longest), {},
        allowed);
}

std::size_t memory_budget(bool hardware) {
    constexpr std::size_t kUnknown = std::size_t{1} << 31;
    if (!hardware) return kUnknown;  // llvmpipe of Mesa 25 has both extensions, and says 20 MB for 20 GB
    std::array<GLint, 4> kib{};      // ATI's query has four results; the first is the free memory
    if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info"))
        glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, kib.data());
    else if (epoxy_has_gl_extension("GL_ATI_meminfo"))
        glGetIntegerv(GL_VBO_FREE_MEMORY_ATI, kib.data());
    return kib[0] > 0 ? static_cast<std::size_t>(kib[0]) * (1024 * 3 / 4) : kUnknown;
}

GlStorage GlStorage::available() {
    GlStorage found;
    glGetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &found.vertex);
    glGetIntegerv(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, &found.fragment);
    glGetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &found.compute);
    glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &found.bindings);
    return found;
}

void check_storage(const GlStorage& needed, const GlStorage& available, const char* allowed) {
    const auto check = [&](const char* what, int count, int most) {
        if (count <= most) return;
        throw Error(ErrorCode::MissingCapability,
                    "the GL device has " + std::to_string(most) + " storage buffers " + what + "; this work needs " +
                        std::to_string(count),
                    {}, allowed);
    };
    check("for vertex shaders", needed.vertex, available.vertex);
    check("for fragment shaders", needed.fragment, available.fragment);
    check("for compute shaders", needed.compute, available.compute);
    check("at a time", needed.bindings, available.bindings);
}

void check_gl(const std::string& where) {
    constexpr const char* kHint = "use the CPU backend, or a smaller picture";
    GLenum first = glGetError();
    bool no_memory = first == GL_OUT_OF_MEMORY, lost = first == GL_CONTEXT_LOST;
    GLenum error = first;
    for (int i = 0; error != GL_NO_ERROR && i < kMostErrors; ++i) {
        error = glGetError();
        no_memory = no_memory || error == GL_OUT_OF_MEMORY;
        lost = lost || error == GL_CONTEXT_LOST;
    }
    if (const GLenum status = glGetGraphicsResetStatus(); status != GL_NO_ERROR)
        throw Error(ErrorCode::MissingCapability, reset_message(status), where, kHint);
    if (lost) throw Error(ErrorCode::MissingCapability, "the GL device was lost", where, kHint);
    if (no_memory) throw Error(ErrorCode::MissingCapability, "the GL device has no memory left", where, kHint);
    if (first == GL_NO_ERROR) return;
    throw Error(ErrorCode::MissingCapability, "the GL driver reports " + error_name(first), where, "use the CPU backend");
}

}  // namespace subvol::detail
