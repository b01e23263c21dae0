#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common_options.h"
#include "report.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"

namespace subvol::cli {

inline constexpr const char* kInputHelp =
    "a mesh (.mesh, .meshb, .vtk, .vtu, .vts, .msh, .exo, .xyz), or model:NAME or model:NAME:RESOLUTION";

/// Reads a mesh file, or generates "model:NAME[:RESOLUTION]". Puts "input" and the reader's warnings into the report.
[[nodiscard]] ReadResult read_input(const std::string& input, const CommonOptions& options, Report& report);

/// `read_input` without the unused points; --density becomes the first attribute.
[[nodiscard]] HexMesh load_mesh(const std::string& input, const CommonOptions& options, Report& report);

/// The mesh with nothing but the field that the options select, as its first scalar, and where it is named a second one.
[[nodiscard]] HexMesh with_selected_field(HexMesh mesh, const CommonOptions& options, Report& report,
                                          const std::optional<std::string>& second = {});

struct Range {
    double min = 0, max = 0;
};

/// The range of one of the mesh's attributes.
[[nodiscard]] Range field_range(const HexMesh& mesh, std::size_t attribute = 0);

/// Refuses an output before any work is done for it: a file name that ends in none of `extensions`, a folder that is not there
/// or that nothing can be written to.
///
/// throws: Error(InvalidInput), Error(Io)
void check_output(const std::filesystem::path& path, const std::vector<std::string>& extensions,
                  const std::vector<std::string>& planned = {});

/// Makes a folder for outputs, and those above it, if need be.
///
/// throws: Error(Io) if it cannot be made, or nothing can be written to it
void make_folder(const std::filesystem::path& path);

}  // namespace subvol::cli
