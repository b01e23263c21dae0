// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "subvol/image.h"

namespace subvol::cli {

/// Metrics of a picture compared with its reference, by name.
///
/// names: separated by commas, as in a study
[[nodiscard]] std::map<std::string, double> picture_metrics(const Image& image, const Image& reference,
                                                            const std::string& names);

}  // namespace subvol::cli
