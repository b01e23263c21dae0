// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "corner_normals.h"
#include "light_volume.h"
#include "subvol/camera.h"
#include "subvol/detail/preintegrated_table.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/reach_counts.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/rbf_field.h"
#include "subvol/rbf_volume.h"
#include "subvol/splat_options.h"

namespace subvol::detail {

// Rules of reconstruction and classification for all backends; shaders get these numbers and kLeastWeight as defines.

/// Two values nearer than this many cells of the table are replaced by their mean: the difference quotient would lose digits.
inline constexpr float kNearValues = 0.5f;
/// Transmittance below which a pixel is opaque. What lies behind can change a colour by no more than this: a fortieth of a step
/// of an 8-bit picture, and less than what sheets change.
inline constexpr float kSplatCutoff = 1e-4f;
/// Values further out, in cells of the table, are clamped to this.
inline constexpr float kFarCells = 1e12f;
/// Stands for a value that is not known.
inline constexpr float kUnknownValue = 3e38f;
/// Kernels with larger numbers in eye space are not summed at the ends of intervals: their squares would overflow.
inline constexpr float kMostOfKernel = 1e18f;
/// A stretch of a higher optical depth is composited in steps, as its front hides its back.
inline constexpr float kThickDepth = 0.5f;
/// The part of that depth at which steps aim, so that rounding does not decide whether a step is thin enough.
inline constexpr float kAimedDepth = 0.45f;
/// The optical depth at which a pixel is opaque: −ln kSplatCutoff.
inline constexpr float kOpaqueDepth = 9.2103404f;
/// A volume is opaque where a ray enters it if all light ends within this part of a pixel; what lies deeper is not sampled.
inline constexpr float kSkin_px = 0.05f;
/// The same for the eye inside a volume, where a pixel has no width: in parts of the volume's diagonal.
inline constexpr double kSolidSkin = 1e-3;
/// The gradient at which shading has half its effect, in parts of the range for each diagonal of the volume.
inline constexpr float kLeastChange = 0.25f;
/// The number of sheets that are summed together; the picture does not depend on it.
inline constexpr int kBatch = 8;

/// How a kernel is evaluated. Compact: w = (1−e)³. Radial: a table over e. Separable: a product of one table over |ξ| along
/// three axes.
enum class KernelForm { Compact, Radial, Separable };

/// The part of what is drawn that depends on neither view nor transfer function.
struct SplatScene {
    const RbfVolume* volume = nullptr;
    std::size_t channel = 0;  // whose values give the opacity, and the colour too unless there is a
    std::optional<std::size_t> color_channel{};
    float largest_value = 0, largest_color = 0;  // absolute, of the kernels in both channels
    KernelForm form = KernelForm::Compact;
    std::vector<float> kernel_table{};  // equally spaced over e or |ξ| / radius in [0,1]; the last is 0
    bool bent = false;                  // channels have Hessians
    bool normalized = true;
    double image_tolerance = 1e-3;
    int needed_sheets = 0;  // 0: as many as these kernels need
    float half_weight = 0;  // > 0: there is no boundary; the volume ends where the sum of weights falls below it
    std::optional<Shading> shading{};
    std::vector<CornerNormals> boundary_normals{};  // of the boundary's triangles; empty without shading
    std::string kind{};                             // of its volumes: what kernels that replace others must have in common
    Vec3 middle{0.0};                               // of the bounds; depths are relative to its depth
    double diagonal = 0;
    ReachCounts bends{};  // as count_bends
    float thinnest = 0;   // no kernel reaches less far in any direction
    Box reach{};          // of the kernels and of the boundary
    RayClip clip{};       // as set_clip
    bool solid = false;   // of the picture, as is_solid
    bool shadows = false;
    double occlusion_world = 0;          // > 0: ambient occlusion over this distance
    const LightVolume* light = nullptr;  // of the picture, if there are shadows or occlusion

    [[nodiscard]] bool shadowed() const { return shadows || occlusion_world > 0; }

    [[nodiscard]] const RbfChannel& opacity_values() const { return volume->channels[channel]; }
    [[nodiscard]] const RbfChannel& color_values() const { return volume->channels[color_channel.value_or(channel)]; }
    /// Whether a sum always lies between the values of its kernels.
    [[nodiscard]] bool convex() const {
        return normalized && std::all_of(kernel_table.begin(), kernel_table.end(), [](float w) { return w >= 0; });
    }
    /// Whether the short loops suffice: one channel, compact kernels, normalised, with a boundary, without shading.
    [[nodiscard]] bool plain() const {
        return form == KernelForm::Compact && !bent && normalized && half_weight == 0 && !shading && !color_channel && !light;
    }
};

/// throws: Error(InvalidInput) for options out of range, no such channel, a kernel that cannot be splatted, a size or values
///         beyond 32-bit floats
[[nodiscard]] SplatScene make_scene(const RbfVolume& volume, const SplatOptions& options);

/// Puts other kernels of the same volume in place of those before.
///
/// clip:   as of the last `set_clip`
/// throws: Error(InvalidInput) if the volume's channels, kernel or size of the boundary differ, or a value is beyond floats
void set_kernels(SplatScene& scene, const RbfVolume& volume, const Clip& clip);

/// Sets how the volume is cut open. Faces that do not cut it are left out: they change no bit of a picture.
///
/// throws: Error(InvalidInput) as `validate`
void set_clip(SplatScene& scene, const Clip& clip);

/// The colours of the second channel's values, which are counted in cells: {r, g, b, 0} at a cell's lower end, and the step to
/// the next. Cells and rows as in PreintegratedTable.
struct ColorTable {
    struct Row {
        std::array<float, 4> color;
        std::array<float, 4> step;
    };
    double min = 0, max = 1;
    std::vector<Row> rows;
};

/// The transfer function as tables: extinction and emission, and the colours of the second channel.
struct Classification {
    PreintegratedTable table;
    ColorTable colors;          // empty rows: colours are those of `table`; of the first channel if slices need its colours
    float most_extinction = 0;  // of any value

    /// Extinction and emission at a value, in cells.
    [[nodiscard]] std::array<float, 4> light_at(float x) const;
    /// The colour of a value of the second channel, in cells of its table.
    [[nodiscard]] std::array<float, 3> color_at(float x) const;
};

/// Whether a lit volume with a boundary is opaque, whatever its values: all light ends within kSolidSkin.
[[nodiscard]] bool is_solid(const SplatScene& scene, const Optics& optics);

/// throws: Error(InvalidInput) if ranges or extinctions are beyond 32-bit floats, or the range is lost in the rounding of
///         values
[[nodiscard]] Classification classify(const SplatScene& scene, const Optics& optics);

/// The sheets of a frame: `count` planes of constant eye depth. Depths are relative to `middle`, the depth of the scene's
/// middle.
struct SheetStack {
    int count = 0;
    float first = 0, distance = 0;
    float middle = 0;
    float near = 0;  // relative too; nothing before it is seen

    /// place: between two sheets, too
    [[nodiscard]] float depth(float place) const { return first + place * distance; }
    [[nodiscard]] float depth(int sheet) const { return depth(static_cast<float>(sheet)); }
    [[nodiscard]] int batches() const { return (count + kBatch - 1) / kBatch; }
};

/// count: 0: as many as the kernels need, or as the scene says
[[nodiscard]] SheetStack make_sheets(const SplatScene& scene, const View& view, int count);

/// A picture and the mean depth of what is seen in each pixel, weighted by opacity (eye depth; infinity where nothing is seen).
struct Drawn {
    Image image;
    std::vector<float> depth;
};

}  // namespace subvol::detail
