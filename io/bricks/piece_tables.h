// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "assemble.h"
#include "piece_numbers.h"
#include "subvol/detail/spill_file.h"
#include "subvol/mesh_io.h"
#include "subvol/progress.h"
#include "vtk/collection.h"

namespace subvol::detail {

/// A mesh in pieces as tables in files, joined as `join_pieces` does: points and cells have the same order, and the same
/// values.
struct PieceTables {
    explicit PieceTables(const std::filesystem::path& folder);

    std::uint64_t points = 0, cells = 0;  ///< number of points and of cells
    CellCounts counts;                    ///< number of cells of each kind
    bool cut = false;                     ///< as in MeshFile
    bool turned = false;                  ///< left-handed cells were turned, and what is negative stays so
    PointFlags used;                      ///< the points of cells
    /// Arrays of the file, without their values; those of points make a record of point_values, in their order, those of cells
    /// one of cell_values
    std::vector<FileArray> arrays;
    SpillFile coordinates;
    SpillFile corners;  ///< corners of the cells, as the file has them; those of other cells than hexahedra end in kNone
    std::unique_ptr<SpillFile> point_values, cell_values;  ///< null: there are none
    std::uint64_t hash = 0;                                ///< hash of all that is in the tables
    std::vector<std::string> warnings;

    /// Numbers in a record of point_values, of cell_values.
    [[nodiscard]] std::size_t components(bool at_cells) const;
};

/// Reads the pieces one at a time, two or three times each. Tetrahedra, prisms and pyramids are split into hexahedra as in the
/// whole mesh.
///
/// folder:  for the tables
/// returns: nothing if the mesh cannot be joined piece by piece; `why` is then a reason such as "it has curved cells"
/// throws:  Error(InvalidInput) as `read_mesh` of the whole; or if a piece changes meanwhile
/// cost:    memory: a piece; for points and cells with numbers that of RanksOfNumbers, for points without that of RanksOfPlaces
[[nodiscard]] std::unique_ptr<PieceTables> tables_of_pieces(const PartFiles& files, const std::string& list,
                                                            const std::filesystem::path& folder, const ReadOptions& options,
                                                            Progress* progress, std::string& why);

/// Turns left-handed hexahedra of tables that have no other cells: the same cells as `orient_cells` of the whole mesh, if its
/// cells can be of one hand at all (not where they meet as in a Möbius strip).
///
/// folder:  for the faces of cells
/// returns: how many were turned
/// cost:    where a cell has a negative volume, O(n log n), some 144 bytes a cell on disk and five in memory; else one pass
std::size_t orient_tables(PieceTables& tables, const std::filesystem::path& folder, Progress* progress);

/// Splits all cells of such tables into hexahedra, as `split_into_hexes` does: the same points and cells in the same order.
///
/// The keys of new points (the sorted corners of their edge, face or cell) are sorted in buckets on disk, which numbers them;
/// the numbers then come back to the cells.
///
/// mixed:  is given up
/// list:   the name of the list of pieces, for messages
/// throws: Error(InvalidInput) if two cells have the same corners, or if there are too many; Error(Io) if the disk is full
/// cost:   O(n log n); some 500 bytes a tetrahedron on disk until it is done, 1300 a hexahedron; memory for a bucket of keys
///         and for a chunk of cells, and 2 bits a point
[[nodiscard]] std::unique_ptr<PieceTables> split_tables(std::unique_ptr<PieceTables> mixed, const std::string& list,
                                                        const std::filesystem::path& folder, Progress* progress);

}  // namespace subvol::detail
