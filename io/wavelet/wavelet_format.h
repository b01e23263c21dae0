// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// x, y, z of each point, point-major.
[[nodiscard]] inline std::vector<double> coordinates(const std::vector<Vec3>& points) {
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (const Vec3& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

// A .svw file: kWaveletMagic, the length of the contents (8 bytes, lowest first), and the contents compressed. The contents are
// whole numbers of one or more bytes, seven bits in each, lowest first; signed ones as 0, -1, 1, -2, …; reals as 8 bytes:
//
//   scheme, tension (real), levels
//   points, cells of the control mesh; for each cell its corners, signed, as differences from those of the cell before
//   creases, sharp faces: how many, and their points
//   1 and a bit for each cell of the finest level, set if the cell is there; or 0: all are
//   arrays: how many; for each: the length of its name, the name, its channels, its step (real), and of each channel
//     the control values, signed, as differences from the one before
//     for each level, for each detail one byte: the signed number, or 255 if it is that or more
//     for each 255, in the same order: the rest
//   The first array has the points, and no name.

inline constexpr std::string_view kWaveletMagic = "subvol-wavelets-1\n";

[[nodiscard]] inline std::uint64_t folded(std::int64_t n) {
    return (static_cast<std::uint64_t>(n) << 1) ^ static_cast<std::uint64_t>(n >> 63);
}
[[nodiscard]] inline std::int64_t unfolded(std::uint64_t n) {
    return static_cast<std::int64_t>(n >> 1) ^ -static_cast<std::int64_t>(n & 1);
}

/// The mesh of such contents.
///
/// throws: Error(InvalidInput) if they are not right; `file` is named
[[nodiscard]] HexMesh mesh_of_wavelets(std::string_view contents, const std::string& file);

/// The mesh of a file with this text.
///
/// throws: as mesh_of_wavelets
[[nodiscard]] HexMesh read_wavelet_mesh(std::string_view text, const std::string& file);

}  // namespace subvol::detail
