// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/study.h"

namespace subvol {

/// A number, or a text, that cases are measured by.
struct StudyMeasure {
    std::string_view key;
    std::string_view methods;   ///< the methods that give it, separated by spaces; "pictures": all that draw
    std::string_view quantity;  ///< what an axis calls it, with the unit
    std::string_view meaning;   ///< a sentence for the table of all keys
};

/// All that cases are measured by, but the metrics of pictures (`picture_metrics`), which a study names.
[[nodiscard]] std::span<const StudyMeasure> study_measures();

/// Whether a case that succeeds is measured by this key.
[[nodiscard]] bool measures(const Study& study, const StudyCase& study_case, const std::string& key);

/// Whether the key belongs to the case: one of its values, or a measure of it.
[[nodiscard]] bool has_key(const Study& study, const StudyCase& study_case, const std::string& key);

/// All keys of a study's cases, in the order of the alphabet.
[[nodiscard]] std::vector<std::string> all_keys(const Study& study);

/// The name of a key on an axis, with its unit: "PSNR of linear RGB, dB".
[[nodiscard]] std::string axis_label(const Study& study, const std::string& key);

/// The table of all keys and metrics as Markdown, for docs/studies.md.
///
/// methods: of pictures
[[nodiscard]] std::string study_keys_markdown(std::span<const PictureMethod> methods);

}  // namespace subvol
