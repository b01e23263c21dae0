// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "subvol/limit_level.h"
#include "subvol/measure.h"
#include "subvol/mesh_sets.h"

namespace subvol::detail {

/// Cells by the sets that they are in: a class has the cells that are in the same sets. Each cell is in one class, so that
/// sets with common cells are measured as groups of cells are, each cell once.
struct CellClasses {
    std::vector<Index> groups;                ///< the class of each cell; the classes are 0, 1, … and none is empty
    std::vector<std::vector<Index>> of_sets;  ///< the classes that each set consists of, ascending
};

/// throws: Error(InvalidInput) if a set has a cell that does not exist
/// cost:   that of a look at each cell of each set
[[nodiscard]] CellClasses classes_of(std::span<const CellSet> sets, std::size_t cells);

/// The figures of each set: those of its classes together. found: the figures of all classes
[[nodiscard]] std::vector<PartMeasure> figures_of_sets(std::span<const CellSet> sets, const CellClasses& classes,
                                                       std::span<const PartMeasure> found);

/// What is measured with the figures of the sets of the options as parts. measured: with the classes as groups
[[nodiscard]] LimitMeasure measured_by_sets(const MeasureOptions& options, std::size_t cells,
                                            const std::function<LimitMeasure(const MeasureOptions& options)>& measured);

/// What is measured of the cells that the options choose, where they lie in the limit of the whole mesh.
///
/// measured: of these cells with those around them that shape their limit, flagged in the options that it gets; of the source
///           itself if the options choose no cells
[[nodiscard]] LimitMeasure measured_in_cells(
    const MeshSource& source, const MeasureOptions& options,
    const std::function<LimitMeasure(const MeshSource& source, const MeasureOptions& options)>& measured);

/// The pieces of some cells. cells: a flag for each cell
[[nodiscard]] std::shared_ptr<const LimitPieces> pieces_of(const LimitPieces& pieces, std::span<const std::uint8_t> cells);

}  // namespace subvol::detail
