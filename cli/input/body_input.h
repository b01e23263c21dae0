// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bricks_input.h"
#include "input.h"
#include "tet_refinement.h"

namespace subvol::cli {

/// Whether the fields that are not selected stay, behind the selected one.
enum class OtherFields { Drop, Keep };

/// What a command works on: a mesh in memory, or bricks that are read one at a time. Commands work with its source, and need
/// not know which it is.
class BodyInput {
public:
    BodyInput(std::string input, HexMesh mesh) : input_(std::move(input)), mesh_(std::move(mesh)) {}
    BodyInput(std::string input, Bricks bricks) : input_(std::move(input)), bricks_(std::move(bricks)) {}

    /// Refers to this body.
    [[nodiscard]] MeshSource source() const;

    /// Selects the fields that the options name, as scalars: the first of the fields.
    ///
    /// second:  of a mesh in memory, a field that becomes the last one
    /// returns: the name of the first; facts as those of `with_selected_field`
    [[nodiscard]] WithFacts<std::string> select(const CommonOptions& options, OtherFields others,
                                                const std::optional<std::string>& second = {});

    /// The names of the fields that `select` has selected, in their order.
    [[nodiscard]] const std::vector<std::string>& selected() const { return selected_; }

    /// Adds a field as a scalar, unless it is there.
    ///
    /// returns: its number
    /// throws:  Error(InvalidInput) if there is no such field
    std::size_t add_scalar(const std::string& field);

    /// The range of a field's values at the points; of a vector that of its length.
    [[nodiscard]] Range range(const std::string& field) const;

    /// A scheme of tetrahedra takes the place of the mesh by `TetRefinement::hexes`, if it is asked for.
    ///
    /// throws: Error(InvalidInput) if it is asked for bricks
    [[nodiscard]] Facts refine(const TetRefinement& tets, int default_levels, Progress* progress);

    /// The mesh in memory, for what is not done piece by piece.
    ///
    /// throws: Error(InvalidInput) for bricks, which the scheme of tetrahedra does not refine
    [[nodiscard]] const HexMesh& mesh_for(const TetRefinement& tets) const;

    Shells shells{};                   // of a mesh in memory
    std::vector<MeshBlock> blocks{};   // of a mesh in memory
    MeshSets sets{};                   // of a mesh in memory
    std::vector<FieldInfo> of_file{};  // of its file
    std::optional<Warp> moved{};       // by --warp, with its factor
    std::optional<HexMesh> whole{};    // that the shells are sides of, if these are patches or translucent parts
    std::vector<std::uint8_t>
        in_part{};                   // a flag for each cell that --only leaves, if the verb asked for the whole; empty: all
    std::vector<float> opacities{};  // of the shells' quads, which are translucent parts; empty: shells are opaque

private:
    std::string input_;
    HexMesh mesh_;
    std::optional<Bricks> bricks_;
    BrickFields change_;  // of bricks
    std::vector<std::string> selected_{};
};

/// Opens bricks, or reads a mesh without the unused points; --density becomes the first attribute.
///
/// app:    of the verb; options that bricks cannot have are refused
/// shells: whether shells and beams are wanted; else a warning says that they are left out
/// alone:  Take: of shells without cells, the mesh has the points and fields
[[nodiscard]] WithFacts<BodyInput> open_body(const std::string& input, const CommonOptions& options, const CLI::App& app,
                                             Progress* progress, bool shells = false, ShellsAlone alone = ShellsAlone::Refuse);

}  // namespace subvol::cli
