// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// What is known of a formula without its values.
struct FormulaKind {
    int degree = 2;         ///< 0: a number, 1: linear in the variables up to a number, 2: anything else
    bool positive = false;  ///< it is never negative
    bool flag = false;      ///< it is 0 or 1: a comparison
};

/// Reads a formula of variables v0, v1, … for muParser. What it does not understand is of degree 2 and of any sign.
///
/// positive: of each variable, whether it is never negative
[[nodiscard]] FormulaKind kind_of_formula(std::string_view text, std::span<const bool> positive);

/// A formula of scalars as a field: at all places, if it is not linear. Where its value is not finite between points at which
/// it is, the limit of its values at the points stands for it.
///
/// variables: v0, v1, …
/// points:    how many, for formulas without variables
/// throws:    mu::ParserError
[[nodiscard]] Attribute computed(const std::string& text, std::span<const Attribute> variables, std::string name,
                                 std::size_t points);

}  // namespace subvol::detail
