// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <optional>

#include "subvol/vec.h"

namespace subvol {

/// A scalar field over world space, without a value outside its domain. `value` must be thread-safe.
template <class F>
concept Field = requires(const F& field, const Vec3& x) {
    { field.value(x) } -> std::same_as<std::optional<double>>;
};

}  // namespace subvol
