// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/mend_folds.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/surface.h"

namespace subvol {

struct ShapeFolds {
    bool keep = false;  ///< points do not move where the limit folds or may fold; else they do, by `mend_folds`
    /// How far points of the boundary may move by `mend_folds`, along it mostly, as a part of their shortest edge
    double boundary_edges = 0.2;
};

[[nodiscard]] std::vector<Option> options_of(ShapeFolds& folds);

struct FitShapeOptions {
    SchemeOptions scheme{};
    int rounds = 10;  ///< how often the nearest places are looked for and the points moved, at most
    /// The weight with which neighbours move together, beside the distances about a control point; > 0
    double stiffness = 0.01;
    ShapeFolds folds{};                         ///< what happens where the limit folds
    OptionNames names = OptionNames::Keywords;  ///< how errors call the options
    Progress* progress = nullptr;
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(FitShapeOptions& options);

/// Distances between the boundary of a limit and a surface, in the world.
struct ShapeError {
    double rms = 0, max = 0;                  ///< from places of the boundary to the surface
    double covered_rms = 0, covered_max = 0;  ///< the same without places over a hole, to whose edge they are nearest
    double hole_part = 0;                     ///< the part of the boundary's area that is over holes
    double reached_part = 1;                  ///< of the surface's area: nearer to the boundary than half a side of its cells
    double missed_rms = 0, missed_max = 0;  ///< from places of the surface to the boundary: large where the mesh does not reach
    Vec3 max_at{std::numeric_limits<double>::quiet_NaN()};  ///< the place of the boundary that is farthest from the surface
    Vec3 missed_at{max_at};                                 ///< the place of the surface that is farthest from the boundary
};

/// Measures a boundary at the vertices of level 2, 25 for each side, and a surface at as many places.
///
/// throws: Error(InvalidInput) as `refine`, or if the surface is not valid
[[nodiscard]] ShapeError shape_error(const HexMesh& mesh, const Surface& surface, const SchemeOptions& scheme = {});

struct FitShapeReport {
    ShapeError before, after;      ///< error before and after the fit
    int rounds = 0;                ///< rounds that were made
    double moved_world = 0;        ///< the longest way of a control point
    double volume_world = 0;       ///< what the boundary of the limit encloses, by its points of level 2
    FoldReport folds;              ///< folds of the limit in the end
    std::size_t mended = 0;        ///< cells that folded or were undecided though they are regular, before they were mended
    std::size_t open_edges = 0;    ///< edges of the surface of one triangle alone
    double open_length_world = 0;  ///< length of these edges
    std::vector<std::size_t> folded_cells;    ///< control cells whose limit folds
    std::vector<std::size_t> inverted_cells;  ///< control cells that are turned inside out at a corner
    /// Sentences for users about what is wrong: folds, inverted cells, holes of the surface, mending that did not end
    std::vector<std::string> warnings;

    /// Whether no cell is known to fold or to be inverted.
    [[nodiscard]] bool is_sound() const { return folded_cells.empty() && inverted_cells.empty(); }
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const FitShapeReport& report);

struct ShapedMesh {
    HexMesh mesh;
    FitShapeReport report;
};

/// Moves control points so that the boundary of the limit lies on a surface: in the least squares sense, by Gauss-Newton steps
/// with the nearest places of both. Points inside follow those around them; no control cell is turned inside out. Whether the
/// limit folds is checked in the end (`check_folds`).
///
/// surface: closed or open; which side is outside does not matter
/// throws:  Error(InvalidInput) as `refine`, if the surface is not valid, or if an option is out of range
/// cost:    some 2 ms for each side of a cell at the boundary, and memory for one level of the mesh; parallel, the same bits
///          for any number of threads
[[nodiscard]] ShapedMesh fit_shape(HexMesh mesh, const Surface& surface, const FitShapeOptions& options = {});

/// throws: Error(InvalidInput) if there is no triangle, a corner does not exist, or a point of a triangle is not finite
void validate(const Surface& surface);

}  // namespace subvol
