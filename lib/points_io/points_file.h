// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "subvol/points_io.h"

namespace subvol::detail {

/// The writers and readers of one format each. The caller validates volumes before they are written and after they are read.
void write_ply(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options);
void write_vtp(const std::filesystem::path& path, const RbfVolume& volume, const std::string& note);

/// What comes before a note in a comment of either format, and behind it in .vtp.
inline constexpr const char* kNoteMark = " subvol_note ";
inline constexpr const char* kNoteEnd = " -->";

/// The property of a part's points with their places in the whole.
inline constexpr const char* kNumber = "number";

/// numbers: null, or gets them
[[nodiscard]] RbfVolume read_ply(std::string_view text, const std::filesystem::path& path,
                                 std::vector<double>* numbers = nullptr);
[[nodiscard]] RbfVolume read_vtp(std::string_view text, const std::filesystem::path& path);
[[nodiscard]] RbfVolume read_svk(const std::filesystem::path& path);

}  // namespace subvol::detail
