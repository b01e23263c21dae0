// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "subvol/facts.h"
#include "subvol/sample.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// How a mesh becomes kernels, for pictures, files and pages alike.
struct KernelOptions {
    SampleOptions sample{};       ///< where kernels are placed and what they carry
    std::optional<int> levels{};  ///< the refined mesh of this level, with its trilinear cells, takes the place of the limit
    /// If > 0, as few kernels as this root mean square error needs, in the unit of the field, instead of samples
    double reduce_rmse = 0;
    bool move = false;  ///< with reduce_rmse: kernels are also moved and resized
    /// The mesh is a level of a scheme of tetrahedra on its limit, cut into hexahedra (`in_hexahedra`): it gets one kernel at
    /// each of its points
    bool tets = false;
    std::optional<TransferFunction> visible{};  ///< kernels that this function makes invisible are dropped; none: all are kept
    std::string levels_option = "levels";       ///< what the errors call `levels`
    Progress* progress = nullptr;

    /// Whether there is one kernel for each control point with all that it carries by default, so that the kernels of a
    /// solid's boundary are where its points are.
    [[nodiscard]] bool are_plain() const;
};

/// The kernels of a mesh; facts: their number, and what was found on the way.
///
/// throws: Error(InvalidInput) as `sample_rbf_points` and `reduce_rbf`, for options that place the kernels of tetrahedra
///         elsewhere than at points, and if no kernel is visible; Error(MissingCapability) if there is not enough memory for
///         the levels
[[nodiscard]] WithFacts<RbfVolume> make_mesh_kernels(HexMesh mesh, const KernelOptions& options);

/// The volume without the kernels that a function makes invisible; facts: their number.
///
/// throws: Error(InvalidInput) if none is left
[[nodiscard]] WithFacts<RbfVolume> visible_kernels(const RbfVolume& volume, const TransferFunction& function,
                                                   Progress* progress = nullptr);

/// The mesh refined and moved to the limit; facts: its level and its cells.
///
/// option: what errors call the level
/// throws: Error(InvalidInput) as `refine`; Error(MissingCapability) if there is not enough memory
[[nodiscard]] WithFacts<HexMesh> refined_on_limit(const HexMesh& mesh, const RefineOptions& options, const std::string& option);

}  // namespace subvol
