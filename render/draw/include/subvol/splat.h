// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/gl_device.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/rbf_volume.h"
#include "subvol/splat_options.h"
#include "subvol/surface.h"

namespace subvol {

struct SplatReport {
    std::string backend;  // "gl" or "cpu"
    std::string device;   // name of the GL device, or the number of CPU threads
    std::size_t points = 0;
    int sheets = 0;                 // planes over the volume's depth
    int sheets_finest = 0;          // that there would be if all were as close as where most are needed
    std::size_t bin_entries = 0;    // pairs of a tile and a kernel; on a GPU, triples with a batch of sheets
    std::size_t boundary_hits = 0;  // entries and exits over all pixels
    bool kept = false;         // whether kernels, tiles and boundary were those of the picture before: the CPU's, same view
    double seconds_light = 0;  // of the light volume, for shadows and ambient occlusion; a part of seconds_prepare
    double seconds_prepare = 0, seconds_draw = 0;
    double seconds_colors = 0;        // of the boundary's own colours
    std::vector<StageTime> stages{};  // of the GPU
    std::string warning{};            // why the CPU draws in place of a GPU that failed, in the first picture since then
};

struct SplatResult {
    Image image;
    /// For each pixel the mean eye depth of what is seen, weighted by opacity; infinity where nothing is seen.
    std::vector<float> depth;
    SplatReport report;
};

/// Draws an RBF volume. Kernels are summed on image-aligned sheets, rays are clipped to the boundary's entry and exit depths,
/// the transfer function is applied to the reconstructed field, and the stretches between sheets are pre-integrated and
/// composited from front to back. Without a boundary the volume ends where the sum of weights falls to half of its value
/// inside.
///
/// Keeps data that does not depend on the view, and its memory, from picture to picture. With the CPU, pictures from the same
/// view with another transfer function of the same range also share kernels in eye space, tiles and the boundary. The volume is
/// referred to, not copied. Pictures are bitwise the same for any number of threads. Not for several threads at once. throws:
/// Error(InvalidInput) for options out of range, or sizes, values and extinctions beyond 32-bit floats;
///         Error(MissingCapability) if SplatMethod::Gl or Sheets finds no OpenGL 4.5
/// source: docs/science.md
class Splatter {
public:
    explicit Splatter(const RbfVolume& volume, const SplatOptions& options = {});
    ~Splatter();
    Splatter(Splatter&&) noexcept;
    Splatter& operator=(Splatter&&) noexcept;

    /// Cuts the volume of the next pictures open; costs nothing.
    ///
    /// throws: Error(InvalidInput) as `validate`
    void set_clip(const Clip& clip);

    /// Gives the next pictures of a body that is opaque from its boundary on the colours of values there instead of those of
    /// the kernels, as `color_boundary` does. Not with shadows or ambient occlusion, which are those of the kernels: then it
    /// has no effect.
    ///
    /// boundary, values: referred to, not copied; no values: the colours of the kernels again
    void set_boundary_colors(const Surface& boundary, std::span<const double> values);

    /// Draws other kernels from the next picture on, such as those that `choose_level` finds for a view. What belongs to the
    /// boundary or to the device is kept, and so is the sum of weights at which a volume without a boundary ends.
    ///
    /// volume: referred to, not copied; with the boundary of the one before
    /// throws: Error(InvalidInput) if the channels, the kernel or the size of the boundary differ from those before, or a value
    ///         is beyond 32-bit floats
    void set_kernels(const RbfVolume& volume);

    /// progress: listener for this picture; null: that of the options
    [[nodiscard]] SplatResult draw(const View& view, const Optics& optics, Progress* progress = nullptr);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a Splatter.
[[nodiscard]] SplatResult render_splats(const RbfVolume& volume, const View& view, const Optics& optics,
                                        const SplatOptions& options = {});

}  // namespace subvol
