// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

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

}  // namespace subvol::detail
