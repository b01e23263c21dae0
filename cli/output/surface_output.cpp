// SPDX-License-Identifier: Apache-2.0
#include "surface_output.h"

#include "part_note.h"
#include "quantities.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {

Json json_of(const SurfaceOutput& output) {
    Json json{{"field", output.field}, {"min", output.range.min}, {"max", output.range.max}, {"isos", output.isos}};
    const Vec3& origin = output.file.origin;
    if (origin != Vec3(0.0)) json["origin"] = {origin.x, origin.y, origin.z};
    if (!output.file.color) return json;
    json["color"] = *output.file.color;
    json["colors"] = Json::array();
    for (const auto& [value, rgb] : output.file.function.color) json["colors"].push_back({value, rgb.x, rgb.y, rgb.z});
    return json;
}

SurfaceOutput surface_output_from(const Json& json, const std::string& file) {
    SurfaceOutput output{.field = how_of(json, "field", std::string(), file),
                         .range = {how_of(json, "min", 0.0, file), how_of(json, "max", 0.0, file)},
                         .isos = how_of(json, "isos", std::size_t{0}, file)};
    const auto origin = how_of(json, "origin", std::array<double, 3>{}, file);
    output.file.origin = {origin[0], origin[1], origin[2]};
    if (!json.contains("color")) return output;
    output.file.color = how_of(json, "color", std::size_t{0}, file);
    for (const auto& [value, r, g, b] : how_of(json, "colors", std::vector<std::array<double, 4>>(), file)) {
        output.file.function.color.push_back({value, {r, g, b}});
    }
    output.file.function.opacity = {{0, 1}};  // of a surface nobody asks
    try {
        validate(output.file.function);
    } catch (const Error&) {
        fail_note(file);
    }
    return output;
}

void check_not_empty(const LimitSurface& surface, const SurfaceOutput& output) {
    if (!surface.surface.triangles.empty()) return;
    throw Error(ErrorCode::InvalidInput,
                text("the limit does not take ", output.isos == 1 ? "this value" : "these values", "; ", output.field,
                     " has control values from ", output.range.min, " to ", output.range.max),
                "--iso");
}

Facts write_reported(const std::string& path, const LimitSurface& surface, const SurfaceOutput& output, Progress* progress) {
    Facts facts;
    facts.timed(progress, "write", [&] { write_limit_surface(path, surface, output.file); });
    const SurfaceReport& found = surface.report;
    facts["output"] = path;
    facts["points"] = surface.surface.points.size();
    facts["triangles"] = surface.surface.triangles.size();
    facts["area"] = found.area;
    facts["volume"] = found.volume;
    facts["watertight"] = found.watertight;
    facts["euler"] = found.euler;
    facts["components"] = found.components;
    facts["min_angle"] = found.min_angle_deg;
    facts["angles_below_10"] = found.small_angles;
    facts["deviation"] = found.deviation_world;
    facts["level"] = found.level;
    facts["cells"] = found.cells;
    const std::size_t collapsed = path.ends_with(".stl") ? collapsed_by_floats(surface.surface, output.file.origin) : 0;
    if (collapsed > 0) {
        facts.warn(text(collapsed, " of ", counted(surface.surface.triangles.size(), "triangle"),
                        " lose a side, as .stl rounds coordinates to 32-bit floats: --origin X,Y,Z near the body writes them "
                        "relative to it, .ply keeps all digits"));
    }
    if (found.converged) return facts;
    facts.warn(text("the triangles may be ", found.deviation_world, " from the limit, more than the tolerance (level ",
                    found.level, "; --max-level, or a larger --tolerance)"));
    return facts;
}

}  // namespace subvol::cli
