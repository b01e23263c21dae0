// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "picture_arguments.h"
#include "reference_arguments.h"
#include "splat_arguments.h"

namespace subvol::cli {

/// Whether a method of `subvol render` draws kernels: splat, sheets or footprints.
[[nodiscard]] bool is_of_splats(const std::string& method);

/// Refuses `--edges` for a method that knows no depths.
///
/// throws: Error(InvalidInput)
void check_edges(const std::string& method, const PictureArguments& picture);

/// Refuses options that a method does not have.
///
/// throws: Error(InvalidInput)
void check_method(const std::string& method, const PictureArguments& picture, const SplatArguments& splat,
                  const ReferenceArguments& reference);

}  // namespace subvol::cli
