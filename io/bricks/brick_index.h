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
/// file:       for messages
/// unfinished: there may be no bricks yet, and so no bounds
/// throws:     Error(InvalidInput) if the text is malformed or of a later version, or contradicts itself: a file named twice or
///             with another name than a brick's, counts, bounds or ranges that are not those of the bricks together
[[nodiscard]] std::string bricks_to_json(const Bricks& bricks);
[[nodiscard]] Bricks bricks_from_json(const std::string& text, const std::string& file, bool unfinished = false);

/// Puts together what the bricks have: counts, bounds, fields.
void sum_up(Bricks& bricks);

/// "brick_00012.vtu"
[[nodiscard]] std::string brick_name(std::size_t brick);
[[nodiscard]] bool is_brick_name(const std::string& name);

/// What the index says of a brick, apart from its file.
[[nodiscard]] Brick describe(const MeshPiece& brick);

/// throws: Error(InvalidInput) if a file of the index is missing, no regular file (a link, for example) or has another length
void check_files(const Bricks& bricks);

/// throws: Error(InvalidInput) if a brick that was read is not what the index says of it
void check_contents(const Bricks& bricks, const Brick& about, const MeshPiece& read, const std::string& file);

}  // namespace subvol::detail
