// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gl_ranges.h"
#include "gl_scan.h"
#include "gl_sort.h"
#include "gl_splat_frame.h"
#include "gl_splat_kernels.h"
#include "gl_stages.h"

namespace subvol::detail {

/// Converts kernels to eye space and lists them by bins (tile, batch) in ascending order, on the current context. The frame's
/// uniforms have to be bound.
class GlSplatBins {
public:
    GlSplatBins(const std::string& defines, std::uint32_t extras);

    /// The most bytes that a kernel takes in any buffer.
    [[nodiscard]] static std::size_t kernel_bytes(std::uint32_t extras);

    void upload(const GlKernelData& data);
    [[nodiscard]] std::uint32_t kernels() const { return kernels_; }

    /// Converts kernels to eye space, and counts the entries of each.
    void count(GlStages& stages);

    /// The number of entries of the last count; inexact beyond 2³² − 1. Waits for the device.
    [[nodiscard]] std::uint64_t entries() const;

    /// Lists the entries by bins, at most as many as the frame allows.
    void list(const GlSplatFrame& frame, GlStages& stages);

    /// Binds the buffers for the shader that draws.
    void bind();

private:
    std::uint32_t kernels_ = 0, extras_;
    GlProgram eye_, emit_;
    GlScan scan_;
    GlSort sort_;
    GlRanges find_;
    GlBuffer kernel_buffer_, kernel_extras_, splats_, splat_extras_, ranges_, rects_, counts_, total_, keys_, ids_, offsets_;
};

}  // namespace subvol::detail
