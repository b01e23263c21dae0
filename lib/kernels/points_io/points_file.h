// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "subvol/points_io.h"

namespace subvol::detail {

// The arrays of a .vtp of points, besides those of the channels.
inline constexpr const char* kVtpKernel = "kernel";
inline constexpr const char* kVtpChannels = "channels";
inline constexpr const char* kVtpTriangles = "boundary_triangles";
inline constexpr const char* kVtpFrame = "frame";
inline constexpr const char* kVtpEllipsoid = "ellipsoid";
inline constexpr const char* kVtpSize = "pscale";

// Suffixes to the name of a channel.
inline constexpr const char* kVtpGradient = ".gradient";
inline constexpr const char* kVtpMoment = ".moment";
inline constexpr const char* kVtpHessian = ".hessian";

/// The components of VTK's symmetric tensors are xx yy zz xy yz xz: the index of each among ours.
inline constexpr std::array<std::size_t, 6> kVtpTensorOrder{0, 3, 5, 1, 4, 2};

/// The writers and readers of one format each. The caller validates volumes before they are written and after they are read.
void write_ply(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options);
void write_vtp(const std::filesystem::path& path, const RbfVolume& volume, const std::string& note);
void write_glb(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options);
void write_npz(const std::filesystem::path& path, const RbfVolume& volume);

/// What comes before a note in a comment of either format, and behind it in .vtp.
inline constexpr const char* kNoteMark = " subvol_note ";
inline constexpr const char* kNoteEnd = " -->";

/// The property of a part's points with their places in the whole.
inline constexpr const char* kNumber = "number";

/// numbers: null, or gets them
[[nodiscard]] RbfVolume read_ply(std::string_view text, const std::filesystem::path& path,
                                 std::vector<double>* numbers = nullptr);
[[nodiscard]] RbfVolume read_vtp(std::string_view text, const std::filesystem::path& path);
[[nodiscard]] RbfVolume read_svk(const std::filesystem::path& path);

}  // namespace subvol::detail
