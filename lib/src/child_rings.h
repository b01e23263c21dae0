#pragma once

#include "child_numbers.h"

namespace subvol::detail {

/// Fills edge_faces and edge_cells of a child that has all else: about half an edge as about the whole, four elsewhere inside.
void fill_child_rings(const ChildNumbers& numbers, Topology& child);

}  // namespace subvol::detail
