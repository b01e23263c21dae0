// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "subvol/mesh_source.h"
#include "subvol/refine.h"
#include "subvol/render_tets.h"

namespace subvol {

struct BrickTetsOptions {
    RefineOptions refine{};  ///< how the mesh is refined, onto the limit where the scheme does not interpolate
    TetsOptions tets{};      ///< as for a mesh in one piece
    /// About the most that the cells of a part of the picture take; besides there is a brick.
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
};

/// What every picture of the tetrahedra of a refined mesh in bricks depends on.
struct BrickTets {
    Box bounds{};                  ///< the box of the refined points, on the limit
    std::vector<Box> of_bricks{};  ///< the box of the refined points of each brick
    /// How far a refined cell reaches out of the box of its control cell at most, as a part of that box's diagonal.
    double overhang = 0;
    std::size_t tets = 0, degenerate_tets = 0, inverted_tets = 0;

    /// Adds those of the next bricks.
    void add(const BrickTets& other);
};

/// Measures the tetrahedra of some pieces, from `begin` to before `end`. Each piece is read and refined once.
///
/// throws: what reading throws, and `refine`; Error(InvalidInput) if the pieces have fewer than three layers of halo;
///         Error(Cancelled)
[[nodiscard]] BrickTets measure_tets(const MeshSource& source, const BrickTetsOptions& options, std::size_t begin,
                                     std::size_t end);

/// Draws a mesh in pieces: the picture has the bits of `render_tets` of the whole mesh, refined and moved to the limit. For
/// each part of the picture the cells that its rays may cross are gathered and refined; parts are halved until these cells fit
/// into the memory.
///
/// source:  with one field of one channel
/// all:     `measure_tets` of all pieces in their order
/// returns: without the bytes of tetrahedra; the seconds of all parts
/// throws:  as `measure_tets` and `render_tets`; Error(InvalidInput) if the cells of one pixel do not fit into the memory
/// cost:    each piece is read once for each part of the picture that it may be seen in
[[nodiscard]] TetsResult render_tets(const MeshSource& source, const BrickTets& all, const View& view, const Optics& optics,
                                     const BrickTetsOptions& options = {});

}  // namespace subvol
