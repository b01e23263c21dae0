// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/control_mesh.h"
#include "subvol/label_grid.h"

namespace subvol {

struct LabelOptions {
    /// The labels that become materials, as "3" or "3=bone"; all others are outside. None: all labels. Without a name a label
    /// is called label_3
    std::vector<std::string> labels{};
    int smooth = 40;                            ///< rounds of smoothing; 0: the steps of the voxels
    OptionNames names = OptionNames::Keywords;  ///< of options in errors
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(LabelOptions& options);

struct LabelReport {
    std::string name;
    std::int32_t label = 0;
    std::size_t voxels = 0;
    double voxels_world = 0;    ///< their volume
    double enclosed_world = 0;  ///< what the surface of the label encloses
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const std::vector<LabelReport>& labels);

struct LabelSurfaces {
    std::vector<MaterialSurface> materials;  ///< closed, with the same points and triangles where two labels touch
    std::vector<LabelReport> report;         ///< of each
};

/// The closed surfaces of the labels of a grid, for `control_mesh_of`. Neighbours share their walls.
///
/// There is one point between eight voxels that do not have one label, and a quad between each two neighbours with different
/// ones. Points are smoothed without leaving the place between their eight voxels; those where three labels meet, and those of
/// sharp edges along the axes of the voxels, along the line of these points alone. Other sharp edges are rounded by half a
/// voxel. Then walls move along their normals until each label has the volume of its voxels.
///
/// throws: Error(InvalidInput) if no voxel has a label, if a label of the options is not there or is twice, or if there would
///         be more than 1000 materials; Error(Cancelled)
/// cost:   8 visits a voxel of blocks with several labels, 200 bytes and some 20 ns a round for a point; points are 1.5 to 2
///         for each voxel face between labels. Parallel; the same bits for any number of threads
/// source: [frisken2022]; we differ: smoothing by [taubin1995], and volumes are kept
[[nodiscard]] LabelSurfaces label_surfaces(const LabelGrid& grid, const LabelOptions& options = {});

}  // namespace subvol
