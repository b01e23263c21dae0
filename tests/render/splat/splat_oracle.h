// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/splat.h"

namespace subvol::test {

/// Preintegrated: the emission of a stretch is mixed evenly with its extinction, as in the splatter.
/// Exact:         the front of a stretch covers its back.
enum class Emission { Preintegrated, Exact };

/// A readable and slow implementation of the splatter's rules: in double precision, every kernel at every pixel of every sheet.
/// Rays do not end when they are opaque. Backend and progress are ignored; the report is empty.
///
/// cost: pixels × sheets × kernels × some 10 ns, on all cores
[[nodiscard]] SplatResult draw_oracle(const RbfVolume& volume, const View& view, const Optics& optics,
                                      const SplatOptions& options, Emission emission = Emission::Preintegrated);

}  // namespace subvol::test
