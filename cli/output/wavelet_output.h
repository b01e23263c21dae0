// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/facts.h"
#include "subvol/wavelet_file.h"

namespace subvol::cli {

/// Writes a mesh with one field as wavelets. returns: what was kept
[[nodiscard]] Facts write_wavelets_reported(const std::string& path, const HexMesh& mesh, const WaveletFileOptions& options);

}  // namespace subvol::cli
