// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <utility>

namespace subvol::detail {

/// A storage buffer of the current context that shaders read and write. It only grows, so that frames can share it.
///
/// `upload`, `read` and `clear` see what shaders wrote before; between two shaders the caller sets a barrier. What draws under
/// way read is uploaded into another buffer: NVIDIA's driver overwrites one that is not bound at once. Every member throws
/// Error(MissingCapability) if the device has no room or refuses the call; failures of `upload` and `clear` are noticed by the
/// next one that makes room or reads, as asking the driver each time would cost more than the call.
class GlBuffer {
public:
    GlBuffer() = default;

    /// The content is undefined.
    explicit GlBuffer(std::size_t bytes) { grow(bytes); }

    /// Makes, fills and binds a buffer; if data is null, the content is undefined.
    GlBuffer(GLuint binding, std::size_t bytes, const void* data);

    ~GlBuffer();
    GlBuffer(GlBuffer&& other) noexcept { swap(other); }
    GlBuffer& operator=(GlBuffer&& other) noexcept {
        swap(other);
        return *this;
    }

    /// Makes room for at least that many bytes. If the buffer was smaller, its content is lost and it must be bound again.
    void grow(std::size_t bytes);

    /// Binds it for shaders; an empty buffer gets the smallest possible room first.
    void bind(GLuint binding);

    void upload(std::size_t bytes, const void* from, std::size_t at_byte = 0);

    /// Waits for the device. What a large buffer holds comes through memory that the device writes directly, which is kept.
    void read(std::size_t bytes, void* to, std::size_t at_byte = 0) const;

    /// Sets all of it to zero.
    void clear();

    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    [[nodiscard]] GLuint id() const { return id_; }

    /// Whether a shader of the current context can use a buffer of that many bytes.
    [[nodiscard]] static bool fits(std::size_t bytes);

private:
    void swap(GlBuffer& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(bytes_, other.bytes_);
        std::swap(mapped_, other.mapped_);
        std::swap(mapped_bytes_, other.mapped_bytes_);
    }
    void check_range(std::size_t bytes, std::size_t at_byte) const;
    void read_mapped(std::size_t bytes, void* to, std::size_t at_byte) const;

    GLuint id_ = 0;
    std::size_t bytes_ = 0;
    mutable GLuint mapped_ = 0;  // a buffer in the host's memory, into which much is copied before it is read
    mutable std::size_t mapped_bytes_ = 0;
};

}  // namespace subvol::detail
