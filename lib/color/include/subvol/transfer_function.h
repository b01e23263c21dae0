// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/vec.h"

namespace subvol {

/// Colour and opacity of a field value, each piecewise linear between its knots and constant beyond them.
///
/// color:   rgb in linear light, [0,1]; values ascending
/// opacity: alpha in [0,1], per opacity unit (see Optics); values ascending
struct TransferFunction {
    struct ColorKnot {
        double value;
        Vec3 rgb;
    };
    struct OpacityKnot {
        double value;
        double alpha;
    };
    std::vector<ColorKnot> color;
    std::vector<OpacityKnot> opacity;
};

/// Colour (in linear light) of a value. No list of the function may be empty.
[[nodiscard]] Vec3 color_at(const TransferFunction& function, double value);

/// Opacity of a value, likewise.
[[nodiscard]] double alpha_at(const TransferFunction& function, double value);

/// A named transfer function over a field's range.
///
/// viridis:    the default; coolwarm (diverging), grey, bone and xray (white to black, for a white background) are others with
/// an
///             opacity that ramps 0 → .5 over the range; colours are right to 1/512
/// isosurface: viridis, but for five narrow peaks of opacity .9, evenly spaced, transparent
/// surface:    only the positive side of a signed density, opaque
/// constant:   white, opacity .5
///
/// min, max: the field's range; of no width (a constant field), it is widened by .5 either side
/// throws:   Error(InvalidInput) for an unknown name (lists those that exist), or a range not finite or upside down
[[nodiscard]] TransferFunction transfer_function_preset(const std::string& name, double min, double max);

/// Reads ParaView's colour-map JSON as it is: an array of maps with RGBPoints (sRGB), ColorSpace (RGB, HSV, Lab, Lab/CIELAB,
/// Diverging, Step; without it RGB) and Points (opacity; x, alpha, midpoint, sharpness). Both curves are what VTK makes of
/// them, resampled to knots that are right to 1/512. A value that is there twice is a jump. Without Points the opacity ramps 0
/// → .5. Values are the field's own. Lab/CIEDE2000 is taken as Lab; all other keys are ignored.
///
/// name:   the map's Name; empty for the first
/// throws: Error(Io), Error(InvalidInput) with the file, and the key or knot (counted from 0)
[[nodiscard]] TransferFunction read_transfer_function(const std::filesystem::path& path, const std::string& name = {});

/// Opacities from text: "v:a,v:a,…", a value of the field and the opacity there; "%" after a value means per cent of the range,
/// as in "0%:0,50%:.2,100%:.9". A value that is there twice is a jump.
///
/// min, max: the field's range, as for a preset
/// throws:   Error(InvalidInput) that names the entry
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> parse_opacity(const std::string& text, double min, double max);

/// The same colours and opacities over another range: the colours' ends go to min and max, as when ParaView fits a map, most of
/// which lie on [0,1], to data. Of no width, the range is widened as for a preset; a function of one colour is left as it is.
///
/// throws: Error(InvalidInput) as validate(function), or for a range not finite or upside down
[[nodiscard]] TransferFunction stretched(const TransferFunction& function, double min, double max);

/// throws: Error(InvalidInput) if a list is empty, not strictly ascending, not finite, or out of [0,1]
void validate(const TransferFunction& function);

}  // namespace subvol
