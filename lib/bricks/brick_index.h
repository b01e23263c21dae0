// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/bricks.h"

namespace subvol::detail {

inline constexpr int kBricksFormat = 1;
inline constexpr int kMostHaloLayers = 16;
inline constexpr const char* kBricksIndex = "index.json";

/// The index as a text, and back.
///
/// file:   for messages
/// throws: Error(InvalidInput) if the text is malformed or of a later version
[[nodiscard]] std::string bricks_to_json(const Bricks& bricks);
[[nodiscard]] Bricks bricks_from_json(const std::string& text, const std::string& file);

/// Puts together what the bricks have: counts, bounds, fields.
void sum_up(Bricks& bricks);

/// "brick_00012.vtu"
[[nodiscard]] std::string brick_name(std::size_t brick);

/// What the index says of a brick, apart from its file.
[[nodiscard]] Brick describe(const BrickMesh& brick);

/// throws: Error(InvalidInput) if a file of the index is missing or has another length
void check_files(const Bricks& bricks);

}  // namespace subvol::detail
