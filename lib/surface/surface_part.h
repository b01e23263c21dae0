// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/surface_share.h"
#include "subvol/limit_surface.h"

namespace subvol::detail {

/// Throws Error(InvalidInput) if an option is out of range, or nothing is asked for.
void check_surface_options(const SurfaceOptions& options);

/// A flag for each cell of a part of a mesh: whether the first look finds that a surface may pass through it. In the halo the
/// flags mean nothing.
[[nodiscard]] std::vector<std::uint8_t> surface_candidates(const HexMesh& part, std::string_view field,
                                                           const SurfaceOptions& options);

/// `limit_surface` of a mesh of which only a part is there: the same bits.
///
/// part:    its points and cells have the order that they have in the whole
/// owned:   a flag for each cell that a surface may be cut from; all `surface_candidates` of the whole are owned, and have
///          their halo about them
/// whole:   the extent of the whole
/// returns: nothing if the surface leads into a cell that is not owned
[[nodiscard]] std::optional<LimitSurface> limit_surface_of_part(const HexMesh& part, std::span<const std::uint8_t> owned,
                                                                const LimitExtent& whole, std::string_view field,
                                                                const SurfaceOptions& options);

/// The same for `share_of_surface`. All shares must have the same part.
///
/// rename: gives each place the cell number of the whole mesh, when everything is known there
[[nodiscard]] std::optional<std::string> share_of_part(const HexMesh& part, std::span<const std::uint8_t> owned,
                                                       const LimitExtent& whole, std::string_view field,
                                                       const SurfaceOptions& options, const Share& share,
                                                       const std::function<void(LimitQuery&)>& rename);

/// How many layers of cells around the candidates a share looks at: the same for all, so that none can look farther if the
/// surface leads out there.
[[nodiscard]] int layers_of_shares(const SurfaceOptions& options);
[[noreturn]] void fail_far_share(const std::string& where);

/// The share of a surface that does not pass any cell.
[[nodiscard]] std::string empty_surface_share();

}  // namespace subvol::detail
