// SPDX-License-Identifier: Apache-2.0
#include "demo_cases.h"

#include "input.h"
#include "picture_arguments.h"
#include "subvol/model.h"

namespace subvol::cli {
namespace {

/// The eye and the smooth transfer function of the twisted block as a benchmark; there the picture cuts the block off.
const Camera kTwistCamera{.eye = {2.6, -4.2, 2.0}, .target = {-0.3, 0, 0.1}, .up = {0, 0, 1}, .fovy_deg = 44};

Optics twist_optics() {
    return {{.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
             .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}},
            0.1};
}

Optics preset_optics(const std::string& preset, const HexMesh& mesh) {
    const auto [min, max] = field_range(mesh);
    return {transfer_function_preset(preset, min, max), bounds(mesh).diagonal() / 100};
}

}  // namespace

std::vector<std::string> demo_names() {
    return {"pawn", "ball", "twist"};
}

DemoCase make_demo_case(const std::string& name, int resolution, double aspect) {
    HexMesh mesh = make_model(name, resolution);
    if (name == "twist") return {name, std::move(mesh), kTwistCamera, twist_optics(), 200, 1};
    Optics optics = preset_optics(name == "pawn" ? "surface" : "coolwarm", mesh);
    const Camera camera = parse_camera("iso", visible_bounds(mesh, optics), aspect);
    const int sheets = name == "pawn" ? 400 : 200;  // an opaque surface shows every step in depth
    return {name, std::move(mesh), camera, std::move(optics), sheets, 1};
}

}  // namespace subvol::cli
