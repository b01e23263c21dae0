// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/mixed_mesh.h"
#include "subvol/sample.h"

namespace subvol {

struct MixedSampleOptions {
    Correction correction = Correction::Second;  ///< what the kernels have beside their values
    Kernel kernel{};                             ///< radial
    Progress* progress = nullptr;
};

/// One kernel at each point of a mesh whose points and values lie on the limit (`on_limit`).
///
/// A frame has the shape of the second moments of the neighbours about the point. The gradient and the second derivatives are
/// those of the quadratic that fits the values at the neighbours best; where there are fewer than 14, at theirs too. The
/// boundary is that of the mesh.
///
/// throws: Error(InvalidInput) as `validate`, or if the kernel is not radial
[[nodiscard]] SampleResult sample_rbf_points(const MixedMesh& mesh, const MixedSampleOptions& options = {});

}  // namespace subvol
