// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/vec.h"

namespace subvol {

/// Colour and opacity of a field value, each piecewise linear between its knots and constant beyond them.
struct TransferFunction {
    struct ColorKnot {
        double value;
        Vec3 rgb;
    };
    struct OpacityKnot {
        double value;
        double alpha;
    };
    std::vector<ColorKnot> color;      ///< rgb in linear light, [0,1]; values ascending
    std::vector<OpacityKnot> opacity;  ///< alpha in [0,1], per opacity unit (see Optics); values ascending
};

/// Colour (in linear light) of a value. No list of the function may be empty.
[[nodiscard]] Vec3 color_at(const TransferFunction& function, double value);

/// Opacity of a value, likewise.
[[nodiscard]] double alpha_at(const TransferFunction& function, double value);

/// A named transfer function over a field's range.
///
/// viridis:    the default. The opacity ramps from 0 to .5 over the range, and colours are right to 1/512, as in coolwarm
///             (diverging), grey, bone and xray (white to black, for a white background)
/// isosurface: viridis, transparent except for five evenly spaced narrow peaks of opacity .9
/// surface:    the positive side of a signed density, opaque
/// constant:   white, opacity .5
/// categories: another colour for each integer, from half below it to half above it; opacity .5
///
/// plasma, inferno, cividis, turbo, jet, rainbow (blue to red by hue), desaturated, blackbody: sequences of colours
///
/// name:     in any case; also what ParaView calls the map, such as "Cool to Warm", "Blue to Red Rainbow", "Grayscale"
/// min, max: the field's range; that of a constant field is widened by .5 on either side
/// throws:   Error(InvalidInput) for an unknown name (lists those that exist), or if the range is not finite or min > max
[[nodiscard]] TransferFunction transfer_function_preset(const std::string& name, double min, double max);

/// The names of all presets, and of those that are sequences of colours with the usual opacity.
[[nodiscard]] std::vector<std::string> transfer_function_names();
[[nodiscard]] std::vector<std::string> color_map_names();

/// Reads ParaView's colour-map JSON: an array of maps with RGBPoints (sRGB), ColorSpace (RGB, HSV, Lab, Lab/CIELAB, Diverging,
/// Step; RGB if it is missing) and Points (opacity; x, alpha, midpoint, sharpness). Both curves are VTK's, resampled to knots
/// that are right to 1/512. Two knots with the same value are a jump. Without Points the opacity ramps from 0 to .5. The knots
/// keep the values of the file, which are those of the field. Lab/CIEDE2000 is read as Lab; all other keys are ignored.
///
/// name:   the map's Name; empty for the first
/// throws: Error(Io), Error(InvalidInput) with the file, and the key or knot (counted from 0)
[[nodiscard]] TransferFunction read_transfer_function(const std::filesystem::path& path, const std::string& name = {});

/// Reads opacities from text: "v:a,v:a,…", values of the field with their opacities. "%" after a value means per cent of the
/// range, as in "0%:0,50%:.2,100%:.9". Two entries with the same value are a jump.
///
/// min, max: the field's range, as for a preset
/// throws:   Error(InvalidInput) that names the entry
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> parse_opacity(const std::string& text, double min, double max);

/// The same colours and opacities over another range: the first and last colour move to min and max, as when ParaView fits a
/// map to data (most maps are defined on [0,1]). A range of zero width is widened as for a preset; a function of one colour
/// does not change.
///
/// throws: Error(InvalidInput) as validate(function), or if the range is not finite or min > max
[[nodiscard]] TransferFunction stretched(const TransferFunction& function, double min, double max);

/// throws: Error(InvalidInput) if a list is empty, its values are not finite or do not ascend strictly, or a colour or an
///         opacity is outside [0,1]
void validate(const TransferFunction& function);

}  // namespace subvol
