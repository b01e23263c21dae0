// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/limit_surface.h"
#include "subvol/share.h"

namespace subvol::detail {

/// A share of a surface as bytes, and the range of cells that it was cut out of, of all isosurfaces and the boundary together.
struct SurfaceShareBytes {
    std::string bytes;
    ShareRange cells{};
};

/// A share of a surface: what is cut out of a range of the cells that it passes, with points on the limit and their fields.
/// Every share finds these cells and the level by itself.
///
/// throws: as `limit_surface`; Error(InvalidInput) if an isosurface leads two cells farther than the first look finds
/// cost:   memory: the topology of the mesh; some 300 bytes for each triangle of the share, and of the whole at level 1
[[nodiscard]] SurfaceShareBytes share_of_surface(const MeshSource& source, std::string_view field,
                                                 const SurfaceOptions& options, const Share& share);

/// All shares of a surface as `limit_surface` returns it, bit by bit: slivers are mended, and the whole is measured.
///
/// shares: in their order
/// names:  of the shares, for errors
/// throws: Error(InvalidInput) if a share is damaged, or not of the same surface; Error(Cancelled)
/// cost:   memory: the shares twice, and some 300 bytes a triangle
[[nodiscard]] LimitSurface join_surface(std::vector<std::string> shares, std::span<const std::string> names,
                                        Progress* progress = nullptr);

/// A share in a file.
struct SurfaceShareFile {
    std::string note;  ///< says which share of which work it is
    std::string bytes;
};

/// The extension of such files.
inline constexpr const char* kSurfaceShareExtension = ".svshare";

/// throws: Error(Io)
void write_surface_share(const std::filesystem::path& path, const SurfaceShareFile& share);

/// throws: Error(Io); Error(InvalidInput) if it is another file, or not complete
[[nodiscard]] SurfaceShareFile read_surface_share(const std::filesystem::path& path);

}  // namespace subvol::detail
