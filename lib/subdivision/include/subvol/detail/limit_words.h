// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/limit_body.h"
#include "subvol/option_names.h"

namespace subvol::detail {

/// What a user of the cells must know: that the limit has another volume, or another box, by more than 1 %, and what makes
/// them alike. Empty if it has not.
[[nodiscard]] std::string limit_words(const LimitBody& body, OptionNames names);

/// The same where the limit folds, as far as it was seen; empty if it was not.
///
/// cells: at least so many; first, place: one of them, and where it folds
[[nodiscard]] std::string fold_words(std::size_t cells, Index first, const Vec3& place, OptionNames names);

/// The same of a field that leaves its range in the file by more than 1 % of it; empty if it does not, or if the range is not
/// known.
///
/// at_least: min and max are those of samples, beyond which the limit may go
[[nodiscard]] std::string range_words(const std::string& field, double file_min, double file_max, double min, double max,
                                      OptionNames names, bool at_least = false);

}  // namespace subvol::detail
