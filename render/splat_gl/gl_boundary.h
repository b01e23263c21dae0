// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "boundary_intervals.h"
#include "gl_scan.h"
#include "gl_stages.h"

namespace subvol::detail {

/// boundary_intervals() on the current context. Coverage is bitwise the same, depths differ by rounding only. The CPU does
/// surfaces that have to be clipped, those that a ray meets more often than one thread should sort, and those of which the
/// triangles touch more rows of pixels than a dispatch should go through.
class GlBoundary {
public:
    /// on_device: false: the CPU finds all intervals
    explicit GlBoundary(bool on_device);

    /// Starts to find the intervals of a surface, which has to be the same in every call. Waits for the device in the first
    /// call only.
    void find(const Surface& surface, const View& view, double near, double middle, GlStages& stages);

    /// Takes intervals that the CPU has found. Throws as check_for_gl, as `find` does.
    void set(const PixelIntervals& intervals, const View& view);

    /// The number of intervals that there is room for.
    [[nodiscard]] std::size_t room() const;

    /// Whether there was room for all hits, and none of too many in a pixel; if not, they have to be found again. Waits for
    /// the device.
    [[nodiscard]] bool found_all();

    /// The number of hits of the last call.
    [[nodiscard]] std::size_t hits() const { return hits_; }

    /// For each pixel {first, end}; and the {enter, exit} of intervals.
    void bind(GLuint ranges, GLuint intervals);

    /// The result of the shaders, for tests.
    [[nodiscard]] PixelIntervals read(std::size_t pixels) const;

private:
    struct Camera;
    void upload_surface(const Surface& surface);
    void upload_intervals(const PixelIntervals& intervals);
    void count_hits();
    void fill();

    bool on_device_, on_device_now_ = false;
    GlProgram points_program_, strips_program_, plan_program_, count_program_, fill_program_, resolve_program_;
    GlScan scan_;
    Box box_;  // of the surface
    std::size_t points_ = 0, triangles_ = 0, pixels_ = 0, hits_ = 0, room_ = 0;
    GlBuffer camera_, positions_, corners_, eye_points_, boxes_, strips_, strip_total_, plan_, hit_offsets_, counts_,
        intervals_, ranges_;
};

}  // namespace subvol::detail
