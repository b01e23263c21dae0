// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "subvol/detail/neighborhood.h"
#include "subvol/detail/sparse_rows.h"
#include "subvol/scheme.h"

namespace subvol::detail {

/// The vertices of a cell's refinement as sums over the points of its neighbourhood: row i is the vertex at (u, v, w) of the
/// grid of side³, side = 2^level + 1, i = u + side·(v + side·w).
struct WeightTable : SparseRows<double, std::uint16_t, std::uint32_t> {
    std::size_t points = 0;           ///< points of the neighbourhood
    std::vector<std::uint16_t> used;  ///< points that have weights, ascending; columns of a row ascend, too

    [[nodiscard]] std::size_t rows() const { return row_count(*this); }
    [[nodiscard]] std::size_t bytes() const {
        return offsets.size() * sizeof(offsets[0]) + columns.size() * (sizeof(columns[0]) + sizeof(weights[0]));
    }
};

/// A fingerprint of a neighbourhood's code, of 128 bits: that two different codes have the same one is not to be expected in
/// the lifetime of the universe.
struct ClassKey {
    std::uint64_t high = 0, low = 0;
    auto operator<=>(const ClassKey&) const = default;
};

[[nodiscard]] ClassKey key_of(const Neighborhood& neighborhood);

/// The neighbourhood of a cell in a grid, of one or two layers. Its points are those of NeighborhoodWalk::find_regular.
[[nodiscard]] Neighborhood regular_neighborhood(int layers = 2);

/// Tables by neighbourhood class, made when they are first asked for.
///
/// Weights depend on how cells meet, and on tags, alone: not on positions or values. So cells whose neighbourhoods have the
/// same code share a table, as patches of one kind do in OpenSubdiv.
class ClassTables {
public:
    /// on_limit:   what is done to the vertices of the last level; null: nothing
    /// most_bytes: beyond, tables that were not used for long are dropped, and made again when they are needed
    explicit ClassTables(const SchemeOptions& scheme, std::function<HexMesh(HexMesh)> on_limit,
                         std::size_t most_bytes = std::size_t{512} << 20);
    ~ClassTables();
    ClassTables(const ClassTables&) = delete;
    ClassTables& operator=(const ClassTables&) = delete;

    /// The table of the class that has this key. Thread-safe.
    ///
    /// find: gives the neighbourhood of any cell of that class, if there is no table yet
    [[nodiscard]] std::shared_ptr<const WeightTable> table(const ClassKey& key, int level,
                                                           const std::function<const Neighborhood&()>& find);

    /// How many tables have been made, and how many bytes those take that are kept.
    [[nodiscard]] std::size_t made() const;
    [[nodiscard]] std::size_t bytes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// How many cells are worked on side by side.
inline constexpr std::size_t kTableLanes = 16;

/// Applies a table to one channel of kTableLanes cells: values of point p at in[kTableLanes·p …], of row i at out[kTableLanes·i
/// …].
void apply_table(const WeightTable& table, const double* in, double* out);

}  // namespace subvol::detail
