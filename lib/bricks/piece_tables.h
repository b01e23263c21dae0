// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brick_shapes.h"
#include "collection.h"
#include "spill_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// A flag for each point, and how many are set before one.
class PointFlags {
public:
    void resize(std::size_t points);
    void set(Index p) { words_[p / 64] |= std::uint64_t{1} << p % 64; }
    [[nodiscard]] bool operator[](Index p) const { return (words_[p / 64] >> p % 64 & 1) != 0; }

    /// After the last one was set, for `count_before`. Returns how many there are.
    std::uint64_t count();
    [[nodiscard]] std::uint64_t count_before(Index p) const;

private:
    std::vector<std::uint64_t> words_;
    std::vector<std::uint64_t> before_;  // of each word
};

/// The different corners of some cells, ascending, and the place of each among them.
class CornersOfCells {
public:
    explicit CornersOfCells(std::span<const std::array<Index, 8>> cells);
    [[nodiscard]] const std::vector<Index>& points() const { return points_; }
    [[nodiscard]] Index place(Index p) const;

private:
    Index first_ = 0;
    std::vector<std::uint64_t> words_;
    std::vector<Index> before_;
    std::vector<Index> points_;
};

/// A mesh in pieces as tables in files, joined as `join_pieces` does: points and cells have the same order, and the same
/// values.
///
/// points, cells: their counts; used: the points of cells
/// arrays:        of the file, without their values; those of points make a record of point_values, in their order, those of
///                cells one of cell_values
/// corners:       of the cells, as the file has them: left-handed ones are not turned yet
/// hash:          of all that is in the tables
/// by, order_by:  as in `joining_report`
struct PieceTables {
    explicit PieceTables(const std::filesystem::path& folder);

    std::uint64_t points = 0, cells = 0;
    PointFlags used;
    std::vector<FileArray> arrays;
    SpillFile coordinates, corners;
    std::unique_ptr<SpillFile> point_values, cell_values;  // null: there are none
    std::uint64_t hash = 0;
    std::vector<std::string> warnings;

    /// Numbers in a record of point_values, of cell_values.
    [[nodiscard]] std::size_t components(bool at_cells) const;
};

/// Reads the pieces one at a time, two or three times each.
///
/// folder:  for the tables
/// returns: nothing if the mesh cannot be joined piece by piece; `why` is then a reason such as "it has tetrahedra"
/// throws:  Error(InvalidInput) as `read_mesh` of the whole; or if a piece changes meanwhile
/// cost:    memory: a piece; for points and cells with numbers that of RanksOfNumbers, for points without that of RanksOfPlaces
[[nodiscard]] std::unique_ptr<PieceTables> tables_of_pieces(const PartFiles& files, const std::string& list,
                                                            const std::filesystem::path& folder, const ReadOptions& options,
                                                            Progress* progress, std::string& why);

/// The centres of the cells of such tables, in files. Adds the warnings of left-handed and folded cells.
[[nodiscard]] std::unique_ptr<CellCenters> centers_of(PieceTables& tables, const std::filesystem::path& folder,
                                                      Progress* progress);

}  // namespace subvol::detail
