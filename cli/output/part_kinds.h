// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "picture_notes.h"
#include "subvol/brick_points.h"
#include "subvol/detail/picture_part.h"
#include "subvol/limit_surface.h"
#include "subvol/pixel_rows.h"
#include "subvol/points_io.h"
#include "subvol/rbf_volume.h"
#include "transport.h"
#include "vdb_output.h"

namespace subvol::cli {

// The kinds of parts; transport.h says what each has.

/// Writes kernels to a .vdb, .svk, .ply or .vtp file.
///
/// options: of .ply and .vtp
Facts write_kernels(const std::string& path, const RbfVolume& volume, const PointsWriteOptions& options, Progress* progress);

/// Where kernels were written: "output", and "boundary" if that has a file of its own.
[[nodiscard]] Facts files_of_kernels(const std::string& path, const RbfVolume& volume, const PointsWriteOptions& options);

/// Kernels: ranges of them in their order. The boundary is that of the first part.
struct KernelParts {
    using Made = RbfVolume;
    using Whole = RbfVolume;
    std::string path{};
    PointsWriteOptions options{};
    Progress* progress = nullptr;

    [[nodiscard]] static RbfVolume join(std::vector<RbfVolume> parts, std::span<const std::string> names);
    [[nodiscard]] static std::string pack(const RbfVolume& part);
    [[nodiscard]] static RbfVolume unpack(const std::string& bytes);
    [[nodiscard]] Facts store(const RbfVolume& part, const std::string& note) const;
    [[nodiscard]] static OpenedPart<RbfVolume> open(const std::string& file);
};

/// Kernels of a mesh in pieces, which may not fit into memory: a part is a file, from which `join_points_of_bricks` reads.
struct StoredKernelParts {
    using Made = std::filesystem::path;
    using Whole = BrickPointsReport;
    std::string path{};
    std::uint64_t points = 0;  ///< the number of kernels of all parts
    Progress* progress = nullptr;

    [[nodiscard]] BrickPointsReport join(const std::vector<std::filesystem::path>& parts, std::span<const std::string>) const;
    [[nodiscard]] static OpenedPart<std::filesystem::path> open(const std::string& file);
};

/// Grids: slabs of voxels. Parts are not rounded to 16 bits, as whoever has all voxels rounds them.
struct GridParts {
    using Made = std::vector<VdbGrid>;
    using Whole = std::vector<VdbGrid>;
    VdbOutput output{};
    Progress* progress = nullptr;

    [[nodiscard]] static std::vector<VdbGrid> join(std::vector<std::vector<VdbGrid>> parts, std::span<const std::string> names);
    [[nodiscard]] static std::string pack(const std::vector<VdbGrid>& part);
    [[nodiscard]] static std::vector<VdbGrid> unpack(const std::string& bytes);
    [[nodiscard]] Facts store(std::vector<VdbGrid> part, const std::string& note) const;
    [[nodiscard]] static OpenedPart<std::vector<VdbGrid>> open(const std::string& file);
};

/// Surfaces: what is cut from ranges of the cells.
struct SurfaceParts {
    using Made = std::string;
    using Whole = LimitSurface;
    std::string path{};
    Progress* progress = nullptr;

    [[nodiscard]] LimitSurface join(std::vector<std::string> parts, std::span<const std::string> names) const;
    [[nodiscard]] static std::string pack(std::string part) { return part; }
    [[nodiscard]] static std::string unpack(const std::string& bytes) { return bytes; }
    [[nodiscard]] Facts store(std::string part, const std::string& note) const;
    [[nodiscard]] static OpenedPart<std::string> open(const std::string& file);
};

/// Pictures: rows of them. What pictures draw over all rows is in each part.
struct PictureParts {
    using Made = detail::PicturePart;
    using Whole = Picture;
    std::filesystem::path path{};

    [[nodiscard]] static Picture join(std::vector<detail::PicturePart> parts, std::span<const std::string> names);
    [[nodiscard]] static std::string pack(const detail::PicturePart& part);
    [[nodiscard]] static detail::PicturePart unpack(const std::string& bytes);
    [[nodiscard]] Facts store(detail::PicturePart part, const std::string& note) const;
    [[nodiscard]] static OpenedPart<detail::PicturePart> open(const std::string& file);
};

/// Some rows of a picture.
[[nodiscard]] detail::PicturePart rows_of(const Picture& picture, const PixelRows& rows);

}  // namespace subvol::cli
