// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "subvol/progress.h"
#include "subvol/read_options.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Whether a verb reads meshes; the options for reading them make no sense for others. SeveralFields: meshes, and --field may
/// be given more than once.
enum class Reads { Meshes, SeveralFields, NoMesh };

/// The options that every verb has.
struct CommonOptions {
    std::optional<std::string> field;
    std::vector<std::string> fields;          // of a verb that takes several: each --field once, `field` is the first
    std::optional<std::string> density;       // an expression in x, y, z
    std::optional<std::string> warp;          // "DISPL*20"
    std::vector<std::string> only;            // regions
    std::vector<std::string> patches;         // drawn alone
    std::vector<std::string> part_opacities;  // of parts of a solid
    std::vector<std::string> at_rest;         // quantities that are computed before --warp and --only, besides that of --field
    ReadOptions read{};                       // what the library describes of them
    bool clamp_file = false;                  // fields stay within the range that they have in the file
    bool weld = false;                        // join points at the same place
    std::optional<std::string> step;          // a number from 0, "last", "all" or a range
    bool interpolate_time = false;            // between the two steps around read.time
    int threads = 0;                          // 0: all
    bool json = false;
    bool quiet = false;
    std::string progress = "auto";
    std::uint64_t seed = 0;
    bool parts_in_whole = false;  // the verb takes what --only leaves out of the limit of the whole mesh itself
    std::optional<int>
        part_levels{};              // the verb works on the limit of what --only leaves, which `part_of_limit` refines so often
    bool draws = false;             // the verb makes pictures, which messages say
    Progress* listener = nullptr;   // of what is computed from fields
    const CLI::App* app = nullptr;  // which knows what was given
};

/// Adds the options of every verb. A verb that reads no mesh accepts --field and --density, too, because scripts may give them
/// to any verb, but its help does not show them; it refuses the other options for reading meshes.
void add_common_options(CLI::App& app, CommonOptions& options, Reads reads);

/// Adds --crease-angle to a verb that reads meshes and has no scheme, whose options contain it.
void add_crease_angle(CLI::App& app, CommonOptions& options);

/// Refuses options that do not apply to an input.
///
/// throws: Error(InvalidInput) if one of `names` was given
void refuse_options(const CLI::App& app, std::initializer_list<const char*> names, const std::string& reason);

/// Refuses the options that say how the file of a mesh is read. app: null: nothing was given. throws: as above
void refuse_file_options(const CLI::App* app, const std::string& reason);

/// The same, and --density, whose expression needs a mesh.
void refuse_mesh_options(const CLI::App& app, const std::string& reason);

}  // namespace subvol::cli
