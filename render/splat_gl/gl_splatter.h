// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "splat_scene.h"
#include "subvol/camera.h"
#include "subvol/gl_device.h"

namespace subvol::detail {

/// How the work is divided. The picture does not depend on it.
struct GlTuning {
    int tile_px = 0;  ///< 8 or 16; 0: 8 on hardware, where small groups wait less for each other, else 16
    /// Sheets of a batch, 1..16; 0: 4 on hardware, where more of fewer sums fit at a time, else 8. Where a picture has more
    /// sheets than its stack, it depends on batches that do not divide 8.
    int batch = 0;
    std::size_t most_buffer_bytes = std::size_t{1} << 31;  ///< limit for a buffer, if the device has no lower one
    std::size_t memory_bytes = 0;                          ///< limit for kernels and lists together; 0: memory_budget()
    std::size_t most_entries = std::size_t{1} << 26;       ///< limit for the pairs of a bin and a kernel
    std::uint32_t most_tiles = 1U << 16;                   ///< limit for the tiles of a dispatch
    /// A thread of a dispatch ends soon after so many iterations of loops, or earlier where the device is slow; at least 64 for
    /// each sheet of a batch. Software ends them after 2¹⁴.
    std::uint32_t most_steps = 1U << 18;
    /// Rasterize the boundary with OpenGL even if it is software, where the CPU's rasterizer is faster.
    bool boundary_on_device = false;
};

struct GlSplatReport {
    int sheets = 0, sheets_finest = 0;  // as in SplatReport
    std::size_t bin_entries = 0;        // (tile, batch, kernel)
    std::size_t boundary_hits = 0;      // entries and exits over all pixels
    int passes = 0;
    int lists = 0;                  // of kernels by tiles that were made; 0 if the camera is that of the picture before
    std::size_t dispatches = 0;     // that draw
    std::size_t tiles = 0;          // of all these dispatches together
    std::vector<StageTime> stages;  // measured by the device
};

/// The splatter on an OpenGL device: the same steps as on the CPU, with other rounding. Data that does not depend on the view
/// is uploaded once. The scene is referred to, not copied.
///
/// If a buffer is too small, the picture is drawn in passes over ranges of batches, front to back. The work of a dispatch is
/// limited, however many kernels a tile has: Mesa's software ends loops after 2¹⁶ iterations, and desktops reset devices that
/// take too long. Pictures are bitwise reproducible, whatever the tuning.
class GlSplatter {
public:
    /// device: as for GlContext
    /// throws: Error(MissingCapability) if there is no such device or it has no room
    GlSplatter(const SplatScene& scene, std::optional<int> device, const GlTuning& tuning = {});
    ~GlSplatter();
    GlSplatter(GlSplatter&&) noexcept;
    GlSplatter& operator=(GlSplatter&&) noexcept;

    /// Uploads the kernels of the scene again: it has others.
    ///
    /// throws: Error(MissingCapability) if the device has no room or is lost
    void upload_kernels();

    /// throws: Error(MissingCapability) if the device has no room or is lost
    [[nodiscard]] Drawn draw(const View& view, const Classification& classification, int sheets, Progress* progress);

    /// Whether drawing or uploading has failed: the context may be lost, and another splatter should take over.
    [[nodiscard]] bool failed() const;

    [[nodiscard]] const std::string& renderer() const;

    /// The report of the last picture.
    [[nodiscard]] const GlSplatReport& report() const;

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
