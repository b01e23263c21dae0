// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/rbf_volume.h"

namespace subvol {

struct VdbPointsOptions {
    double points_per_voxel = 4;  ///< on average, > 0
    std::string creator = "OpenSubVol";
};

/// Writes points as an OpenVDB point grid named "points", which Houdini unpacks into points, and the boundary beside it as
/// NAME.boundary.vtp. Either both files appear or none.
///
/// Attributes: P; for a channel NAME: NAME, NAME_gradient, NAME_moment and, where it has Hessians, NAME_hessian (a symmetric
/// matrix); frame (S, a symmetric matrix); orient, scale and pscale, which turn an instance of the unit sphere into the support
/// ellipsoid; id, the order of the points. Characters of a name that OpenVDB does not accept become underscores; the metadata
/// have the full names and the kernel as JSON (`to_json`). P is a 32-bit float relative to its voxel, hence within 1.5·10⁻⁸
/// voxels along each axis; everything else is exact.
///
/// throws: Error(InvalidInput) as `validate`, or for more than 2³¹ points; Error(Io)
void write_vdb_points(const std::filesystem::path& path, const RbfVolume& volume, const VdbPointsOptions& options = {});

/// Reads what `write_vdb_points` writes, in the order of the ids. The bounds are `box_of`.
///
/// throws: Error(Io), Error(InvalidInput) if it is not a whole OpenVDB file or has no such points
[[nodiscard]] RbfVolume read_vdb_points(const std::filesystem::path& path);

/// Whether a `.vdb` file has a point grid; its points are not read.
///
/// throws: as `read_vdb_points`
[[nodiscard]] bool holds_vdb_points(const std::filesystem::path& path);

}  // namespace subvol
