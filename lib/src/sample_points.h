#pragma once

#include "point_lines.h"
#include "subvol/sample.h"

namespace subvol::detail {

/// One kernel at every point of a mesh whose points lie on the limit.
///
/// Steps and gradients come from fourth-order differences along the lines through a point, one-sided where a line ends;
/// across_points: whether the limit is smooth across the points of a line; if not, every cell has derivatives of its own
[[nodiscard]] SampleResult sample_at_points(HexMesh on_limit, const PointLines& lines, bool across_points,
                                            const SampleOptions& options);

}  // namespace subvol::detail
