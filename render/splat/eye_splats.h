// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "splat_scene.h"

namespace subvol::detail {

/// A kernel in eye space, ready to be cut by a plane of constant depth z. With z_s = z − depth, its section has the centre
/// center + shear·z_s, and for an offset Δ from that centre
///     e = z_s²·inv_szz + (root_xx·Δx + root_xy·Δy)² + (root_yy·Δy)²
///     v = value + value_slope·z_s + gradient·Δ + moment·e, in cells of the table.
/// The root of the section's quadratic form keeps digits that the form itself loses for flat kernels. Laid out as in shaders.
struct EyeSplat {
    float center_x, center_y, depth, inv_szz;
    float shear_x, shear_y, root_xx, root_xy;
    float root_yy, value, gradient_x, gradient_y;
    float value_slope, moment, extent_x, extent_y;
};
static_assert(sizeof(EyeSplat) == 64);

/// The part of the value that a Hessian adds: zz·z_s² + z_s·(zx, zy)·Δ + Δᵀ·(xx xy; xy yy)·Δ.
struct EyeBend {
    float zz, zx, zy, xx;
    float xy, yy, unused[2];
};

/// The value of the colour channel, as that of EyeSplat, in cells of the colour table.
struct EyeColor {
    float value, value_slope, gradient_x, gradient_y;
    float moment, unused[3];
};

/// Separable kernels: ξ = rows · (Δ, z_s), each row of four floats, scaled so that the support ends at |ξ| = 1.
struct EyeAxes {
    std::array<float, 12> rows;
};

/// Bounds of a kernel's value over its support, in cells; widened by more than rounding.
struct EyeRange {
    float low, high;
};

/// All kernels of a frame; bends, colors, color_bends and axes are filled only if the scene has them.
struct EyeSplats {
    std::vector<EyeSplat> splats;
    std::vector<EyeRange> ranges;  // empty if sums may leave the ranges: weights may be negative, or are not divided by
    std::vector<EyeBend> bends;
    std::vector<EyeColor> colors;
    std::vector<EyeBend> color_bends;
    std::vector<EyeAxes> axes;
};

/// Converts kernels to eye space and values to cells: (value − min) · cells / (max − min); where sums are not normalised,
/// value · cells / (max − min), and `value_offset` is added to the sum.
void eye_splats(EyeSplats& result, const SplatScene& scene, const View& view, const Classification& classification);

/// The number that has to be added to a sum of kernels' values, in cells: 0 if sums are normalised.
[[nodiscard]] float value_offset(const SplatScene& scene, const Classification& classification);
[[nodiscard]] float color_offset(const SplatScene& scene, const Classification& classification);

}  // namespace subvol::detail
