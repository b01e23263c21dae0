// SPDX-License-Identifier: Apache-2.0
#include "gl_buffer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <string>

#include "gl_context.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMuch_bytes = std::size_t{1} << 18;
constexpr std::size_t kGranule_bytes = 16;  // a shader may declare the buffer as vectors of four words

std::size_t largest_block() {
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    return most > 0 ? static_cast<std::size_t>(most) : 0;
}

GLsizeiptr size(std::size_t bytes) {
    return static_cast<GLsizeiptr>(bytes);
}

}  // namespace

GlBuffer::GlBuffer(GLuint binding, std::size_t bytes, const void* data) {
    grow(bytes);
    if (data) upload(bytes, data);
    bind(binding);
}

GlBuffer::~GlBuffer() {
    if (id_ != 0) glDeleteBuffers(1, &id_);
    if (mapped_ != 0) glDeleteBuffers(1, &mapped_);
}

bool GlBuffer::fits(std::size_t bytes) {
    return bytes <= largest_block();
}

void GlBuffer::grow(std::size_t bytes) {
    if (bytes <= bytes_) return;
    if (!fits(bytes)) {
        throw Error(ErrorCode::MissingCapability,
                    "the GL device takes buffers of at most " + std::to_string(largest_block()) + " bytes; this work needs " +
                        std::to_string(bytes),
                    {}, "use the CPU backend");
    }
    const std::size_t room = (bytes + kGranule_bytes - 1) / kGranule_bytes * kGranule_bytes;
    const std::string where = "a buffer of " + std::to_string(room) + " bytes";
    check_gl("earlier work");
    *this = GlBuffer();  // frees the old buffer before the new one is made
    GlBuffer grown;
    glCreateBuffers(1, &grown.id_);
    glNamedBufferStorage(grown.id_, size(room), nullptr, GL_DYNAMIC_STORAGE_BIT);
    check_gl(where);
    grown.bytes_ = room;
    swap(grown);
}

void GlBuffer::bind(GLuint binding) {
    grow(1);  // an empty buffer cannot be bound
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_);
}

void GlBuffer::check_range(std::size_t bytes, std::size_t at_byte) const {
    assert(at_byte <= bytes_ && bytes <= bytes_ - at_byte);
    (void)bytes, (void)at_byte;
}

void GlBuffer::upload(std::size_t bytes, const void* from, std::size_t at_byte) {
    check_range(bytes, at_byte);
    if (bytes == 0) return;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glNamedBufferSubData(id_, static_cast<GLintptr>(at_byte), size(bytes), from);
}

void GlBuffer::read(std::size_t bytes, void* to, std::size_t at_byte) const {
    check_range(bytes, at_byte);
    if (bytes == 0) return;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    if (bytes_ >= kMuch_bytes) {  // a few bytes of it, too: NVIDIA's driver takes long for them otherwise
        read_mapped(bytes, to, at_byte);
    } else {
        glGetNamedBufferSubData(id_, static_cast<GLintptr>(at_byte), size(bytes), to);
    }
    check_gl("reading from the GL device");
}

void GlBuffer::read_mapped(std::size_t bytes, void* to, std::size_t at_byte) const {
    if (bytes > mapped_bytes_) {
        if (mapped_ != 0) glDeleteBuffers(1, &mapped_);
        glCreateBuffers(1, &mapped_);
        glNamedBufferStorage(mapped_, size(bytes), nullptr, GL_MAP_READ_BIT | GL_CLIENT_STORAGE_BIT);
        mapped_bytes_ = bytes;
        check_gl("a buffer of " + std::to_string(bytes) + " bytes to read from");
    }
    glCopyNamedBufferSubData(id_, mapped_, static_cast<GLintptr>(at_byte), 0, size(bytes));
    const auto* from = static_cast<const char*>(glMapNamedBufferRange(mapped_, 0, size(bytes), GL_MAP_READ_BIT));
    if (!from) return;  // the caller checks for errors
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes, kMuch_bytes), [&](const auto& part) {
        std::copy(from + part.begin(), from + part.end(), static_cast<char*>(to) + part.begin());
    });
    glUnmapNamedBuffer(mapped_);
}

void GlBuffer::clear() {
    if (bytes_ == 0) return;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

}  // namespace subvol::detail
