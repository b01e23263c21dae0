// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"

namespace subvol::detail {

/// The arrays that number points and cells over all parts of a mesh, the first choice first.
inline constexpr std::string_view kNodeNumberMap = "node_num_map";  // of Exodus; not a field
inline constexpr std::array<std::string_view, 4> kPointNumberArrays{"GlobalNodeId", "GlobalNodeID", "GlobalPointIds",
                                                                    kNodeNumberMap};
inline constexpr std::array<std::string_view, 3> kCellNumberArrays{"GlobalCellId", "GlobalElementId", "GlobalCellIds"};

/// The most that points of different parts with the same number may be apart.
///
/// all, largest: the box of all points, and the diagonal of the largest cell's box
[[nodiscard]] double near_of_join(const Box& all, double largest);

/// The diagonal of the largest box of a cell; 0 if there are no cells.
[[nodiscard]] double largest_cell(const MeshFile& part);

/// The number of cells of all kinds that the part's file has.
[[nodiscard]] std::size_t cell_count(const MeshFile& part);

/// "3 pieces put together; 20 points joined with those of another, by their places; cells in the order of …"
///
/// by:       "their places", or the array in quotes
/// order_by: the array in quotes; empty: none
[[nodiscard]] std::string joining_report(std::size_t parts, std::string_view word, std::size_t joined, const std::string& by,
                                         const std::string& order_by);

/// Which of the arrays that some parts lack are kept, with gaps: those that number nothing, as long as their values are not
/// many more than the file has.
class GapLimit {
public:
    /// values: of all arrays of all parts
    explicit GapLimit(std::size_t values);
    /// values: those that the array has with its gaps
    [[nodiscard]] bool allows(std::string_view name, std::size_t values);

private:
    std::size_t room_;
};

/// What is said of an array that is not in every part, of others of its name with other components, and of one that should
/// number things and does not. things: "points"
[[nodiscard]] IgnoredPart not_everywhere(const std::string& name, std::string_view word);
[[nodiscard]] IgnoredPart other_components(const std::string& name, std::size_t arrays, std::string_view word);
[[nodiscard]] std::string does_not_number(std::string_view name, std::string_view things);

/// Puts the parts of a mesh together, one after the other, and joins their points: those with the same number in an array
/// `GlobalNodeId`, where all parts have it and it numbers places; else those of different parts at exactly the same place.
/// The first of them is kept, with its values. Cells are put in the order of an array `GlobalCellId` or `GlobalElementId` where
/// all parts with cells have it and no two cells (but ghosts) have the same number; that array is then left out. An array
/// that a part lacks, or has with gaps, has gaps there; it is left out if cells without it lie between those that have it. Adds
/// warnings with the counts.
///
/// word: "piece" or "block"
[[nodiscard]] MeshFile join_pieces(std::vector<MeshFile>&& pieces, std::string_view word, std::string_view file);

}  // namespace subvol::detail
