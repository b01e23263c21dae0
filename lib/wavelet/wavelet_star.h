// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "scheme_rows.h"

namespace subvol::detail {

/// The numbers, among the new points, of those on the edges and faces and in the cells of a point, ascending.
void star_of(const Topology& topology, Index point, std::vector<Index>& star);

/// The weights u with which the rows of the new points of a star, taken from the row of its point, leave no other term.
///
/// even:    one weight for each point of the star
/// returns: the weight D of the point itself that is left; 0 if there are no such weights
[[nodiscard]] double solve_even_rule(const SchemeRows& rows, Index point, std::span<const Index> star, std::span<double> even);

}  // namespace subvol::detail
