// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "subvol/field_range.h"
#include "subvol/option.h"
#include "subvol/quantity.h"
#include "subvol/view_state.h"

namespace subvol {

std::vector<std::pair<std::string, std::string>> ViewFlow::words() const {
    std::vector<std::pair<std::string, std::string>> words;
    FlowChoices given = chosen, plain;
    const std::vector<Option> usual = options_of(plain);
    for (std::size_t k = 0; const Option& option : options_of(given)) {
        if (const std::string text = option.text(); text != usual[k++].text()) words.emplace_back(option.name, text);
        if (option.name != "streamlines") continue;
        for (const std::string& places : seeds) words.emplace_back("seeds", places);
    }
    return words;
}

ViewBody view_body(HexMesh mesh, const std::optional<std::string>& field) {
    SelectedField selected = select_field(mesh, field);
    mesh.attributes.assign(1, std::move(selected.scalar));
    const auto [min, max] = std::ranges::minmax(own_values(mesh.attributes.front()));
    const Box box = bounds(mesh);
    return {.mesh = std::move(mesh), .box = box, .range = {min, max}};
}

ViewBody view_body(HexMesh mesh, const ViewPoints& points, const std::optional<std::string>& field) {
    ViewBody body = view_body(std::move(mesh), field);
    const auto& channels = points.volume->channels;
    const auto found = std::ranges::find(channels, body.field(), &RbfChannel::name);
    if (found != channels.end()) body.channel = static_cast<std::size_t>(found - channels.begin());
    body.points = points;
    body.box = points.box;
    if (points.range) body.range = *points.range;
    return body;
}

HexMesh mesh_of_points(const RbfVolume& volume) {
    HexMesh mesh;
    mesh.points = volume.centers;
    for (const RbfChannel& channel : volume.channels)
        mesh.attributes.push_back({channel.name, 1, {channel.values.begin(), channel.values.end()}});
    return mesh;
}

BodyKind kind_of(const ViewBody& body) {
    if (body.points.volume) return body.points.voxels ? BodyKind::Voxels : BodyKind::Kernels;
    return body.tets ? BodyKind::Tets : BodyKind::Mesh;
}

std::vector<std::string> view_methods(Methods able) {
    std::vector<std::string> names;
    for (const auto& row : NameTable<Method>::rows) {
        if ((able & kViewMethods & bit(row.value)) != 0) names.emplace_back(row.name);
    }
    return names;
}

std::vector<std::string> methods_of(const ViewBody& body) {
    return view_methods(methods_of(kind_of(body)));
}

Optics optics_of(const ViewState& state, const ViewBody& body) {
    return picture_optics(state.look, body.box, body.range, body.range);
}

}  // namespace subvol
