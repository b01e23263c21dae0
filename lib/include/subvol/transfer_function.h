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
/// side of a signed density, opaque), "constant".
///
/// throws: Error(InvalidInput) for an unknown name; lists those that exist
[[nodiscard]] TransferFunction transfer_function_preset(const std::string& name, double min, double max);

/// Reads ParaView's colour-map JSON: RGBPoints (sRGB, turned to linear light) and Points (opacity; x, alpha, midpoint,
/// sharpness: the last two must be .5 and 0). Without Points the opacity ramps 0 → .5.
///
/// throws: Error(Io), Error(InvalidInput)
[[nodiscard]] TransferFunction read_transfer_function(const std::filesystem::path& path);

/// throws: Error(InvalidInput) if a list is empty, not ascending, not finite, or out of [0,1]
void validate(const TransferFunction& function);

}  // namespace subvol
