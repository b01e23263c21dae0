// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/wavelet_file.h"

namespace subvol::cli {

class Report;

/// Writes a mesh with one field as wavelets, and what was kept into the report.
void write_wavelets_reported(const std::string& path, const HexMesh& mesh, const WaveletFileOptions& options, Report& report);

}  // namespace subvol::cli
