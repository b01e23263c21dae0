// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"
#include "subvol/vec.h"

namespace subvol {

/// A grid of floats, or of vectors of three, in the `.vdb` files of a stage.
struct UsdGrid {
    std::string name;
    bool vectors = false;

    bool operator==(const UsdGrid&) const = default;
};

/// A `.vdb` file that a stage names, and the box of its volume at the time code.
struct UsdStep {
    double code = 0;
    std::filesystem::path file;
    Box extent;
};

/// A volume whose grids are in `.vdb` files.
struct UsdVolume {
    std::vector<UsdGrid> grids;     ///< grids of each file
    std::vector<UsdStep> steps;     ///< one, or one for each time code; the codes ascend
    TransferFunction colors;        ///< the colour map, over the values of the first grid
    double opacity_unit_world = 1;  ///< distance that the opacities of the colour map are for
    UpAxis up = UpAxis::Z;          ///< what the stage says of the data, which stay as they are: y or z
};

/// Writes OpenUSD text (`.usda`): a Volume of UsdVol with an OpenVDBAsset for each grid, by the path of its file relative to
/// the stage. OpenUSD has no shader of its own for volumes, so the colour map is written as attributes of the volume:
/// subvol:colorValues, subvol:colors (linear), subvol:opacityValues, subvol:opacities, subvol:opacityUnit.
///
/// throws: Error(InvalidInput) for another extension, or if there are no grids, no steps, or codes that do not ascend, or for x
///         as the axis that is up, which OpenUSD has not; Error(Io)
void write_usd(const std::filesystem::path& path, const UsdVolume& volume);

/// Writes kernels as OpenUSD text: a ParticleField3DGaussianSplat (OpenUSD 26.03) with the Gaussians of `write_points` with
/// splats, in the colours of the first channel. Each channel is also written as it is: subvol:value:NAME, a number for each
/// splat.
///
/// steps: one, or one for each code; they have the same channels
/// throws: Error(InvalidInput) as for a volume, and as `validate`; Error(Io)
void write_usd(const std::filesystem::path& path, std::span<const RbfVolume> steps, std::span<const double> codes,
               const TransferFunction& colors, UpAxis up = UpAxis::Z);

}  // namespace subvol
