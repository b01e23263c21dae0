// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "level_of_detail.h"
#include "picture_output.h"
#include "ranked_splats.h"
#include "report.h"
#include "subvol/boundary_values.h"
#include "subvol/render_bricks.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol::cli {

/// How kernels are drawn.
///
/// method: for the report
struct SplatWork {
    std::string method;
    SplatOptions options;
    OwnRows rows{};
};

/// Draws and writes a picture of kernels for each view.
///
/// skin: the boundary of a solid, which gets its colours from it; without values: the colours are those of the kernels
void write_splats(LevelOfDetail& levels, const BoundaryValues& skin, const std::vector<View>& views, const Optics& optics,
                  const SplatWork& work, PictureOutput& output, Report& report);

/// The same of a volume.
///
/// lod: of --lod; 0: all kernels
void write_splats(const RbfVolume& volume, double lod, const BoundaryValues& skin, const std::vector<View>& views,
                  const Optics& optics, const SplatWork& work, PictureOutput& output, Report& report);

/// A mesh in bricks whose kernels are drawn.
///
/// options: rows are those of the work
/// samples: along each side of a pixel, for the colours of the skin
struct BricksToSplats {
    const Bricks& bricks;
    const BrickFields& fields;
    BrickSplatOptions options;
    Surface boundary;
    const BoundaryValues& skin;
    int samples = 1;
};

/// Draws and writes a picture for each view. Each brick is sampled once for each; its kernels wait in files until their part of
/// the picture is drawn.
void write_splats(BricksToSplats what, const std::vector<View>& views, const Optics& optics, const SplatWork& work,
                  PictureOutput& output, Report& report);

/// Draws and writes the best picture that can be made within some seconds.
void write_splats_in_time(const HexMesh& mesh, const SampleOptions& sample, double seconds, const View& view,
                          const Optics& optics, const SplatWork& work, PictureOutput& output, Report& report);

}  // namespace subvol::cli
