// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "subvol/transfer_function.h"

namespace subvol {

/// How values are spread over a colour map.
struct ColorScale {
    bool logarithmic = false;  ///< equal ratios of values get equal parts of the map; of a range that is not above 0, linear
    double linear_within = 0;  ///< symmetrically logarithmic: by sign(v) ln(1 + |v|/C), with C = linear_within > 0; 0: not
    std::string where = "transfer function";  ///< named in errors

    [[nodiscard]] bool linear() const { return !logarithmic && !(linear_within > 0); }
    /// The part of the range [min, max] at which a value lies, 0 to 1 inside.
    [[nodiscard]] double part(double value, double min, double max) const;
    /// The value at a part of the range.
    [[nodiscard]] double at(double part, double min, double max) const;
};

inline constexpr int kMostBands = 1000;

/// What is done with a colour map over its range.
struct ColorShape {
    ColorScale scale{};
    /// So many colours, evenly spaced in the scale; the first and the last are the ends of the map; 0: all colours
    int bands = 0;
    std::optional<Vec3> below{}, above{};  ///< colours of values beyond the range, in linear light; none: those of its ends
};

/// Spreads colours and opacities, each over the range of its own knots, by the scale; cuts the colours into bands; adds those
/// of values beyond the range. Between knots of the result lines are straight: right to 1/512 of the map for ranges of up to
/// 12 decades.
///
/// throws: Error(InvalidInput) as validate(function), if the scale is logarithmic and a range is not above 0, or if there is a
///         negative number of bands
[[nodiscard]] TransferFunction shaped(const TransferFunction& function, const ColorShape& shape);

}  // namespace subvol
