// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report.h"
#include "subvol/detail/mesh_share.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::cli {

/// What `info` says to people about a mesh: a line for each figure, with units, and at the end whether the mesh is sound.
///
/// seconds: of each stage, as in the report
[[nodiscard]] std::string mesh_lines(const ReadResult& read, const MeshReport& mesh, const Json& seconds);

/// The same for all shares joined.
[[nodiscard]] std::string mesh_lines(const ReadResult& read, const detail::MeshShare& joined, const Json& seconds);

/// The number of inverted cells that a verdict names.
inline constexpr std::size_t kCellsNamed = 8;

/// inverted: the first cells that are
[[nodiscard]] std::string verdict(const MeshReport& report, std::span<const std::size_t> inverted);

/// "sound", or what is wrong, as "51 cells inverted: 3, 17, 20, …".
[[nodiscard]] std::string verdict(const HexMesh& mesh, const MeshReport& report);

/// A line about the mesh that a scheme of tetrahedra makes, from `TetRefinement::figures`.
[[nodiscard]] std::string refined_lines(const Json& figures);

}  // namespace subvol::cli
