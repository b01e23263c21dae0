// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drawn.h"
#include "splat_scene.h"
#include "subvol/camera.h"
#include "subvol/gl_device.h"

namespace subvol::detail {

/// How the work is cut up. The picture does not depend on it.
///
/// tile_px: 8, 16; batch: sheets, 1..16
/// most_buffer_bytes: of a buffer, if the device does not set a lower limit; most_entries: pairs of a bin and a kernel
/// boundary_on_device: also if it is software, whose rasterizer for boundaries is slower than the CPU's own
struct GlTuning {
    int tile_px = 16;
    int batch = kBatch;
    std::size_t most_buffer_bytes = std::size_t{1} << 31;
    std::size_t most_entries = std::size_t{1} << 26;
    bool boundary_on_device = false;
};

struct GlSplatReport {
    std::size_t bin_entries = 0;    // (tile, batch, kernel)
    std::size_t boundary_hits = 0;  // entries and exits over all pixels
    int passes = 0;
    std::vector<StageTime> stages;  // by the device's clock
};

/// The splatter on an OpenGL device: step for step what the CPU does, all but rounding. What does not depend on the view is
/// there from the start. The scene has to stay where it is.
///
/// What a buffer cannot hold is drawn in passes over ranges of batches, front to back. Pictures are bitwise the same every
/// time, whatever the tuning.
class GlSplatter {
public:
    /// device: as for GlContext
    /// throws: Error(MissingCapability) if there is no such device or it has no room
    GlSplatter(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning = {});
    ~GlSplatter();
    GlSplatter(GlSplatter&&) noexcept;
    GlSplatter& operator=(GlSplatter&&) noexcept;

    /// throws: Error(MissingCapability) if the device has no room or is lost
    [[nodiscard]] Drawn draw(const View& view, const Classification& classification, int sheets, Progress* progress);

    [[nodiscard]] const std::string& renderer() const;

    /// About the last picture.
    [[nodiscard]] const GlSplatReport& report() const;

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
