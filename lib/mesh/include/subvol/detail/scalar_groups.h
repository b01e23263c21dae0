// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace subvol::detail {

/// Scalars that are the components of one vector or tensor, as their names say.
struct ScalarGroup {
    std::string name;
    std::vector<std::size_t> members;  // numbers of the names: 3, 6 or 9, in the order of `component_names`
};

/// The groups among the names of scalars: disp_x, disp_y, disp_z; VELX, VELY, VELZ; stress_xx, stress_xy, … with six components
/// of a symmetric tensor, or nine of any. Their order does not matter, xy may be called yx in a symmetric tensor, and letters
/// may be large. Names of tensors are looked for first, so that stress_xx, stress_xy and stress_xz are no vector.
///
/// returns: groups by their first member; no name is in two of them
/// cost:    n log n
[[nodiscard]] std::vector<ScalarGroup> scalar_groups(std::span<const std::string> names);

}  // namespace subvol::detail
