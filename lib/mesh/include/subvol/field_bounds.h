// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// Gives the fields of a mesh as bounds the least and the largest value of each channel, so that their limit does not leave the
/// range of what was given. Finite bounds that a field has already stay.
///
/// at_cells: the fields that were given at cells, under their names: then the range is that of the cells
void bound_as_given(HexMesh& mesh, std::span<const Attribute> at_cells = {});

/// Gives fractions the bounds 0 and 1: scalars whose values lie within these, and whose name says what they are: `alpha.water`,
/// or with "fraction", "saturation", "porosity" or the word "vof" in it.
///
/// at_cells: as for `bound_as_given`
/// returns:  the names of the fields that are bounded now and were not before
std::vector<std::string> bound_fractions(HexMesh& mesh, std::span<const Attribute> at_cells = {});
/// The sentence about these fields, of which there is at least one.
[[nodiscard]] std::string bounded_fractions_text(std::span<const std::string> names);

}  // namespace subvol
