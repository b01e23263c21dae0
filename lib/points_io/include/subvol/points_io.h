// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/rbf_volume.h"

namespace subvol {

/// ascii:  `.ply`: text instead of binary numbers
/// splats: `.ply`: also what viewers of 3-D Gaussian splats read, see `write_points`
struct PointsWriteOptions {
    bool ascii = false;
    bool splats = false;
};

/// Writes points as `.ply` or `.vtp`, all channels; the numbers are exact, so that they come back bit for bit. The kernel is
/// JSON (`to_json`), in a comment or a string of the field data.
///
/// .ply: element `vertex` with x y z; of a channel value, gx gy gz, moment and, where it has Hessians, hxx hxy hxz hyy hyz hzz
///       (value_1 … of the second); the frame sxx sxy sxz syy syz szz. Then the boundary as `boundary_vertex` and
///       `boundary_triangle`. Splats: x y z as floats (the exact ones are cx cy cz), and scale_0..2, rot_0..3, opacity and
///       f_dc_0..2 of the first channel: a Gaussian with the kernel's height and integral, coloured by viridis over the range
///       of the values. Such viewers take every property for the vertex's: the boundary stands beside, as for .vtp. 56 bytes a
///       point more.
/// .vtp: VTK PolyData for ParaView, a Verts cell a point; arrays NAME, NAME.gradient, NAME.moment, NAME.hessian where a channel
///       has them, frame (S), ellipsoid (√S, 9 components, for the Tensor Glyph filter) and pscale (radius of the ball of its
///       volume). Hessians and S are in VTK's order xx yy zz xy yz xz. Beside it the boundary as NAME.boundary.vtp.
/// Both files of such a pair appear, or none.
/// throws: Error(InvalidInput) for an unknown extension, and as `validate`; Error(Io)
void write_points(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options = {});

/// Reads what `write_points` writes: `.ply` in any encoding and order of properties, `.vtp` in any encoding and with any
/// compressor; what is unknown is passed over. The bounds are `box_of`.
///
/// throws: Error(Io); Error(InvalidInput) if it is malformed, or not of points with frames; never allocates by a number from
///         the file that the file's size does not bear out
[[nodiscard]] RbfVolume read_points(const std::filesystem::path& path);

/// Whether `read_points` knows files of this name.
[[nodiscard]] bool is_points_file(const std::filesystem::path& path);

}  // namespace subvol
