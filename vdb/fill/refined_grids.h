// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cell_request.h"
#include "subvol/dense_cells.h"

namespace subvol::detail {

/// Tables that refine a mesh and, if on_limit, move the vertices to the limit.
[[nodiscard]] RefinementTables tables_of(const HexMesh& mesh, const RefineOptions& refine, bool on_limit);

/// The refined nodes of a mesh's cells, with the request's fields: computed cell by cell as in `for_each_dense_cell`, or from
/// tables, which give the same bits.
class RefinedGrids {
public:
    /// bits:   without tables
    /// throws: Error(InvalidInput) if the tables belong to another mesh or another level
    explicit RefinedGrids(const CellRequest& request, DenseBits bits = DenseBits::OfRefine);

    /// levels: of refinement; ignored with tables, which have one level
    /// visit:  called from several threads at once, in no order; its spans are valid during the call only
    void for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const;

private:
    void refine_whole(const RefinementTables& tables);
    void gather(Index cell, DenseCell& dense, std::vector<Vec3>& points, std::vector<std::vector<double>>& values) const;

    int levels_;                       // of the tables
    std::optional<DenseCells> dense_;  // without tables
    const RefinementTables* tables_;
    HexMesh mesh_;  // refined by tables: points and the request's fields, no cells
    /// For each node of a refined cell: a descendant of the control cell that has it, and the corner.
    struct Node {
        std::size_t cell, corner;
    };
    std::vector<Node> nodes_;
};

}  // namespace subvol::detail
