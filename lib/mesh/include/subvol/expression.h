// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "subvol/vec.h"

namespace subvol {

/// Evaluates an expression in x, y, z (e.g. "sin(3*x)*cos(2*y)+z") at points.
///
/// Functions and operators are those of muParser, with its constants _pi and _e, and also pi. Positions in messages count
/// characters from 0.
///
/// throws: Error(InvalidInput) with the parser's position if the expression is wrong, or if a value is not finite
[[nodiscard]] std::vector<double> evaluate_expression(const std::string& expression, std::span<const Vec3> points);

}  // namespace subvol
