// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study_keys.h"

namespace subvol::detail {

/// What the methods of a study are applied to; the values that each input, camera and transfer function adds to a case.
struct StudyScenes {
    std::vector<StudyValues> inputs, cameras, lights;
};

/// file: of the study; names of other files are relative to its folder
/// root: the path of `json`, for messages
/// throws: Error(InvalidInput)
[[nodiscard]] StudyScenes read_scenes(const Json& json, const std::filesystem::path& file, const std::string& root);

/// A list of a study; an empty one if the key is missing.
///
/// throws: Error(InvalidInput) if it is not a list, or is empty or too long
[[nodiscard]] const Json& list_of(const Json& json, const std::string& root, const char* key);

/// The name of a study or of a part of it. Names become parts of file names.
///
/// throws: Error(InvalidInput) if it is missing or has other characters than letters, digits, _ and -
[[nodiscard]] std::string name_of(const Json& json, const std::string& path);

/// A hash of a file that a case depends on, as a part of the case's values: a changed file is another case. "": it cannot be
/// read
///
/// throws: Error(InvalidInput) if it is not a regular file
[[nodiscard]] std::string content_of(const std::filesystem::path& file, const std::string& path);

/// Numbers and texts that are known from elsewhere and shown beside the results.
void read_given(const Json& json, const std::string& path, StudyValues& values);

/// throws: Error(InvalidInput) if so many cases are too many
void check_count(std::size_t count, const std::string& path);

}  // namespace subvol::detail
