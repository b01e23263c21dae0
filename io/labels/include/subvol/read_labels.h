// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "subvol/label_grid.h"

namespace subvol {

/// Whether a file of this name may have voxels with labels: .vti or .nrrd.
[[nodiscard]] bool is_label_file(const std::filesystem::path& path);

/// Reads the labels of a `.vti` (VTK's ImageData in XML, one piece) or `.nrrd` file (versions 1 to 5, three axes, the data in
/// the same file as raw, gzip or ascii). Voxels are where the file has them: origin, spacing and directions are respected;
/// those of `.nrrd` stay in the space that the file names. Values at the points of an image are labels of voxels around them,
/// those at its cells of the cells.
///
/// array:  of a `.vti`; none: the only array of integers with one component
/// throws: Error(Io); Error(InvalidInput) if the file is malformed, if its values are not integers, if several arrays could be
///         meant, or if there are more than 2^31 voxels
[[nodiscard]] LabelGrid read_labels(const std::filesystem::path& path, const std::optional<std::string>& array = {});

}  // namespace subvol
