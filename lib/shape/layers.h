// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// The mesh with a layer of cells on its boundary, so that each cell has one side there at most.
///
///     ┌───┬───┐      ┌───┬───┐   The points of the old boundary move inwards, by a part of the way to the middles of their
///     │   │   │      ├┐ ┌┴┐ ┌┤   cells, and new ones take their places.
///     └───┴───┘      └┴─┴─┴─┴┘
///
/// The boundary has to be a surface. Attributes are dropped.
[[nodiscard]] HexMesh with_layer(const HexMesh& mesh);

/// The mesh, in which every cell has one side at the boundary at most, with one more layer of cells: under those at the
/// boundary, and on both sides of each crease. So a crease may turn at each of its points: no side at the boundary has two
/// edges of it.
///
///     ┌───┬───┐      ┌───┬───┐
///     │   │   │      ├──┐│┌──┤   Seen from outside, with a crease in the middle.
///     ├───┼───┤      │  ││├──┤
///     │   │   │      ├──┘│└──┤
///     └───┴───┘      └───┴───┘
///
/// along: edges of the boundary, the smaller point first; they stay where they are. Each point has none or at least two of them
[[nodiscard]] HexMesh with_layer_along(const HexMesh& mesh, std::span<const std::array<Index, 2>> along);

}  // namespace subvol::detail
