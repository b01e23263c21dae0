// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "subvol/study.h"

namespace subvol::detail {

/// The keys whose values differ among the cases, in the order of the alphabet; without those that are only shown.
[[nodiscard]] std::vector<std::string> differing_keys(const Study& study, std::span<const std::size_t> cases);

/// The values of keys of a case, as one text.
[[nodiscard]] std::string values_text(const StudyCase& study_case, std::span<const std::string> keys);

/// Cases that a line joins, in its order: they differ in the option that is swept, and in what follows from it. Each place of
/// the line has one case, or several that differ in what is averaged.
using StudyStrand = std::vector<std::vector<std::size_t>>;

/// cases:    indices of a study's cases, those of one series of a plot
/// x:        the key of the horizontal axis; if it is an option of the cases it is the one that is swept, else that is the
/// number
///           with the most values
/// averaged: keys
[[nodiscard]] std::vector<StudyStrand> strands_of(const Study& study, std::span<const std::size_t> cases, const std::string& x,
                                                  std::span<const std::string> averaged);

}  // namespace subvol::detail
