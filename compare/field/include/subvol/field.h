// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "subvol/vec.h"

namespace subvol {

/// A scalar field in world space: of a mesh, of points, of a grid, or a formula. Both functions are called from many threads at
/// once.
///
/// value:    nothing outside the domain
/// gradient: in world⁻¹, exact where the field has one; empty: central differences of `value` are used
/// box:      contains the domain
/// step:     of those differences, world; 0: 1/1000 of the box's diagonal
struct FieldView {
    std::function<std::optional<double>(const Vec3&)> value;
    std::function<std::optional<Vec3>(const Vec3&)> gradient{};
    Box box{};
    double step = 0;
};

}  // namespace subvol
