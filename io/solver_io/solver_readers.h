// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "mesh_format.h"
#include "subvol/read_options.h"

namespace subvol::detail {

class Hdf5File;

// The readers of solvers' files in the rows of the table of formats. Each `NAME_times` gives the times of the steps of a file.

/// Reads a step of Exodus II.
///
/// throws: Error(MissingCapability) for an HDF5 file if this library is built without HDF5
[[nodiscard]] ReadResult read_exodus(std::string_view text, std::string_view file, const ReadOptions& options);
/// The same from a file; a name such as a.e.4.0 stands for the first of four pieces, which are joined.
[[nodiscard]] ReadResult read_exodus_file(const std::filesystem::path& path, const ReadOptions& options);
/// The number of pieces that such a name stands for; 0 if it is another name.
[[nodiscard]] std::size_t exodus_parts(const std::filesystem::path& path);
[[nodiscard]] MeshFile read_exodus_part(const std::filesystem::path& path, std::size_t part, const ReadOptions& options);
[[nodiscard]] MeshFile read_exodus_piece(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> exodus_times(const std::filesystem::path& path);

/// Writes blocks of elements HEX8 with the sets, patches as side sets, and all fields as scalars of one step. Warnings name
/// scalars that have other names there; creases are counted.
///
/// throws: Error(InvalidInput) if there are more nodes or elements than the file can number
std::vector<std::string> write_exodus(const std::filesystem::path& path, const WrittenMesh& written);

/// Reads a step of CalculiX's results, as text.
[[nodiscard]] ReadResult read_frd(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> frd_times(const std::filesystem::path& path);

/// Reads a step of the first base of a CGNS file in HDF5: structured and unstructured zones, as blocks that are joined.
[[nodiscard]] ReadResult read_cgns(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_cgns(const Hdf5File& file, const ReadOptions& options);

[[nodiscard]] std::vector<double> cgns_times(const std::filesystem::path& path);

/// Reads a step of an EnSight Gold case, of text or of C's binary files. Its parts are joined.
[[nodiscard]] ReadResult read_ensight(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] std::vector<double> ensight_times(const std::filesystem::path& path);

/// Reads a step of an OpenFOAM case. path: its folder, or a file in it
[[nodiscard]] ReadResult read_foam(const std::filesystem::path& path, const ReadOptions& options);
/// The number of processors of a decomposed case, else 1; and one of them as a part of the mesh.
[[nodiscard]] std::size_t foam_parts(const std::filesystem::path& path);
[[nodiscard]] MeshFile read_foam_part(const std::filesystem::path& path, std::size_t part, const ReadOptions& options);
[[nodiscard]] std::vector<double> foam_times(const std::filesystem::path& path);

/// Writes a case of OpenFOAM beside its file: constant/polyMesh with the patches and the sets as zones, fields in the folder 0
/// and system/controlDict, unless these folders are there. Warnings name patches, sets and fields that have other names there,
/// or are left out; creases are counted.
///
/// throws: Error(InvalidInput) as `build_topology`, and if there is a mesh already
std::vector<std::string> write_foam(const std::filesystem::path& path, const WrittenMesh& written);

/// Reads an Abaqus or CalculiX deck: nodes, elements of volumes, parts, instances, and sets of elements as blocks.
[[nodiscard]] ReadResult read_inp(const std::filesystem::path& path, const ReadOptions& options);

/// Writes a deck of elements C3D8 with the sets and, for each patch, a surface and a set of nodes. Warnings name sets that have
/// other names there, and fields; creases are counted.
///
/// throws: Error(InvalidInput) if there are more nodes or elements than a deck can number
std::vector<std::string> write_inp(const std::filesystem::path& path, const WrittenMesh& written);

/// What a deck has, for a file of its results.
struct DeckContents {
    MeshFile found;                      ///< its cells of volumes, sets, surfaces and blocks, with its points
    std::vector<std::int64_t> nodes;     ///< number of each point
    std::vector<std::int64_t> elements;  ///< number of each cell, as cells are counted in `found`
};

/// throws: Error(InvalidInput) as `read_inp`, or if it has parts and instances, whose numbers are not those of the results
[[nodiscard]] DeckContents read_inp_contents(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
