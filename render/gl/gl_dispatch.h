// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gl_buffer.h"
#include "gl_program.h"

namespace subvol::detail {

/// Items that a work group of the primitives takes; shaders/gl_groups.glsl has the same.
inline constexpr std::uint32_t kGlBlock = 2048;
/// The most items of a primitive.
inline constexpr std::uint32_t kMostGlItems = 1U << 28;

[[nodiscard]] constexpr std::uint32_t gl_blocks(std::uint32_t items) {
    return (items + kGlBlock - 1) / kGlBlock;
}

/// How many items a primitive works on: a number that the host knows, or one that shaders left in a buffer, which the host then
/// need not wait for.
struct GlCount {
    GlCount(std::uint32_t count) : most(count) {}
    /// word: its place in the buffer, in words of 4 bytes; what exceeds `most_items` is not worked on
    GlCount(const GlBuffer& in, std::uint32_t at_word, std::uint32_t most_items)
        : most(most_items), buffer(&in), word(at_word) {}

    std::uint32_t most;
    const GlBuffer* buffer = nullptr;
    std::uint32_t word = 0;
};

/// throws: Error(InvalidInput) if there may be more than kMostGlItems, or the buffer has less than `most` + `beyond` words
void check_room(const char* what, const GlBuffer& buffer, const GlCount& count, std::uint32_t beyond = 0);

/// A program that may use the common texts: work groups, scans in them, counts, digits.
[[nodiscard]] GlProgram make_primitive(const char* file, const char* source);

/// To the uniforms of shaders/gl_count.glsl in the program that is in use.
void set_count(const GlCount& count);

/// Groups in as many dimensions as it takes; waits for none, but later shaders see what these wrote.
void dispatch(std::uint32_t groups);

/// Likewise, of as many groups as 3 words in a buffer say.
void dispatch(const GlBuffer& plan, std::size_t at_byte);

}  // namespace subvol::detail
