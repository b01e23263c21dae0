// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cell_request.h"
#include "subvol/dense_cells.h"

namespace subvol::detail {

/// Tables that do what `refine` does, and then `on_limit`.
[[nodiscard]] RefinementTables tables_of(const HexMesh& mesh, const RefineOptions& refine, bool on_limit);

/// The refined grids of a mesh's cells with the fields asked for: cell by cell as `for_each_dense_cell`, or from tables, which
/// give the same.
class RefinedCells {
public:
    /// throws: Error(InvalidInput) if the tables belong to another mesh or another level
    explicit RefinedCells(const CellRequest& request);

    /// levels: of the grids; from tables there is one only. visit: is called from several threads at once and in no order; the
    /// spans are gone after the call
    void for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const;

private:
    void refine_whole(const RefinementTables& tables);
    void gather(Index cell, DenseCell& dense, std::vector<Vec3>& points, std::vector<std::vector<double>>& values) const;

    int levels_;                       // from tables
    std::optional<DenseCells> dense_;  // without tables
    const RefinementTables* tables_;
    HexMesh mesh_;  // from tables: refined, with nothing but the fields, without its cells
    /// Of each node of a grid: a cell among the descendants of the control cell, and its corner.
    struct Node {
        std::size_t cell, corner;
    };
    std::vector<Node> nodes_;
};

}  // namespace subvol::detail
