// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <string>

#include "subvol/detail/child_topology.h"
#include "subvol/detail/schemes.h"
#include "subvol/detail/stencil_block.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// The rows of one refinement step, in blocks.
class SchemeRows {
public:
    /// OfPoints: all terms are points. WithSums: rows about long rings have sums (`RingSums`) as columns behind the points, as
    /// in `RowInput`
    enum class Columns : std::uint8_t { OfPoints, WithSums };

    /// Keeps a reference to the topology.
    SchemeRows(const Topology& topology, const SchemeOptions& scheme, Columns columns = Columns::OfPoints);

    /// The sums that rows have as columns; null if there are none.
    [[nodiscard]] const RingSums* sums() const { return sums_; }

    [[nodiscard]] std::size_t columns() const { return topology_.point_count; }
    [[nodiscard]] std::size_t rows() const { return first_.end; }

    /// How many leading points stay as they are.
    [[nodiscard]] std::size_t kept() const { return kept_; }
    [[nodiscard]] std::size_t block_count() const { return (rows() - kept_ + kBlockRows - 1) / kBlockRows; }

    /// The terms of child point `point`.
    void write_row(std::size_t point, StencilBuilder& row) const;

    /// Calls visit(number, block) for every block, in parallel. The block is valid during the call only.
    template <class Visit>
    void for_each_block(Progress* progress, const std::string& stage, const Visit& visit) const;

private:
    const Topology& topology_;
    ChildNumbering first_;
    std::unique_ptr<SchemeRules> rules_;
    const RingSums* sums_;  // null: there are none
    std::size_t kept_;
    std::vector<Index> cell_of_rank_;
};

/// What rows are applied to: the values of a mesh as they are, or copies with the sums behind them.
class RowInput {
public:
    /// The mesh is kept by reference.
    RowInput(const SchemeRows& rows, const HexMesh& mesh);

    /// Returns three coordinates for each column.
    [[nodiscard]] const double* points() const { return columns_.empty() ? &mesh_.points[0].x : columns_[0].data(); }
    [[nodiscard]] const double* values(std::size_t attribute) const {
        return columns_.empty() ? mesh_.attributes[attribute].values.data() : columns_[1 + attribute].data();
    }

private:
    const HexMesh& mesh_;
    std::vector<std::vector<double>> columns_;  // of the points, then of each attribute; empty without sums
};

template <class Visit>
void SchemeRows::for_each_block(Progress* progress, const std::string& stage, const Visit& visit) const {
    struct Scratch {
        StencilBuilder row;
        StencilBlockWriter block;
    };
    tbb::enumerable_thread_specific<Scratch> scratch;
    constexpr std::size_t kTurn = 256;  // blocks between two reports of progress
    for (std::size_t turn = 0; turn < block_count(); turn += kTurn) {
        report_progress(progress, stage, turn, block_count());
        tbb::parallel_for(turn, std::min(block_count(), turn + kTurn), [&](std::size_t b) {
            auto& [row, block] = scratch.local();
            const std::size_t begin = kept_ + b * kBlockRows, end = std::min(rows(), begin + kBlockRows);
            block.start(begin);
            for (std::size_t point = begin; point < end; ++point) {
                row.clear();
                write_row(point, row);
                block.push(row.finish());
            }
            visit(b, block.block());
        });
    }
    report_progress(progress, stage, 1);
}

}  // namespace subvol::detail
