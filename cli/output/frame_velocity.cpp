// SPDX-License-Identifier: Apache-2.0
#include "frame_velocity.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "subvol/spread_vectors.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

// Velocities are written beyond the volume as far as it moves in this time: renderers open the shutter for a frame at most,
// usually centred on the frame's time.
constexpr double kShutter_frames = 0.5;
// In voxels. With more, the grid of a volume 200 voxels wide would have more voxels outside the volume than inside.
constexpr int kMostVelocityLayers = 64;

}  // namespace

void add_velocity(Attribute velocity, HexMesh& mesh, double factor) {
    if (mesh.find_attribute(velocity.name)) {
        throw Error(ErrorCode::InvalidInput, "the mesh has a field of this name", kVelocity, "--fields without it");
    }
    for (double& v : velocity.values) v *= factor;
    mesh.attributes.push_back(std::move(velocity));
}

Facts spread_velocity(int frame, double frames_per_second, std::vector<VdbGrid>& grids, Progress* progress) {
    Facts facts;
    const auto velocity = std::ranges::find(grids, kVelocity, [](const VdbGrid& grid) { return grid.report().name; });
    if (velocity == grids.end() || velocity->report().kind != "vector" || velocity->report().max == 0) return facts;
    const GridReport& about = velocity->report();
    const double way_voxels = kShutter_frames * about.max / frames_per_second / about.voxel_size_world;
    if (way_voxels > kMostVelocityLayers) {
        facts.warn(text("frame ", frame, ": in half a frame something moves by ", way_voxels, " voxels; the velocities reach ",
                        kMostVelocityLayers, " voxels beyond the volume, and blur is cut off there"));
    }
    const int layers = static_cast<int>(std::min(std::ceil(way_voxels) + 1, double(kMostVelocityLayers)));
    facts.timed(progress, "spread", [&] { *velocity = vdb().spread_vectors(*velocity, layers); });
    return facts;
}

}  // namespace subvol::cli
