// SPDX-License-Identifier: Apache-2.0
#include "bricks_input.h"

#include <algorithm>
#include <charconv>

#include "subvol/detail/near_name.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

const BrickField* find(const Bricks& bricks, const std::string& name) {
    const auto found = std::ranges::find(bricks.fields, name, &BrickField::name);
    return found == bricks.fields.end() ? nullptr : &*found;
}

}  // namespace

WithFacts<Bricks> open_bricks_input(const std::string& input, const CLI::App& app) {
    refuse_mesh_options(app, "is settled when a mesh is split; this is a folder of bricks");
    WithFacts<Bricks> opened{open_bricks(input)};
    opened.facts["input"] = input;
    opened.facts["cells"] = opened.value.cells;
    opened.facts["bricks"] = opened.value.bricks.size();
    return opened;
}

HexMesh stand_in(const Bricks& bricks) {
    HexMesh mesh;
    for (int k = 0; k < 8; ++k) mesh.points.emplace_back(k & 1, k >> 1 & 1, k >> 2 & 1);
    mesh.cells.push_back({0, 1, 3, 2, 4, 5, 7, 6});
    for (const BrickField& field : bricks.fields) {
        Attribute& attribute = mesh.attributes.emplace_back(Attribute{field.name, field.channels, {}, field.bounds});
        for (int k = 0; k < 8; ++k) {
            const auto& values = k % 2 == 0 ? field.min : field.max;
            attribute.values.insert(attribute.values.end(), values.begin(), values.end());
        }
    }
    return mesh;
}

StreamedField named_brick_field(const Bricks& bricks, const std::string& name, bool vector_allowed) {
    const HexMesh mesh = stand_in(bricks);
    if (const BrickField* field = find(bricks, name)) {
        if (field->channels == 3 && vector_allowed) {
            return {name, true, std::ranges::min(field->min), std::ranges::max(field->max)};
        }
        (void)select_field(mesh, name);  // refuses what has no length
        return {name, false, field->shortest, field->longest};
    }
    (void)select_field(mesh, name);  // refuses what does not exist
    const std::size_t dot = name.rfind('.');
    std::size_t channel = 0;
    std::from_chars(name.data() + dot + 1, name.data() + name.size(), channel);
    const BrickField* field = find(bricks, name.substr(0, dot));
    return {name, false, field->min.at(channel), field->max.at(channel)};
}

WithFacts<StreamedField> select_brick_field(const Bricks& bricks, const CommonOptions& options) {
    const SelectedField selected = select_field(stand_in(bricks), options.field);
    WithFacts<StreamedField> chosen{{{}, false, 1, 1}};  // density 1 everywhere
    chosen.facts.warn(selected.warning);
    chosen.facts["field"] = selected.scalar.name;
    const bool everywhere = !options.field && find(bricks, selected.scalar.name) == nullptr;
    if (!everywhere) chosen.value = named_brick_field(bricks, options.field.value_or(selected.scalar.name), false);
    return chosen;
}

HexMesh with_brick_fields(HexMesh brick, const std::vector<StreamedField>& fields) {
    std::vector<Attribute> chosen;
    for (const StreamedField& field : fields) {
        if (field.name.empty()) {
            chosen.push_back(select_field(HexMesh{brick.points, brick.cells, {}, {}, {}}, {}).scalar);
        } else if (field.vector) {
            chosen.push_back(*brick.find_attribute(field.name));
        } else {
            chosen.push_back(select_field(brick, field.name).scalar);
        }
    }
    brick.attributes = std::move(chosen);
    return brick;
}

}  // namespace subvol::cli
