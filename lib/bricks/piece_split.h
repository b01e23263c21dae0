// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "piece_tables.h"

namespace subvol::detail {

/// Splits all cells of such tables into hexahedra, as `split_into_hexes` does: the same points and cells in the same order.
///
/// The keys of new points (the sorted corners of their edge, face or cell) are sorted in buckets on disk, which numbers them;
/// the numbers then come back to the cells.
///
/// mixed:  is given up
/// list:   the name of the list of pieces, for messages
/// throws: Error(InvalidInput) if two cells have the same corners, or if there are too many; Error(Io) if the disk is full
/// cost:   O(n log n); some 500 bytes a tetrahedron on disk until it is done, 1300 a hexahedron; memory for a bucket of keys
/// and
///         for a chunk of cells, and 2 bits a point
[[nodiscard]] std::unique_ptr<PieceTables> split_tables(std::unique_ptr<PieceTables> mixed, const std::string& list,
                                                        const std::filesystem::path& folder, Progress* progress);

}  // namespace subvol::detail
