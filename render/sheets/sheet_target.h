// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>
#include <array>
#include <cstdint>
#include <vector>

#include "pixel_tiles.h"
#include "splat_frame.h"

namespace subvol::detail {

/// The kernels that sheets cut, in their order, and the pixels that they may touch: sheet first + k has
/// splats[offsets[k] .. offsets[k + 1]), which draw about fragments[k].
struct SheetLists {
    std::vector<PixelRect> rects;
    std::vector<std::size_t> fragments;
    std::vector<std::size_t> offsets;
    std::vector<std::uint32_t> splats;
};

/// A rectangle around the pixels whose rays meet the boundary; the whole picture if there is no boundary.
[[nodiscard]] PixelRect seen_pixels(const SplatFrame& frame);

/// Lists the kernels of a frame that touch `window` by the sheets first..last − 1 (a counting sort). The result is the same for
/// any number of threads.
[[nodiscard]] SheetLists list_sheets(const SplatFrame& frame, const PixelRect& window, int first, int last);

/// The buffer of the current context in which a sheet is summed: two floats for each pixel, or six.
class SheetTarget {
public:
    SheetTarget() = default;
    ~SheetTarget() {
        if (framebuffer_ != 0) release();
    }
    SheetTarget(const SheetTarget&) = delete;
    SheetTarget& operator=(const SheetTarget&) = delete;

    /// Makes room for a picture, sets it to zero and makes it the target, in which everything drawn adds up.
    ///
    /// four_more: six floats for each pixel
    /// throws:    Error(MissingCapability) if the device cannot draw into it
    void begin(int width, int height, bool four_more);

    /// Sets a rectangle to zero, and restricts drawing to it. It is the target again.
    void clear(const PixelRect& rect);

    /// Lets shaders read what has been drawn: the textures that they read must not be those of the target.
    void detach() const { glBindFramebuffer(GL_FRAMEBUFFER, 0); }

private:
    void make(int width, int height, bool four_more);
    void release();

    GLuint framebuffer_ = 0;
    std::array<GLuint, 2> textures_{};
    int width_ = 0, height_ = 0;
    bool four_more_ = false;
};

}  // namespace subvol::detail
