// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "subvol/refine.h"

namespace subvol {

/// One control cell after refinement, as a grid: side³ vertices of the refined mesh, side = 2^levels + 1, u fastest, then v,
/// then w.
struct DenseCell {
    Index cell = 0;  ///< of the control mesh
    std::size_t side = 0;
    std::span<const Vec3> points;
    std::vector<std::span<const double>> values;  ///< for each attribute side³ × channels numbers, vertex-major
};

/// Refines a mesh cell by cell: calls visit for every control cell with its grid, and keeps only a batch of cells per thread in
/// memory. Neighbouring grids have the same bits where they meet, and the same as `refine`.
///
/// visit:  called from several threads at once and in any order; the spans are valid during the call only
/// throws: Error(InvalidInput) as `refine`
/// cost:   parallel; memory: the mesh, and per thread about 50 MB, or one cell if that is more: 300 bytes per vertex
void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const std::function<void(const DenseCell&)>& visit);

struct DenseSelection {
    std::optional<std::vector<Index>> cells{};  ///< cells of the control mesh, without repetition; none: all
    bool on_limit = false;  ///< points and attributes are moved to the limit, as by `on_limit` of the refined mesh
};

/// The same for some of the cells, or for the limit of their vertices.
///
/// throws: Error(InvalidInput) if a cell does not exist
void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const DenseSelection& selection,
                         const std::function<void(const DenseCell&)>& visit);

/// OfRefine:   the bits of `refine`, and so of neighbours where they meet
/// ToRounding: the same up to some roundings of 1e-16 of the coordinates, several times faster: cells whose neighbourhoods meet
///             in the same way share a table of weights
enum class DenseBits { OfRefine, ToRounding };

/// The same for several selections of cells of one mesh: what depends on the whole mesh is set up once.
class DenseCells {
public:
    /// throws: as `for_each_dense_cell`
    DenseCells(const HexMesh& mesh, const RefineOptions& options, bool on_limit, DenseBits bits = DenseBits::OfRefine);
    ~DenseCells();
    DenseCells(DenseCells&&) noexcept;
    DenseCells& operator=(DenseCells&&) noexcept;

    /// cells: without repetition. throws: Error(InvalidInput) if a cell does not exist; Error(Cancelled)
    void for_each(std::span<const Index> cells, const std::function<void(const DenseCell&)>& visit) const;

    /// To a level that differs from that of the options.
    void for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
