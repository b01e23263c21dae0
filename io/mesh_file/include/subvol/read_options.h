// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/patch_values.h"
#include "subvol/sharp_edges.h"
#include "subvol/shells.h"

namespace subvol {

/// An array of a file.
struct FieldInfo {
    std::string name;
    std::string location;  ///< "point" or "cell"
    int components = 1;
    double min = 0;         ///< least of its finite values, for vectors of their lengths
    double max = 0;         ///< greatest of its finite values, for vectors of their lengths
    std::string unit = {};  ///< empty where the file does not have it
    /// At how many points of the file, or cells of the mesh, it has no value; 0 for the fields of `ReadResult::mesh`
    std::size_t missing = 0;
};

/// How to read tetrahedra, prisms and pyramids.
///
/// Split:  all cells, hexahedra too, are split by `split_into_hexes`, with a warning
/// Ignore: they are left out, with a warning
/// Refuse: they are an error
enum class OtherCells { Split, Ignore, Refuse };

template <>
struct NameTable<OtherCells> {
    static constexpr Name<OtherCells> rows[] = {
        {OtherCells::Split, "split"}, {OtherCells::Ignore, "ignore"}, {OtherCells::Refuse, "refuse"}};
};

/// What values at cells are taken for. Files that are written have them at cells, whichever it is.
///
/// Constant: they are as they are, the same everywhere in a cell
/// Mean:  at each point the mean over its cells, weighted by their volumes
/// Fit:   they are means over the cells, as finite volumes have them: values at points whose limit volume (of the scheme MCQ)
///        follows these means without waves, as `fit_cell_means` finds them. A warning says how well the means are met
/// Exact: the same, but the means are met wherever that is possible, as by `fit_exact_cell_means`
/// Auto:  Fit for OpenFOAM; for all others Constant where an array of scalars has nothing but whole numbers and the file's type
/// of
///        numbers, or its name, says that these are labels, such as materials and blocks, and Mean else
enum class CellValues { Auto, Mean, Fit, Exact, Constant };

template <>
struct NameTable<CellValues> {
    static constexpr Name<CellValues> rows[] = {{CellValues::Auto, "auto"},
                                                {CellValues::Fit, "fit"},
                                                {CellValues::Mean, "mean"},
                                                {CellValues::Exact, "exact"},
                                                {CellValues::Constant, "constant"}};
};

/// Whether values at cells are taken for means over them.
[[nodiscard]] constexpr bool are_means(CellValues values) {
    return values == CellValues::Fit || values == CellValues::Exact;
}

struct ReadOptions {
    OtherCells other_cells = OtherCells::Split;
    /// Joins points that are no farther apart than this (world units; 0: at exactly the same place), as the borders between
    /// pieces of a file need. The first of them is kept, with its values; a warning gives the number. Nothing: no welding
    std::optional<double> weld = {};
    /// Names of groups of faces and edges (MEDIT, Gmsh): their faces inside the mesh become sharp faces, their edges on the
    /// boundary or on such faces creases. In Gmsh the name of a physical group of dimension 2 or 1, or its number; in MEDIT a
    /// reference of quadrilaterals, triangles and edges, or "Ridges"
    std::vector<std::string> sharp = {};
    /// Curved hexahedra are split into smaller ones, with points on their true shape, so often that these lie within this part
    /// of the mesh's diagonal from the shape, and fields within 400 times this part of their ranges; in at most 65,536
    /// hexahedra, or twice as many as there are between the nodes, p · q · r for a cell of degrees p, q and r. Arrays of whole
    /// numbers do not count. Greater than 0. Nothing: only their corners are used
    std::optional<double> curved_tolerance = 5e-6;
    /// Time step of a series (`open_series`), from 0. Nothing: that of `time`, or the last one
    std::optional<std::size_t> step = {};
    std::optional<double> time = {};  ///< takes the step whose time is nearest to it, if no step is given
    /// The names of the parts of the mesh that are read (`ReadResult::blocks`). None: all
    std::vector<std::string> blocks = {};
    CellValues cell_values = CellValues::Auto;
    PatchValuesUse patch_values = PatchValuesUse::Normal;
    /// Deck (.inp) that a .frd file of CalculiX has the results of: its sets of elements and its surfaces become sets and
    /// patches of the mesh, by the numbers of elements and nodes. Empty: none
    std::string deck = {};
    /// Edges of the boundary that bend by more than this become creases too; 0: none are looked for. Nothing: those that
    /// `keep_sharp_edges` finds, unless the file has creases or sharp faces of its own (`sharp`, or files of ours)
    std::optional<double> crease_angle_deg = {};
    /// A file of shells and beams without any cell is read too. Its mesh has no cells, so most calls refuse it
    bool shells_alone = false;
};

/// other-cells, weld-distance, curved, cell-values, patch-values, step, time, blocks, sharp, mesh, crease-angle
[[nodiscard]] std::vector<Option> options_of(ReadOptions& options);

/// A named part of a mesh.
struct MeshBlock {
    std::string name;
    std::size_t cells = 0;  ///< number of cells of all kinds, as the file has them
};

/// How far the means over cells that values at points were made from are met, in parts of each field's range; the largest of
/// all fields.
struct CellValuesReport {
    CellValues method = CellValues::Fit;  ///< Fit or Exact
    std::size_t fields = 0;
    double rms_of_range = 0, most_of_range = 0;
};

/// What became of curved hexahedra. Errors are estimated from second derivatives; the limit is nearer.
struct CurvedReport {
    std::size_t curved = 0;  ///< curved hexahedra
    std::size_t cells = 0;   ///< all hexahedra of the file
    /// Hexahedra that all of these were split into; as many as `cells` if none is bent by more than the tolerance
    std::size_t hexes = 0;
    std::size_t most_hexes = 0;  ///< no more would have been made
    /// Tolerance that was asked for, in parts of the mesh's diagonal; for the fields 400 times that, in parts of their ranges
    double tolerance = 0;
    double shape_error = 0, fields_error = 0;  ///< what the smaller cells are off at most, in the parts of `tolerance`
    bool limited = false;  ///< an error is above the tolerance, since there would have been more than most_hexes

    [[nodiscard]] bool split() const { return hexes > cells; }
};

/// A field of a file that was left out.
struct UnreadField {
    std::string name;
    std::string why;  ///< what could not be read, such as a value that is not finite
};

/// A part of a file that was not taken: what the mesh and its fields would have lost has a warning, too; of other parts, such
/// as the loads of an input deck, nothing else tells.
struct IgnoredPart {
    std::string kind;         ///< the format's word for such parts: "keyword", "section", "array", "element type"
    std::string name;         ///< as in the file
    std::size_t count = 1;    ///< how many the file has under this name
    std::string reason = {};  ///< why, or where the reader found out; empty: parts of this kind are never taken
};

struct ReadResult {
    HexMesh mesh;  ///< validated; the values at points of a cell array are volume-weighted means over incident cells
    std::vector<FieldInfo> fields;
    std::vector<std::string> warnings;   ///< one sentence for each thing left out, turned round or converted
    std::vector<MeshBlock> blocks = {};  ///< the parts that were read, of formats that have such parts
    /// Only if values at cells were fitted: the values of these fields in the file, for each cell of the mesh
    std::vector<Attribute> cell_means = {};
    /// For each cell of the mesh the number of the file's cell that it is a part of; empty if `cell_means` is empty and there
    /// are none on patches
    std::vector<Index> cell_parts = {};
    std::optional<CellValuesReport> cell_values = {};  ///< how well the means are met; nothing if `cell_means` is empty
    ValuesOnPatches on_patches = {};  ///< what the file has on faces of patches, of the fields at cells; empty for most formats
    /// What became of `on_patches`; nothing if there is none, or it was not used
    std::optional<PatchValuesReport> patch_values = {};
    std::size_t steps = 1;                    ///< how many time steps the file has
    std::size_t step = 0;                     ///< time step of the mesh; its time is `mesh.time`
    std::optional<CurvedReport> curved = {};  ///< nothing if there are no curved hexahedra, or only their corners are used
    /// Sharp edges that were found in the mesh and kept; nothing if the file has its own, or none were looked for
    std::optional<SharpEdges> sharp_edges = {};
    /// The quads and lines of VTK and Gmsh files beside hexahedra that were not split, but for those that are faces and edges
    /// of the hexahedra
    Shells shells = {};
    std::vector<UnreadField> unread = {};  ///< fields that could not be read; a warning names them
    /// Fields that some points or cells lack, NaN there; a warning names them. They are not attributes of the mesh, whose
    /// values are finite; `fields` has them, too
    std::vector<Attribute> incomplete = {};
    /// Patches of the boundary and sets of cells, of formats that have them: what lies inside the mesh is left out
    MeshSets sets = {};
    std::vector<IgnoredPart> ignored = {};  ///< parts of the file of which nothing was taken
};

}  // namespace subvol
