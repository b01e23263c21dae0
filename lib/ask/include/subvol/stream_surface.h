// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/limit_shells.h"
#include "subvol/streamlines.h"

namespace subvol {

struct TubeOptions {
    double radius = 0.003;  ///< radius of the tubes, as a part of the diagonal of the mesh's box
};

/// tube-radius
[[nodiscard]] std::vector<Option> options_of(TubeOptions& options);

struct GlyphOptions {
    std::size_t count = 400;  ///< number of arrows, at most one in each cell
    double size = 0.06;       ///< length of the longest arrow, as a part of the diagonal of the mesh's box
};

/// glyph-count, glyph-size
[[nodiscard]] std::vector<Option> options_of(GlyphOptions& options);

/// Tubes around streamlines, with flat ends, as triangles. The ring of a point lies across the line there, and is not twisted
/// against the one before it.
///
/// returns: the sources are points of the lines
/// throws:  Error(InvalidInput) if the radius is not positive and finite
[[nodiscard]] ShellSurface tube_surface(const Streamlines& lines, double radius_world);

/// Arrows whose middles are at places, as triangles. The longest has the given length, others are as much smaller as their
/// vectors are shorter.
///
/// returns: the sources are numbers of places; a vector of 0 has no arrow
/// throws:  Error(InvalidInput) if there is not one vector for each place, or the length is not positive and finite
[[nodiscard]] ShellSurface arrow_surface(std::span<const Vec3> places, std::span<const Vec3> vectors, double longest_world);

}  // namespace subvol
