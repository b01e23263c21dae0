// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <optional>

#include "subvol/vec.h"

namespace subvol {

/// A scalar over world space, and nothing outside its domain. `value` must be callable from many threads at once.
template <class F>
concept Field = requires(const F& field, const Vec3& x) {
    { field.value(x) } -> std::same_as<std::optional<double>>;
};

}  // namespace subvol
