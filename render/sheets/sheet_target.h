// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <array>

#include "sheet_lists.h"

namespace subvol::detail {

/// The buffer that a sheet is summed in, of the current context: two floats a pixel, and four more where asked for.
class SheetTarget {
public:
    SheetTarget() = default;
    ~SheetTarget() {
        if (framebuffer_ != 0) release();
    }
    SheetTarget(const SheetTarget&) = delete;
    SheetTarget& operator=(const SheetTarget&) = delete;

    /// Makes room for a picture and makes it what is drawn into, all of it zero; what is drawn adds up.
    ///
    /// throws: Error(MissingCapability) if the device cannot
    void begin(int width, int height, bool four_more);

    /// Zero in a rectangle, which is also all that will be drawn into.
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
