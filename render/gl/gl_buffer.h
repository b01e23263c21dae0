// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <utility>

namespace subvol::detail {

/// A buffer of the current context, for shaders to read and write, that can be used again for every frame: it only grows.
///
/// What shaders wrote is seen by upload, read and clear; between two shaders it takes a barrier.
/// Every member throws Error(MissingCapability) if the device has no room, or refuses the call.
class GlBuffer {
public:
    GlBuffer() = default;

    /// Its content is not set.
    explicit GlBuffer(std::size_t bytes) { grow(bytes); }

    /// Made, filled and bound; data may be null: the content is not set.
    GlBuffer(GLuint binding, std::size_t bytes, const void* data);

    ~GlBuffer();
    GlBuffer(GlBuffer&& other) noexcept { swap(other); }
    GlBuffer& operator=(GlBuffer&& other) noexcept {
        swap(other);
        return *this;
    }

    /// Makes room for at least so many bytes. Where there was less, the content is lost and the buffer must be bound again.
    void grow(std::size_t bytes);

    /// To a binding of shaders; an empty buffer gets the least room first.
    void bind(GLuint binding);

    void upload(std::size_t bytes, const void* from, std::size_t at_byte = 0);
    void read(std::size_t bytes, void* to, std::size_t at_byte = 0) const;

    /// All of it to zero.
    void clear();

    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    [[nodiscard]] GLuint id() const { return id_; }

    /// Whether a shader of the current context can see a buffer of so many bytes.
    [[nodiscard]] static bool fits(std::size_t bytes);

private:
    void swap(GlBuffer& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(bytes_, other.bytes_);
    }
    void check_range(std::size_t bytes, std::size_t at_byte) const;

    GLuint id_ = 0;
    std::size_t bytes_ = 0;
};

}  // namespace subvol::detail
