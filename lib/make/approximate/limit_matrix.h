// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "class_rows.h"
#include "table_rows.h"

namespace subvol::detail {

/// The values of the limit at n places as a matrix A over the control values, and its transpose. Rows in cells whose
/// neighbourhoods are common come from tables of classes, the others from stencils.
class LimitMatrix {
public:
    /// options:  of at least one level
    /// settling: which places are moved, by the positions of the mesh's points
    /// where:    who is named if the memory is not enough
    LimitMatrix(const HexMesh& mesh, const RefineOptions& options, std::span<const LimitQuery> places,
                const Settling& settling = {}, const std::string& where = {});

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t columns() const { return columns_; }

    /// A x
    [[nodiscard]] std::vector<double> apply(std::span<const double> control) const;
    /// Aᵀ y: the same bits for any number of threads
    [[nodiscard]] std::vector<double> transposed(std::span<const double> values) const;

private:
    std::size_t rows_, columns_;
    ClassRows common_;
    TableRows others_;
};

}  // namespace subvol::detail
