// SPDX-License-Identifier: Apache-2.0
#include "gl_echo.h"

#include "gl_context.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr GLsizeiptr kWord_bytes = sizeof(std::uint32_t);
constexpr GLuint64 kSlice_ns = 100'000'000;  // after which a lost device is noticed

}  // namespace

GlEcho::~GlEcho() {
    if (id_ == 0) return;
    reset();
    glDeleteBuffers(1, &id_);
}

void GlEcho::make() {
    constexpr GLbitfield kMapped = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glCreateBuffers(1, &id_);
    glNamedBufferStorage(id_, kWord_bytes, nullptr, kMapped);
    word_ = static_cast<const std::uint32_t*>(glMapNamedBufferRange(id_, 0, kWord_bytes, kMapped));
    check_gl("a buffer that is mapped");
    if (word_ == nullptr)
        throw Error(ErrorCode::MissingCapability, "the GL device cannot map a buffer", {}, "use the CPU backend");
}

void GlEcho::reset() {
    if (fence_ != nullptr) glDeleteSync(fence_);
    fence_ = nullptr;
}

std::optional<std::uint32_t> GlEcho::wait() {
    if (fence_ == nullptr) return std::nullopt;
    GLenum status = GL_TIMEOUT_EXPIRED;
    while (status == GL_TIMEOUT_EXPIRED) {
        status = glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, kSlice_ns);
        if (status == GL_TIMEOUT_EXPIRED || status == GL_WAIT_FAILED) check_gl("waiting for the GL device");
    }
    reset();
    if (status == GL_WAIT_FAILED) return std::nullopt;
    return *word_;
}

std::optional<std::uint32_t> GlEcho::ask(const GlBuffer& buffer) {
    if (word_ == nullptr) make();
    const auto answer = wait();
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(buffer.id(), id_, 0, 0, kWord_bytes);
    fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    return answer;
}

}  // namespace subvol::detail
