// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gl_buffer.h"
#include "gl_program.h"

namespace subvol::detail {

/// Items of a work group of the primitives; the same as in shaders/gl_groups.glsl.
inline constexpr std::uint32_t kGlBlock = 2048;
/// The most items that a primitive can work on.
inline constexpr std::uint32_t kMostGlItems = 1U << 28;

[[nodiscard]] constexpr std::uint32_t gl_blocks(std::uint32_t items) {
    return (items + kGlBlock - 1) / kGlBlock;
}

/// How many items a primitive works on: a number that the host knows, or one that shaders wrote to a buffer, so that the host
/// does not wait for it.
struct GlCount {
    GlCount(std::uint32_t count) : most(count) {}
    /// word: where the number is in the buffer, in words of 4 bytes; items beyond `most_items` are ignored
    GlCount(const GlBuffer& in, std::uint32_t at_word, std::uint32_t most_items)
        : most(most_items), buffer(&in), word(at_word) {}

    std::uint32_t most;
    const GlBuffer* buffer = nullptr;
    std::uint32_t word = 0;
};

/// throws: Error(InvalidInput) if there may be more than kMostGlItems, or the buffer has fewer than `most` + `beyond` words
void check_room(const char* what, const GlBuffer& buffer, const GlCount& count, std::uint32_t beyond = 0);

/// A program that can use the common texts: work groups, scans within a group, counts, digits.
[[nodiscard]] GlProgram make_primitive(const char* file, const char* source);

/// Sets the uniforms of shaders/gl_count.glsl in the program that is in use.
void set_count(const GlCount& count);

/// Runs that many groups, over two dimensions if needed. Does not wait; later shaders see what these wrote.
void dispatch(std::uint32_t groups);

/// The same with the numbers of groups in 3 words of a buffer.
void dispatch(const GlBuffer& plan, std::size_t at_byte);

}  // namespace subvol::detail
