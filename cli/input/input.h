// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common_options.h"
#include "picture_arguments.h"
#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"
#include "subvol/part_opacity.h"
#include "subvol/region.h"
#include "subvol/warp.h"

namespace subvol::cli {

/// What an argument FILE may be, for its help: a mesh with one of the extensions that the library reads, or a model.
[[nodiscard]] std::string input_help();

/// Bricks: a mesh in a folder of bricks
enum class InputKind { Picture, Mesh, Bricks, Points, Grid };

/// The kind of an input. "model:…" and the extensions of mesh files are meshes, the extensions of points are points, and a .vdb
/// file is what it contains. Anything else should be a picture.
[[nodiscard]] InputKind kind_of(const std::string& input);

/// Whether the input is "model:NAME" and no file.
[[nodiscard]] bool is_model(const std::string& input);

/// How a mesh file is to be read.
[[nodiscard]] ReadOptions read_options(const std::string& input, const CommonOptions& options);

/// The regions of --only; blocks are sets of cells.
[[nodiscard]] std::vector<Region> regions_of(const CommonOptions& options);

/// The options with those of --only that choose whole cells, blocks among them, for reading. The parts of space go to `space`:
/// where something is measured they are cut out of the limit.
[[nodiscard]] CommonOptions with_whole_cells(CommonOptions options, std::vector<Region>& space);

/// Whether a file of shells and beams without cells is an error.
enum class ShellsAlone { Refuse, Take };

/// What --warp and --part-opacity have made of a mesh.
struct Reshaped {
    std::optional<Warp> moved{};     ///< the displacement with its factor
    std::optional<HexMesh> whole{};  ///< the mesh that the shells are sides of
    /// A flag for each cell of the mesh that --only leaves, if the verb takes these out of the whole; empty: all.
    std::vector<std::uint8_t> in_part{};
    std::vector<float> opacities{};  ///< the opacities of the shells' quads, which are the translucent parts
};

/// Reads a mesh file, or generates "model:NAME[:RESOLUTION]". The reader's warnings are facts.
///
/// reshaped: gets what was made of the mesh
[[nodiscard]] WithFacts<ReadResult> read_input(const std::string& input, const CommonOptions& options, Progress* progress,
                                               ShellsAlone alone = ShellsAlone::Refuse, Reshaped* reshaped = nullptr);

/// `read_input` without the unused points; --density becomes the first attribute.
///
/// shells: gets the shells and beams; null: a warning says that they are left out
/// alone:  Take: shells without cells give a mesh of their points and fields without cells
[[nodiscard]] WithFacts<HexMesh> load_mesh(const std::string& input, const CommonOptions& options, Progress* progress,
                                           Shells* shells = nullptr, ShellsAlone alone = ShellsAlone::Refuse);

/// `load_mesh` with the patches and sets of cells, for what becomes a mesh file again.
[[nodiscard]] WithFacts<HexMesh> load_mesh(const std::string& input, const CommonOptions& options, Progress* progress,
                                           MeshSets& sets, Shells* shells = nullptr);

/// What `load_mesh` makes of a file that was read.
[[nodiscard]] WithFacts<HexMesh> mesh_of(ReadResult read, const CommonOptions& options, Shells* shells);

/// The fields of what `read_input` returned: with --density that one first, with --field that one alone.
///
/// throws: Error(InvalidInput) if the expression has no value at a point, or if there is no such field
[[nodiscard]] std::vector<FieldInfo> chosen_fields(const ReadResult& read, const CommonOptions& options);

/// A warning that shells and beams are left out; empty if there are none.
[[nodiscard]] std::string shells_left_out(const Shells& shells);

/// The shells with --density as their first attribute.
[[nodiscard]] Shells with_density(Shells shells, const CommonOptions& options);

/// The unit of a field of a file, of a component of it, or of its length, such as "U", "U.x", "length(U)"; empty: not known.
[[nodiscard]] std::string unit_of(const std::vector<FieldInfo>& fields, const std::string& quantity);

/// `chosen_patches` of --patch, which errors name.
[[nodiscard]] std::vector<Patch> patches_of_option(const HexMesh& mesh, const MeshSets& sets,
                                                   const std::vector<std::string>& names);

/// What a call returns; its errors name the option.
template <class Call>
decltype(auto) of_option(const std::string& option, const Call& call) {
    try {
        return call();
    } catch (const Error& error) {
        throw Error(error.code(), (error.where().empty() ? "" : error.where() + ": ") + error.message(), option,
                    error.allowed());
    }
}

/// A mesh that was read, without the unused points; --density becomes the first attribute.
[[nodiscard]] HexMesh used_mesh(HexMesh read, const CommonOptions& options);

/// The mesh as it is written: with --field that one alone, vectors as they are. throws: Error(InvalidInput) if there is none
[[nodiscard]] HexMesh with_written_field(HexMesh mesh, const CommonOptions& options);

/// The mesh with only the fields that the options select, as scalars, and with the field `second` if that is given.
[[nodiscard]] WithFacts<HexMesh> with_selected_field(HexMesh mesh, const CommonOptions& options,
                                                     const std::optional<std::string>& second = {});

/// The range of one of the mesh's attributes.
[[nodiscard]] Range field_range(const HexMesh& mesh, std::size_t attribute = 0);

}  // namespace subvol::cli
