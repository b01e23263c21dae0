// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/draw_shells.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/option_names.h"
#include "subvol/picture_look.h"
#include "subvol/stream_surface.h"
#include "subvol/streamlines.h"

namespace subvol {

/// What users choose of streamlines and arrows.
struct FlowChoices {
    /// The vectors that streamlines follow and that arrows show, quantities as for `vectors_of`; empty: there are none.
    std::string streamlines{}, glyphs{};
    std::size_t seed_count = 30;  ///< places of each text of seeds, and of the middles of cells without them
    StreamlineOptions lines{};
    TubeOptions tubes{};
    GlyphOptions arrows{};

    [[nodiscard]] bool any() const { return !streamlines.empty() || !glyphs.empty(); }
    /// The length of the vector that is shown, as a quantity of the mesh: what gives the colours unless a field is chosen.
    [[nodiscard]] std::string length_of(const HexMesh& mesh) const;
};

/// streamlines, seed-count, stream-…, tube-radius, glyphs, glyph-…
[[nodiscard]] std::vector<Option> options_of(FlowChoices& choices);

/// The opacities of a body about streamlines, unless its look or opacities are chosen, or it is cut: a solid with a thin
/// surface.
void veil_body(LookChoices& look, const Clip& clip);

/// What is drawn of vectors within a body: streamlines as tubes, and arrows.
struct Flow {
    FlowChoices chosen{};
    /// x, y, z at each point of the mesh, which streamlines follow; empty: there are none.
    std::vector<double> stream_vectors{};
    std::vector<Vec3> seeds{};            ///< where streamlines start
    std::vector<double> glyph_vectors{};  ///< x, y, z at each point of the mesh, which arrows show; empty: there are none
    LimitOptions limit{};                 ///< options of the mesh's limit, with the progress
};

/// Vectors of both, without seeds.
///
/// throws: Error(InvalidInput) as `vectors_of`, with the option's name
[[nodiscard]] Flow flow_in(const HexMesh& mesh, const FlowChoices& choices, OptionNames names, Progress* progress = nullptr);

/// Tubes and arrows as triangles with values.
///
/// mesh:   its last attribute gives the values
/// facts:  get those of the streamlines, and the number of glyphs
/// throws: Error(InvalidInput) as `trace_streamlines`, or if no seed lies in the volume
[[nodiscard]] ColoredSurface flow_surface(const HexMesh& mesh, const Flow& flow, Facts& facts);

}  // namespace subvol
