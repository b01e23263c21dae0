// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/optics.h"

namespace subvol::cli {

/// A generated model with the way it is shown.
struct DemoCase {
    std::string name;
    HexMesh mesh;
    Camera camera;
    Optics optics;
    int sheets;
    int per_edge;
};

[[nodiscard]] std::vector<std::string> demo_names();

/// resolution: as make_model has it; 0 takes the model's own
/// throws:     Error(InvalidInput) for a name that is no model's
[[nodiscard]] DemoCase make_demo_case(const std::string& name, int resolution, double aspect);

}  // namespace subvol::cli
