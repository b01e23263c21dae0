// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/kernel_file.h"
#include "svk_layout.h"

namespace subvol::detail {

/// What the head of a file says, for users.
[[nodiscard]] KernelFileContents kernel_file_contents(const SvkContents& contents, const SvkLayout& layout,
                                                      std::uint64_t bytes);

}  // namespace subvol::detail
