// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "subvol/vec.h"

namespace subvol {

/// A scalar field in world space: of a mesh, of points, of a grid, or a formula. Both functions are called from many threads at
/// once.
struct FieldView {
    std::function<std::optional<double>(const Vec3&)> value;  ///< the value; nothing outside the domain
    /// The gradient in world⁻¹, exact where the field has one; empty: central differences of `value` are used.
    std::function<std::optional<Vec3>(const Vec3&)> gradient{};
    Box box{};        ///< contains the domain
    double step = 0;  ///< step of the central differences, world; 0: 1/1000 of the box's diagonal
};

}  // namespace subvol
