// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "gl_buffer.h"
#include "gl_program.h"
#include "sheet_target.h"

namespace subvol::detail {

/// The splatter with sheet buffers, on the current context: for every sheet, front to back, the sections of the kernels that it
/// cuts are drawn as rectangles that add up in a buffer of floats; then the buffer is classified and composited. It has every
/// feature of the CPU's splatter and follows the same rules; programs and memory are kept from picture to picture.
///
/// Pictures are bitwise reproducible: kernels are added up in their order.
/// cost:   one draw and one dispatch for each sheet, each over the sheet's rectangle only
/// source: mnmq2007, docs/science.md
class GlSheets {
public:
    GlSheets();
    ~GlSheets();
    GlSheets(const GlSheets&) = delete;
    GlSheets& operator=(const GlSheets&) = delete;

    /// throws: Error(MissingCapability) if the device has no room for kernels, boundary or picture
    [[nodiscard]] Drawn draw(const SplatFrame& frame, Progress* progress);

private:
    struct Programs {
        GlProgram kernels, composite;
    };

    const Programs& programs(const SplatFrame& frame);
    void upload(const SplatFrame& frame);
    void start_beams(const SplatFrame& frame);
    void draw_kernels(const SplatFrame& frame, const GlProgram& program, int sheet, const SheetLists& lists, std::size_t at);
    void composite(const SplatFrame& frame, const GlProgram& program, int sheet, const PixelRect& rect);
    [[nodiscard]] std::uint32_t done_pixels() const;
    [[nodiscard]] Drawn read(const SplatFrame& frame) const;

    std::map<std::string, Programs> programs_;  // by their defines
    SheetTarget target_;
    GLuint vertices_ = 0;
    GlBuffer splats_, bends_, colors_, color_bends_, axes_, kernel_table_;
    GlBuffer table_, visible_, color_table_, interval_offsets_, intervals_, ends_;
    GlBuffer beams_, lasts_, looks_, done_, ids_;
};

}  // namespace subvol::detail
