// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "gl_buffer.h"

namespace subvol::detail {

/// The first word of a buffer of the current context, which arrives at the host while the device goes on with later work.
class GlEcho {
public:
    GlEcho() = default;
    ~GlEcho();
    GlEcho(const GlEcho&) = delete;
    GlEcho& operator=(const GlEcho&) = delete;

    /// Asks for the word as it will be after the work that the device has got so far, and returns the answer to the last
    /// request, for which it waits; nothing if there was none.
    ///
    /// throws: Error(MissingCapability) if the device has no room or is lost
    std::optional<std::uint32_t> ask(const GlBuffer& buffer);

    /// Forgets the last request.
    void reset();

private:
    void make();
    [[nodiscard]] std::optional<std::uint32_t> wait();

    GLuint id_ = 0;
    const volatile std::uint32_t* word_ = nullptr;  // mapped as long as this object lives
    GLsync fence_ = nullptr;
};

}  // namespace subvol::detail
