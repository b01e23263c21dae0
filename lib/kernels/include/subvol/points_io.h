// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/camera.h"
#include "subvol/option_names.h"
#include "subvol/rbf_volume.h"

namespace subvol {

struct PointsWriteOptions {
    bool ascii = false;     ///< for `.ply`: text instead of binary numbers
    bool splats = false;    ///< for `.ply`: adds properties for viewers of 3-D Gaussian splats, see `write_points`
    UpAxis up = UpAxis::Z;  ///< for splats: what these viewers are to show at the top
    /// A line of text that the file has in a comment, for `read_points_note`; empty: none. It has no control characters
    std::string note{};
};

[[nodiscard]] std::vector<Option> options_of(PointsWriteOptions& options);

/// Writes points with all channels as `.ply`, `.vtp` or `.npz`, or splats as `.glb`. Numbers are exact but in `.glb`: reading
/// gives the same bits. The kernel is JSON (`to_json`), in a comment or in a string of the field data.
///
/// .ply: the element `vertex` has x y z; for each channel value, gx gy gz, moment and, if it has Hessians, hxx hxy hxz hyy hyz
///       hzz (of the second channel value_1 …); the frame sxx sxy sxz syy syz szz. The elements `boundary_vertex` and
///       `boundary_triangle` are the boundary.
///       With splats, x y z are floats (the exact centre is cx cy cz), and scale_0..2, rot_0..3, opacity and f_dc_0..2 are
///       added: a Gaussian with the height and the integral of the kernel, coloured by viridis over the range of the first
///       channel. Viewers of splats have -y at the top, so x y z and rot_0..3 are turned that way, and nothing else is. They
///       read all elements as vertices; hence the boundary is a separate file, as for .vtp. Splats take 56 bytes more per
///       point.
/// .vtp: VTK PolyData for ParaView, one Verts cell per point. The arrays are NAME, NAME.gradient, NAME.moment and, if a channel
///       has Hessians, NAME.hessian; frame (S), ellipsoid (√S, 9 components, for the Tensor Glyph filter) and pscale (the
///       radius of the ball with the same volume). Hessians and S are in VTK's order xx yy zz xy yz xz. The boundary is a
///       separate file, NAME.boundary.vtp; either both files appear or none.
/// .npz: numpy's archive, for programs that read it with numpy; `read_points` does not. The arrays are centers (n,3), frames
///       (n,6) with xx xy xz yy yz zz, channels (c) with the names in UTF-8, values (c,n), gradients (c,n,3), moments (c,n),
///       hessians (c,n,6) if a channel has them, kernel (its JSON), bounds (2,3), boundary_points and boundary_triangles.
/// .glb: glTF with KHR_gaussian_splatting, for viewers of Gaussian splats, and points in their colours for others;
/// `read_points`
///       does not read it. The splats are those of a .ply with splats, as floats; the node turns `up` to y. There is no
///       boundary.
///
/// throws: Error(InvalidInput) for an unknown extension, and as `validate`; Error(Io)
void write_points(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options = {});

/// Reads the files of `write_points`: `.ply` in any encoding and order of properties, `.vtp` in any encoding and with any
/// compressor. Unknown elements, properties and arrays are skipped. `.svk` files of `write_kernel_file` are read as a whole, in
/// the order of the volume that was written. The bounds are `box_of`. Memory is never allocated by a number in the file that
/// the file is too short for.
///
/// throws: Error(Io); Error(InvalidInput) if the file is malformed, or if its points have no frames
[[nodiscard]] RbfVolume read_points(const std::filesystem::path& path);

/// The note of a file that `write_points` has written; nothing if there is none, or if it is not such a file. Only the start of
/// the file is read.
///
/// throws: Error(Io)
[[nodiscard]] std::optional<std::string> read_points_note(const std::filesystem::path& path);

/// Whether `read_points` reads files with the extension of this name.
[[nodiscard]] bool is_points_file(const std::filesystem::path& path);

}  // namespace subvol
