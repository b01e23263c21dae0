// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl_buffer.h"
#include "gl_tets.h"

namespace subvol::detail {

/// Divides a picture into rectangles of whole rows, or of parts of a row, with at most that many fragments each.
///
/// counts: fragments of each pixel, rows one after the other
/// throws: Error(InvalidInput) if a single pixel has more
[[nodiscard]] std::vector<PixelRect> split_into_parts(std::span<const std::uint32_t> counts, int width, int height,
                                                      std::size_t most_fragments);

/// Stores what GlTets draws in a list for each pixel, sorts the lists, and makes the picture from them. Keeps memory from
/// picture to picture. The work of a dispatch is limited, however long the lists are.
class GlTetLists {
public:
    struct Drawn {
        Image image;
        std::size_t fragments = 0, parts = 0;
        std::size_t wrong_pixels = 0;  // where the order of tetrahedra is wrong, or a face too late
        std::size_t late_faces = 0;
    };
    explicit GlTetLists(GlTets& tets) : tets_(tets) {}

    /// Draws the segments of tetrahedra, sorted in each pixel.
    ///
    /// most_fragments: the most that lists hold at a time; the picture is drawn in parts if there are more
    /// cost:           O(n log n) for each list of n
    /// throws:         Error(MissingCapability) if the device has no room
    [[nodiscard]] Drawn draw_tets(std::size_t most_fragments, const DrawStage& stage);

    /// Draws faces, sorted by a k-buffer in each pixel.
    [[nodiscard]] Drawn draw_faces(std::size_t kbuffer, std::size_t most_fragments, const DrawStage& stage);

private:
    using Items = GlTets::Items;

    [[nodiscard]] Drawn draw(Items items, std::size_t most_fragments, const DrawStage& stage);
    [[nodiscard]] std::vector<std::uint32_t> count_fragments(Items items, const DrawStage& stage);
    void draw_part(Items items, const PixelRect& part, const std::vector<std::uint32_t>& counts, Image& image,
                   const DrawStage& stage);
    void sort_part(Items items, const PixelRect& part, const std::vector<std::uint32_t>& offsets);
    void composite_part(Items items, const PixelRect& part, Image& image, const DrawStage& stage);
    void repeat(const GlProgram& program, std::uint32_t pixels, const DrawStage& stage);

    GlTets& tets_;
    std::uint32_t kbuffer_ = 1;
    GlBuffer counts_, offsets_, entries_, ranks_, other_entries_, other_ranks_, blocks_, states_, picture_, counters_;
};

}  // namespace subvol::detail
