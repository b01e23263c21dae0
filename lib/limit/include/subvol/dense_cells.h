// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "subvol/refine.h"

namespace subvol {

/// The grid that one control cell becomes: side³ vertices of the refined mesh, side = 2^levels + 1, u fastest, then v, then w.
///
/// values: an attribute: side³ × channels numbers, vertex-major
struct DenseCell {
    Index cell = 0;  // of the control mesh
    std::size_t side = 0;
    std::span<const Vec3> points;
    std::vector<std::span<const double>> values;
};

/// Refines a mesh cell by cell: calls visit for every control cell with its grid, and keeps no more than a batch of cells in
/// memory. Neighbouring grids agree bitwise in what they share, and with `refine`.
///
/// visit:  is called from several threads at once and in no order; the spans are gone after the call
/// throws: Error(InvalidInput) as `refine`
/// cost:   parallel; memory: the mesh, and a thread some 50 MB, or what one cell takes: 300 bytes a vertex
void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const std::function<void(const DenseCell&)>& visit);

/// cells:    of the control mesh, without repetition; none: all
/// on_limit: points and attributes are moved to the limit, as `on_limit` moves those of `refine`
struct DenseSelection {
    std::optional<std::vector<Index>> cells{};
    bool on_limit = false;
};

/// The same for some of the cells, or for the limit of their vertices.
///
/// throws: Error(InvalidInput) if a cell does not exist
void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const DenseSelection& selection,
                         const std::function<void(const DenseCell&)>& visit);

/// The same for one lot of cells of a mesh after the other: what is needed of the whole mesh is set up once.
class DenseCells {
public:
    /// throws: as `for_each_dense_cell`
    DenseCells(const HexMesh& mesh, const RefineOptions& options, bool on_limit);
    ~DenseCells();
    DenseCells(DenseCells&&) noexcept;
    DenseCells& operator=(DenseCells&&) noexcept;

    /// cells: without repetition. throws: Error(InvalidInput) if a cell does not exist; Error(Cancelled)
    void for_each(std::span<const Index> cells, const std::function<void(const DenseCell&)>& visit) const;

    /// To another level than that of the options.
    void for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
