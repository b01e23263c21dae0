// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report.h"
#include "subvol/detail/mesh_share.h"

namespace subvol::cli {

/// [x, y, z]
[[nodiscard]] Json json_of(const Vec3& point);

/// [lower corner, upper corner]
[[nodiscard]] Json json_of(const Box& box);

/// Puts the figures of a mesh into a report, as `info` has them.
void put_mesh_report(Report& report, const MeshReport& mesh);

/// The figures of a share, for `join`.
[[nodiscard]] Json json_of(const detail::MeshShare& share);

/// What `json_of` made of a share. file: named in the error
///
/// throws: Error(InvalidInput)
[[nodiscard]] detail::MeshShare mesh_share_from(const Json& json, const std::string& file);

}  // namespace subvol::cli
