// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/rbf_volume.h"

namespace subvol {

/// points_per_voxel: on average, > 0
struct VdbPointsOptions {
    double points_per_voxel = 4;
    std::string creator = "OpenSubVol";
};

/// Writes points as an OpenVDB point grid named "points", which Houdini unpacks into points; beside it the boundary as
/// NAME.boundary.vtp. Both files appear, or none.
///
/// Attributes: P; of a channel NAME, NAME_gradient, NAME_moment and, where it has Hessians, NAME_hessian (a symmetric matrix);
/// frame (S, another); for instances of a unit sphere orient, scale and pscale, which make it the support ellipsoid; id, the
/// order of the points. Characters of a name that OpenVDB does not take become underscores, the metadata keep it, and the
/// kernel as JSON (`to_json`). P is a 32-bit float in its voxel, hence within 1.5·10⁻⁸ voxels along each axis; all others are
/// exact.
/// throws: Error(InvalidInput) as `validate`, or for more than 2³¹ points; Error(Io)
void write_vdb_points(const std::filesystem::path& path, const RbfVolume& volume, const VdbPointsOptions& options = {});

/// Reads what `write_vdb_points` writes, in the order of the ids. The bounds are `box_of`.
///
/// Files that end too early are an error; in one whose bytes were changed, OpenVDB's assertions about its compressed pages can
/// still end the program, if it was built with them.
/// throws: Error(Io), Error(InvalidInput) if it is no whole OpenVDB file or has no such points
[[nodiscard]] RbfVolume read_vdb_points(const std::filesystem::path& path);

/// Whether there is a point grid in a `.vdb` file; its voxels are not read.
///
/// throws: as `read_vdb_points`
[[nodiscard]] bool holds_vdb_points(const std::filesystem::path& path);

}  // namespace subvol
