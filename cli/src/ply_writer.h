#pragma once

#include <filesystem>

#include "subvol/rbf_volume.h"

namespace subvol::cli {

enum class PlyEncoding { Ascii, Binary };

/// Writes an RBF volume's first channel as a point cloud: element `vertex` with x y z, value, gx gy gz, moment and the frame
/// sxx sxy sxz syy syz szz; then its surface as `boundary_vertex` and `boundary_triangle`, which readers of points pass over.
///
/// throws: Error(Io)
void write_ply(const std::filesystem::path& path, const RbfVolume& volume, PlyEncoding encoding);

}  // namespace subvol::cli
