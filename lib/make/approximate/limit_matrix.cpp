// SPDX-License-Identifier: Apache-2.0
#include "limit_matrix.h"

#include <algorithm>

namespace subvol::detail {

LimitMatrix::LimitMatrix(const HexMesh& mesh, const RefineOptions& options, std::span<const LimitQuery> places,
                         const Settling& settling, const std::string& where)
    : rows_(places.size()), columns_(mesh.points.size()), common_(mesh, options, places, settling) {
    if (std::ranges::find(common_.rest(), 1) != common_.rest().end()) {
        others_ = TableRows(mesh, options, common_.rest(), places, settling, where);
    }
}

std::vector<double> LimitMatrix::apply(std::span<const double> control) const {
    std::vector<double> values(rows_);
    common_.apply(control, values);
    others_.apply(control, values);
    return values;
}

std::vector<double> LimitMatrix::transposed(std::span<const double> values) const {
    std::vector<double> sums(columns_, 0.0);
    common_.add_transposed(values, sums);
    others_.add_transposed(values, sums);
    return sums;
}

}  // namespace subvol::detail
