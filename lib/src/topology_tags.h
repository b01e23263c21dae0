#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// Creases of a whole mesh must be edges of its boundary. Of a part, some may lie where the part has lost what made them
/// boundary: at its outer cells, whose rules do not matter.
enum class Tags { OfAWhole, OfAPart };

[[nodiscard]] Topology build_topology(const HexMesh& mesh, Tags tags);

}  // namespace subvol::detail
