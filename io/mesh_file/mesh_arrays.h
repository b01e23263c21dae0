// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"

namespace subvol::detail {

// VTK's files and grids have what belongs to a mesh beside its fields in arrays with names of ours.
//
// Sets of cells are arrays at the cells, as other programs write them: `set:NAME` is 1 in the cells of the set and 0 in the
// others. Programs that drop or split cells take such arrays along.
//
// Creases, sharp faces and patches name points, and VTK has nothing for faces between cells and the outside: they are whole
// numbers in the field data. An array begins with the mark of its mesh: the numbers of points and hexahedra, and a hash of the
// corners. A program that changes the mesh keeps the array as it is, so an array with another mark is ignored.
//
//     SubvolSharp   the mark, the number of creases, two points for each, four for each sharp face. A file of a mesh without
//     any
//                   has it too, so that no sharp edges are looked for when it is read
//     patch:NAME    the mark, four points for each face of the patch

/// An array of field data.
struct NamedNumbers {
    std::string name;
    std::vector<std::int64_t> numbers;  ///< all components, one tuple after the other
};

/// Whether field data of this name belongs to a mesh.
[[nodiscard]] bool is_field_array(std::string_view name);

/// Whether an array at no points or cells has the time of the mesh: ParaView and VisIt call it so.
[[nodiscard]] bool is_time_array(std::string_view name);

/// What is said of an array at no points or cells of which nothing is taken.
[[nodiscard]] IgnoredPart ignored_field_data(const std::string& name);

/// Takes the time of the mesh from what such an array has, unless it is not one finite number.
void take_time(std::string_view name, std::span<const double> values, MeshFile& found);

/// The arrays of a mesh; patches without sides have none.
[[nodiscard]] std::vector<NamedNumbers> field_arrays(const HexMesh& mesh, const MeshSets& sets);

/// Those of a file: a mesh that has neither creases nor sharp faces says so.
[[nodiscard]] std::vector<NamedNumbers> settled_arrays(const HexMesh& mesh, const MeshSets& sets);

/// Adds what the arrays have to the file's mesh: `found.sharp` and `found.patches`. Warnings for those that are ignored: of
/// another mesh, of the wrong length, with a point or a face that does not exist.
///
/// found: with all its points and cells
void take_field_arrays(std::span<const NamedNumbers> arrays, MeshFile& found);

/// Adds warnings of field arrays that are not integers. names: of the arrays
void ignore_field_arrays(std::span<const std::string> names, MeshFile& found);

/// Whether an array at cells is a set of cells: it has one component and such a name.
[[nodiscard]] bool is_set_array(std::string_view name, std::size_t components);

/// The name of the array of a set.
[[nodiscard]] std::string set_array_name(const CellSet& set);

/// Adds the cells whose value is a number other than 0.
///
/// array: the name of the array; first: the number of the first value's cell
void add_to_set(ByName<FileSet>& sets, std::string_view array, std::size_t first, std::span<const double> values);

/// Whether an array at points is a set of nodes, as `is_set_array`.
[[nodiscard]] bool is_node_set_array(std::string_view name, std::size_t components);

/// The name of the array at points that has 1 at those of a set of nodes; and these numbers.
[[nodiscard]] std::string node_array_name(const NodeSet& set);
[[nodiscard]] std::vector<std::uint8_t> flags_of(const HexMesh& mesh, const NodeSet& set, std::size_t points);

/// Makes sets of nodes of the arrays at points that are such.
void take_node_set_arrays(MeshFile& found);

/// Makes sets of cells and of nodes of the arrays that are such.
void take_set_arrays(MeshFile& found);

/// Whether all values are whole numbers that doubles hold exactly.
[[nodiscard]] bool are_whole(std::span<const double> values);

}  // namespace subvol::detail
