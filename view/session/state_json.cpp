// SPDX-License-Identifier: Apache-2.0
#include "session_state.h"

namespace subvol::detail {

namespace {

Json numbers(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Json numbers(const CutPlane& plane) {
    return {plane.point.x, plane.point.y, plane.point.z, plane.normal.x, plane.normal.y, plane.normal.z};
}

Json numbers(const Box& box) {
    return {box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z};
}

}  // namespace

Json json_of(const ViewState& state) {
    const Camera& camera = state.camera;
    Json json;
    json["field"] = state.field;
    json["step"] = state.step;
    json["size"] = {state.width, state.height};
    json["camera"] = {{"eye", numbers(camera.eye)},
                      {"target", numbers(camera.target)},
                      {"up", numbers(camera.up)},
                      {"fovy_deg", camera.fovy_deg},
                      {"ortho_height", camera.ortho_height}};
    json["method"] = name_of(state.method);
    json["look"] = name_of(state.look.look);
    json["tf"] = state.look.colors;
    if (state.look.range) {
        json["range"] = {state.look.range->min, state.look.range->max};
    } else {
        json["range"] = state.look.stretch ? Json("field") : Json(nullptr);
    }
    json["opacity"] = Json::array();
    for (const auto& knot : state.look.opacity) json["opacity"].push_back({knot.value, knot.alpha});
    const ColorShape& shape = state.look.shape;
    json["log"] = shape.scale.logarithmic;
    json["symlog"] = shape.scale.linear_within > 0 ? Json(shape.scale.linear_within) : Json(nullptr);
    json["bands"] = shape.bands > 0 ? Json(shape.bands) : Json(nullptr);
    json["below"] = shape.below ? numbers(*shape.below) : Json(nullptr);
    json["above"] = shape.above ? numbers(*shape.above) : Json(nullptr);
    json["opacity_unit"] = state.look.opacity_unit_world ? Json(*state.look.opacity_unit_world) : Json(nullptr);
    json["clamp"] = state.look.clamp;
    json["background"] = state.background ? numbers(*state.background) : Json(nullptr);
    json["axes"] = state.axes;
    json["edges"] = state.edges;
    json["legend"] = state.legend;
    json["inverted"] = state.inverted;
    json["flow"] = Json::object();
    for (const auto& [name, value] : state.flow.words()) {
        if (name == "seeds")
            json["flow"][name].push_back(value);
        else
            json["flow"][name] = value;
    }
    json["clip"] = Json::array();
    for (const CutPlane& plane : state.clip.planes) json["clip"].push_back(numbers(plane));
    json["clip_box"] = state.clip.box ? numbers(*state.clip.box) : Json(nullptr);
    json["slice"] = Json::array();
    for (const CutPlane& plane : state.clip.slices) json["slice"].push_back(numbers(plane));
    json["around"] = state.clip.around_slices;
    json["compare"] = state.compare ? Json(name_of(*state.compare)) : Json(nullptr);
    json["slider"] = state.slider;
    json["difference"] = state.difference;
    return json;
}

Json saved_state(ViewSession::State& session) {
    Json json = json_of(session.state);
    if (!session.body->points.volume && !session.body->tets) json[kInvertedCells] = session.inverted_cells().size();
    return json;
}

}  // namespace subvol::detail
