// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/splat.h"

namespace subvol::test {

/// Preintegrated: the emission of a stretch is taken as mixed evenly with its extinction, as the splatter takes it.
/// Exact: what is in front covers what is behind.
enum class Emission { Preintegrated, Exact };

/// The splatter's rules, readable and slow: double precision, every kernel at every pixel of every sheet, straight from the
/// volume. A ray never ends for being opaque. Backend and progress are ignored; the report is empty.
///
/// cost: pixels × sheets × kernels × some 10 ns, on all cores
[[nodiscard]] SplatResult draw_oracle(const RbfVolume& volume, const View& view, const Optics& optics,
                                      const SplatOptions& options, Emission emission = Emission::Preintegrated);

}  // namespace subvol::test
