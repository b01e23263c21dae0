// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace subvol::detail {

/// Whether an array of that name numbers or marks points or cells: `GlobalNodeId`, `vtkOriginalPointIds`, `IBlank`,
/// `vtkGhostType`. A name such as `Fluid` does not.
[[nodiscard]] bool is_identifier(std::string_view name);

/// Whether the name is that of a physical quantity: `Temp`, `Pressure`, `von_mises`, `EQPS`, `StagnationEnergy`, …
[[nodiscard]] bool is_physical(std::string_view name);

}  // namespace subvol::detail
