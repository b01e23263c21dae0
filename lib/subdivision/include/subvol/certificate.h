// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol {

/// What is known of the limit of a control cell.
///
/// Proved:    det ∂x/∂u > 0 everywhere in the closed cell, but on its irregular edges and points, where it may be 0
/// Folded:    det ∂x/∂u < 0 at a place that is known, by a proof or by sampling
/// Open:      neither was found within the tests that are allowed
/// Irregular: the same, near an irregular edge or point, where the derivatives of the limit have no bounds
enum class FoldVerdict : std::uint8_t { Proved, Folded, Open, Irregular };

template <>
struct NameTable<FoldVerdict> {
    static constexpr Name<FoldVerdict> rows[] = {{FoldVerdict::Proved, "proved", "the limit does not fold"},
                                                 {FoldVerdict::Folded, "folded", "the limit folds at a known place"},
                                                 {FoldVerdict::Open, "open", "undecided within the tests allowed"},
                                                 {FoldVerdict::Irregular, "irregular", "undecided near an irregular edge"}};
};

/// What keeps a cell undecided: nothing but the tests allowed, or the first of what is irregular at its corners.
enum class UndecidedKind : std::uint8_t { Regular, SharpFace, BoundaryEdge, CrowdedEdge, IrregularPoint, IrregularEdge };

template <>
struct NameTable<UndecidedKind> {
    static constexpr Name<UndecidedKind> rows[] = {
        {UndecidedKind::Regular, "regular", "nothing is irregular at its corners"},
        {UndecidedKind::SharpFace, "sharp_face", "it touches a sharp face inside the mesh"},
        {UndecidedKind::BoundaryEdge, "boundary_edge",
         "it touches an edge of the boundary with more than two cells, or a crease with two"},
        {UndecidedKind::CrowdedEdge, "crowded_edge", "it touches an edge inside with more than eight cells"},
        {UndecidedKind::IrregularPoint, "irregular_point", "it touches a point where irregular edges meet or end"},
        {UndecidedKind::IrregularEdge, "irregular_edge", "it touches an edge inside with other than four cells"}};
};

struct FoldOptions {
    SchemeOptions scheme{};                     ///< as for all calls; MCQ is certified with its tension of 1/16 alone
    int levels = 5;                             ///< how often a cell is cut into eight where one test does not decide
    int irregular_levels = 2;                   ///< how often a cell near an irregular edge is refined for the same;
                                                ///< at straight edges of Catmull-Clark and BSXW up to four times more
    int tests = 1000;                           ///< the most tests of a cell
    OptionNames names = OptionNames::Keywords;  ///< how errors call the options
    Progress* progress = nullptr;
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(FoldOptions& options);

struct FoldMotionOptions {
    FoldOptions folds{};
    int time_levels = 5;  ///< how often the time is halved where cells are not decided
};

/// The options without those of folds.
[[nodiscard]] std::vector<Option> options_of(FoldMotionOptions& options);

/// A place where the limit is folded: uvw in the cell, its position, and det ∂x/∂u there.
struct FoldPlace {
    Index cell = 0;
    Vec3 uvw{0.0};
    Vec3 position{0.0};
    double determinant = 0;
    bool sampled = false;  ///< this was found by sampling, where nothing is proved
    double time = 0;       ///< between two meshes: from 0 to 1
};

struct FoldReport {
    struct Sampled {
        std::size_t cells = 0, places = 0, folded = 0;
        double least = 0;
    };
    std::size_t proved = 0, folded = 0, open = 0, irregular = 0;  ///< numbers of cells
    /// How many cells of each kind are not decided
    std::array<std::size_t, std::size(NameTable<UndecidedKind>::rows)> undecided_kinds{};
    double open_volume = 0, irregular_volume = 0;  ///< of the cells that are not decided, the part that stays open, in cells
    std::size_t tests = 0;                         ///< tests in all
    int deepest = 0;                               ///< the level of the smallest part that was tested
    /// Cells that no test decided and that were sampled, at how many places; how many of these cells are folded, as they are at
    /// a place; and the least determinant, as a part of the mean magnitude
    Sampled sampled;
    std::vector<std::string> warnings;
};

/// "verdict" (sound, folded or undecided), "cells" with proved, folded, undecided and irregular (those of the undecided that
/// are near irregular edges), "undecided_kinds" with those that there are, "open_volume" of the undecided, and "sampled" with
/// its members.
[[nodiscard]] Facts facts_of(const FoldReport& report);

struct FoldCheck {
    std::vector<FoldVerdict> verdicts;  ///< verdicts of the cells
    std::vector<double> open;           ///< part of each cell that is not decided, 0 to 1
    std::vector<FoldPlace> places;      ///< places of the folded cells, in their order
    FoldReport report;
};

/// Decides for the limit of each cell whether it folds: with a proof that its Jacobian is positive, or a place where it is not.
///
/// Where the cells around are a grid, the derivatives are a polynomial and a rest with a proved bound (docs/science.md); those
/// of Catmull-Clark, BSXW and the linear scheme are polynomials. Cells at irregular edges are refined: what lies farther from
/// the edge is decided. Around the edge all levels of Catmull-Clark and BSXW are decided at once where the edge is straight,
/// and where such edges meet or end at a smooth boundary (docs/folds.md); of MCQ a tube stays open. Cells that stay undecided
/// are sampled at some hundred places each, and folded where a determinant is negative; that none was found proves nothing.
/// Positive Jacobians exclude folds inside the volume; that no two parts of it overlap also needs a boundary that does not meet
/// itself.
///
/// throws: Error(InvalidInput) as `refine`, or if an option is out of range
/// cost:   parallel, about 12 µs a test and 1 ms for each cell that is sampled; the same result for any number of threads
[[nodiscard]] FoldCheck check_folds(const HexMesh& mesh, const FoldOptions& options = {});

/// Decides for each cell whether its limit folds at any time while all points move straight from one mesh to another. Cells are
/// proved for all times, and folded at a time that is known; parts that stay open are those of volume and time. Nothing is
/// sampled, so a fold may be missed where nothing is proved: such cells are open or irregular.
///
/// throws: Error(InvalidInput) as `check_folds`, or if the cells, creases or sharp faces differ
/// cost:   as `check_folds` for each stretch of time into which the motion is divided, at most 2^time_levels, of the cells that
///         are open in it
[[nodiscard]] FoldCheck check_folds_between(const HexMesh& before, const HexMesh& after, const FoldMotionOptions& options = {});

}  // namespace subvol
