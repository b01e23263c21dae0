// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subvol/label_grid.h"

namespace subvol::detail {

/// text: of the whole file; file: its name for messages; array: as of `read_labels`
[[nodiscard]] LabelGrid read_vti_labels(std::string_view text, std::string_view file, const std::optional<std::string>& array);
[[nodiscard]] LabelGrid read_nrrd_labels(std::string_view text, std::string_view file);

}  // namespace subvol::detail
