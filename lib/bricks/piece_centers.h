// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "brick_shapes.h"
#include "piece_tables.h"

namespace subvol::detail {

/// The centres of the cells of such tables, in files. Adds the warnings of left-handed and folded cells.
[[nodiscard]] std::unique_ptr<CellCenters> centers_of(PieceTables& tables, const std::filesystem::path& folder,
                                                      Progress* progress);

}  // namespace subvol::detail
