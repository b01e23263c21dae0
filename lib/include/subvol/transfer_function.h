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

/// A named transfer function over a field's range: "viridis" (the default), "coolwarm", "grey", "surface" (only the positive
/// side of a signed density, opaque), "constant" (white, .5). Opacities ramp 0 → .5 over the range but for the last two.
///
/// min, max: the field's range; of no width (a constant field), it is widened by .5 either side
/// throws:   Error(InvalidInput) for an unknown name (lists those that exist), or a range not finite or upside down
[[nodiscard]] TransferFunction transfer_function_preset(const std::string& name, double min, double max);

/// Reads ParaView's colour-map JSON: RGBPoints (sRGB, turned to linear light) and Points (opacity; x, alpha, midpoint,
/// sharpness: the last two must be .5 and 0). Without Points the opacity ramps 0 → .5. Values are the field's own. Whatever
/// ColorSpace says, colours are linear in linear light between knots: a map in Lab or Diverging needs enough knots.
///
/// throws: Error(Io), Error(InvalidInput) with the file, and the key or knot (counted from 0)
[[nodiscard]] TransferFunction read_transfer_function(const std::filesystem::path& path);

/// throws: Error(InvalidInput) if a list is empty, not strictly ascending, not finite, or out of [0,1]
void validate(const TransferFunction& function);

}  // namespace subvol
