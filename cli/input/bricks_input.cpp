// SPDX-License-Identifier: Apache-2.0
#include "bricks_input.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>

#include "subvol/detail/near_name.h"
#include "subvol/error.h"
#include "subvol/quantity.h"
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
    const CLI::Option* const angle = app.get_option_no_throw("--crease-angle");
    if (angle != nullptr && angle->count() > 0 && angle->results().front() == "none")
        throw Error(ErrorCode::InvalidInput, "bricks have the creases that their mesh was split with", "--crease-angle none",
                    "subvol split --crease-angle none");
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
        if (field->channels <= 3) return {name, false, field->shortest, field->longest};
    }
    if (const std::size_t dot = name.rfind('.'); dot != std::string::npos && find(bricks, name.substr(0, dot)) != nullptr) {
        const SelectedField component = select_field(mesh, name);  // its least and its largest value are there
        const auto [min, max] = std::ranges::minmax(component.scalar.values);
        return {name, false, min, max};
    }
    if (has_derivatives(name)) {
        throw Error(ErrorCode::InvalidInput, "derivatives are not made brick by brick", name, "the file that was split");
    }
    StreamedField chosen{name, false};
    chosen.min = std::numeric_limits<double>::infinity();
    chosen.max = -chosen.min;
    for_each_piece(source_of(bricks).stored(), "range", nullptr, [&](std::size_t, const MeshPiece& piece) {
        const auto [min, max] = std::ranges::minmax(select_field(piece.mesh, name).scalar.values);
        chosen.min = std::min(chosen.min, min);
        chosen.max = std::max(chosen.max, max);
    });
    return chosen;
}

WithFacts<StreamedField> select_brick_field(const Bricks& bricks, const CommonOptions& options) {
    WithFacts<StreamedField> chosen{{{}, false, 1, 1}};  // density 1 everywhere
    if (options.field && find(bricks, *options.field) == nullptr) {
        chosen.value = named_brick_field(bricks, *options.field, false);
        chosen.facts["field"] = chosen.value.name;
        return chosen;
    }
    const SelectedField selected = select_field(stand_in(bricks), options.field);
    chosen.facts.warn(selected.warning);
    chosen.facts["field"] = selected.scalar.name;
    if (!bricks.fields.empty() && selected.scalar.name != "density") {
        chosen.value = named_brick_field(bricks, selected.scalar.name, false);
    } else if (find(bricks, "density") != nullptr) {
        chosen.value = named_brick_field(bricks, "density", false);
    }
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
