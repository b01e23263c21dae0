// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "grid_fields.h"
#include "picture_arguments.h"
#include "subvol/limit_body.h"
#include "subvol/measure.h"
#include "subvol/mesh_source.h"

namespace subvol::cli {

/// What a user of the cells must know: that the limit has another volume, or another box, by more than 1 %. Empty if it has
/// not.
[[nodiscard]] std::string limit_warning(const LimitBody& body);

/// The same where the limit folds.
[[nodiscard]] std::string fold_warning(const SeenFolds& folds);

/// The same of a field whose limit leaves its range in the file by more than 1 % of it. at_least: the range of the limit is
/// that of samples
[[nodiscard]] std::string range_warning(const std::string& field, const Range& file, const Range& limit, bool at_least = false);
/// Of derivatives the file has no range, only the limit at its points.
[[nodiscard]] std::string range_warning(const Attribute& field, const Range& file, const Range& limit, bool at_least = false);

/// Says to `said`, a Report or Facts, how far the samples of a field go beyond its range: a warning if it is a file's and
/// leaves it by more than 1 %, else a note.
template <class Said>
void say_beyond(Said& said, const std::string& field, const Range& given, const Range& limit, bool of_file) {
    const std::string warning = of_file ? range_warning(field, given, limit, true) : "";
    warning.empty() ? said.note(beyond(field, given, limit)) : said.warn(warning);
}

/// The same of a mesh in memory that was read from a file; empty of a built-in model, whose limit is what is meant, of bricks
/// and of the trilinear scheme.
[[nodiscard]] std::string limit_warning(const std::string& input, const MeshSource& source, const SchemeOptions& scheme,
                                        Progress* progress);

}  // namespace subvol::cli
