// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/transfer_function.h"

namespace subvol {

/// A transfer function as ParaView's colour-map JSON, which `read_transfer_function` and ParaView read: colours in sRGB, right
/// to 1/1024 between the points, opacities as they are.
///
/// name:   what ParaView calls the map
/// throws: Error(InvalidInput) as validate(function)
[[nodiscard]] std::string color_map_json(const TransferFunction& function, const std::string& name);

}  // namespace subvol
