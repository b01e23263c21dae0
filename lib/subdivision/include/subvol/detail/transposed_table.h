// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "subvol/stencil_table.h"

namespace subvol::detail {

/// Applies the transpose of a table to data of the finer points, point-major.
///
/// fine:    rows × channels values
/// returns: columns × channels sums
/// throws:  Error(InvalidInput) if the size is wrong
/// cost:    parallel; bitwise the same for any number of threads
[[nodiscard]] std::vector<double> apply_transpose(const StencilTable& table, std::span<const double> fine,
                                                  std::size_t channels);

}  // namespace subvol::detail
