// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <array>

#include "sheet_lists.h"

namespace subvol::detail {

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

    /// Sets a rectangle to zero, and restricts drawing to it.
    void clear(const PixelRect& rect);

private:
    void make(int width, int height, bool four_more);
    void release();

    GLuint framebuffer_ = 0;
    std::array<GLuint, 2> textures_{};
    int width_ = 0, height_ = 0;
    bool four_more_ = false;
};

}  // namespace subvol::detail
