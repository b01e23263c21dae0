// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "subvol/camera.h"
#include "subvol/detail/preintegrated_table.h"
#include "subvol/optics.h"
#include "subvol/rbf_volume.h"
#include "subvol/splat_options.h"

namespace subvol::detail {

// The rules of reconstruction and classification that all backends follow; the shaders take them from here.

/// Least weight of a sum that counts: below it a sheet knows no value at that pixel.
inline constexpr float kLeastWeight = 0.02f;
/// Values nearer than this many cells of the table are taken as one, halfway: their quotients would lose digits.
inline constexpr float kNearValues = 0.5f;
/// Transmittance below which a pixel is opaque. What lies behind can change a colour by no more than this: a fortieth of a step
/// of an 8-bit picture, and less than what sheets change.
inline constexpr float kSplatCutoff = 1e-4f;
/// Values further out, in cells of the table, look like this one.
inline constexpr float kFarCells = 1e12f;
/// Change of the value, in parts of the range over the volume's diagonal, at which half of a surface is seen.
inline constexpr float kLeastChange = 0.25f;
/// Sheets that are summed together: no part of the picture depends on it.
inline constexpr int kBatch = 8;

/// Compact: w = (1−e)³. Radial: a table over e. Separable: a product of one table over |ξ| along three axes.
enum class KernelForm { Compact, Radial, Separable };

/// What is drawn, as far as neither view nor transfer function take part.
struct SplatScene {
    const RbfVolume* volume = nullptr;
    std::size_t channel = 0;  // whose values the opacity is for, and the colour but for:
    std::optional<std::size_t> color_channel{};
    KernelForm form = KernelForm::Compact;
    std::vector<float> kernel_table{};  // equally spaced over e or |ξ| / radius in [0,1]; the last is 0
    bool bent = false;                  // channels have Hessians
    bool normalized = true;
    float half_weight = 0;  // > 0: there is no boundary, the volume ends where weights fall below
    std::optional<Shading> shading{};
    Vec3 middle{0.0};  // of the bounds; depths count from its depth
    double diagonal = 0;

    [[nodiscard]] const RbfChannel& opacity_values() const { return volume->channels[channel]; }
    [[nodiscard]] const RbfChannel& color_values() const { return volume->channels[color_channel.value_or(channel)]; }
    /// Whether a sum lies between the values of its kernels.
    [[nodiscard]] bool convex() const {
        return normalized && std::all_of(kernel_table.begin(), kernel_table.end(), [](float w) { return w >= 0; });
    }
    /// Whether the short loops do: one value, compact kernels, normalised, a boundary, no light.
    [[nodiscard]] bool plain() const {
        return form == KernelForm::Compact && !bent && normalized && half_weight == 0 && !shading && !color_channel;
    }
};

/// throws: Error(InvalidInput) for options out of range, no such channel, a kernel that cannot be splatted, a size or values
///         beyond 32-bit floats
[[nodiscard]] SplatScene make_scene(const RbfVolume& volume, const SplatOptions& options);

/// Colours over the second channel's values, counted in cells like those of PreintegratedTable: {r, g, b, 0} at a cell's lower
/// end, and the step to the next. Rows as there.
struct ColorTable {
    struct Row {
        std::array<float, 4> color;
        std::array<float, 4> step;
    };
    double min = 0, max = 1;
    std::vector<Row> rows;
};

/// What a value looks like.
struct Classification {
    PreintegratedTable table;
    ColorTable colors;  // empty rows: colours are those of `table`
};

/// throws: Error(InvalidInput) if ranges or extinctions are beyond 32-bit floats, or values drown in them
[[nodiscard]] Classification classify(const SplatScene& scene, const Optics& optics);

/// The sheets of a frame: `count` planes of constant eye depth. Depths are relative to that of the scene's middle, which is
/// `middle`.
struct SheetStack {
    int count = 0;
    float first = 0, distance = 0;
    float middle = 0;
    float near = 0;  // relative like the others: nothing is seen before it

    [[nodiscard]] float depth(int sheet) const { return first + static_cast<float>(sheet) * distance; }
    [[nodiscard]] int batches() const { return (count + kBatch - 1) / kBatch; }
};

[[nodiscard]] SheetStack make_sheets(const SplatScene& scene, const View& view, int count);

}  // namespace subvol::detail
