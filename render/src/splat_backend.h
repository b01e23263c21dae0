#pragma once

#include <string>

#include "splat_frame.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol::detail {

// The rules of reconstruction and classification that both backends follow; the shader takes them from here.

/// Least weight of a sum that counts, and the floor of its denominator: below it a sheet knows no value at that pixel.
inline constexpr float kLeastWeight = 0.02f;
/// Values nearer than this part of the table's range are taken as one: quotients of small differences would lose their digits.
inline constexpr float kLeastDifference = 1e-3f;
/// Transmittance at which a ray is done.
inline constexpr float kOpaque = 1e-4f;

[[nodiscard]] Image draw_splats_cpu(const SplatFrame& frame, const View& view, const PreintegratedTable& table,
                                    Progress* progress);

/// throws: Error(MissingCapability) if there is no OpenGL, or not enough of it
[[nodiscard]] Image draw_splats_gl(const SplatFrame& frame, const View& view, const PreintegratedTable& table,
                                   Progress* progress);

}  // namespace subvol::detail
