// SPDX-License-Identifier: Apache-2.0
#include "body_input.h"

#include <algorithm>

#include "subvol/quantity.h"

namespace subvol::cli {
namespace {

/// Adds to a mesh the fields that it had and that have other names.
HexMesh with_others(HexMesh mesh, std::vector<Attribute> fields) {
    for (Attribute& field : fields) {
        if (mesh.find_attribute(field.name) == nullptr) mesh.attributes.push_back(std::move(field));
    }
    return mesh;
}

std::vector<std::string> names_in(const HexMesh& mesh) {
    std::vector<std::string> names;
    for (const Attribute& field : mesh.attributes) names.push_back(field.name);
    return names;
}

/// The number of a field that becomes a scalar, and is added if there is none.
std::size_t add_scalar_to(HexMesh& mesh, const std::string& name) {
    const auto found = std::ranges::find(mesh.attributes, name, &Attribute::name);
    const auto number = static_cast<std::size_t>(found - mesh.attributes.begin());
    if (found == mesh.attributes.end()) {
        mesh.attributes.push_back(select_field(mesh, name).scalar);
    } else if (found->channels > 1) {
        *found = select_field(mesh, name).scalar;
    }
    return number;
}

}  // namespace

MeshSource BodyInput::source() const {
    return bricks_ ? source_of(*bricks_, change_) : MeshSource(mesh_);
}

WithFacts<std::string> BodyInput::select(const CommonOptions& options, OtherFields others,
                                         const std::optional<std::string>& second) {
    std::vector<Attribute> fields;
    if (!bricks_) {
        if (others == OtherFields::Keep) fields = mesh_.attributes;
        auto [selected, facts] = with_selected_field(std::move(mesh_), options, second);
        selected_ = names_in(selected);
        mesh_ = with_others(std::move(selected), std::move(fields));
        return {mesh_.attributes.front().name, std::move(facts)};
    }
    WithFacts<StreamedField> selected = select_brick_field(*bricks_, options);
    std::vector<StreamedField> chosen{selected.value};
    for (std::size_t k = 1; k < options.fields.size(); ++k)
        chosen.push_back(named_brick_field(*bricks_, options.fields[k], false));
    selected_ = names_in(with_brick_fields(stand_in(*bricks_), chosen));
    change_ = [chosen = std::move(chosen), others](HexMesh brick) {
        std::vector<Attribute> all;
        if (others == OtherFields::Keep) all = brick.attributes;
        return with_others(with_brick_fields(std::move(brick), chosen), std::move(all));
    };
    return {selected_.front(), std::move(selected.facts)};
}

std::size_t BodyInput::add_scalar(const std::string& field) {
    if (!bricks_) return add_scalar_to(mesh_, field);
    HexMesh like = change_(stand_in(*bricks_));
    const std::size_t number = add_scalar_to(like, field);
    change_ = [change = std::move(change_), field](HexMesh brick) {
        HexMesh changed = change(std::move(brick));
        add_scalar_to(changed, field);
        return changed;
    };
    return number;
}

Range BodyInput::range(const std::string& field) const {
    if (!bricks_) {
        const auto found = std::ranges::find(mesh_.attributes, field, &Attribute::name);
        return field_range(mesh_, static_cast<std::size_t>(found - mesh_.attributes.begin()));
    }
    if (bricks_->fields.empty()) return {1, 1};  // density 1 everywhere
    const StreamedField streamed = named_brick_field(*bricks_, field, false);
    return {streamed.min, streamed.max};
}

Facts BodyInput::refine(const TetRefinement& tets, int default_levels, Progress* progress) {
    if (!tets.asked()) return {};
    (void)mesh_for(tets);
    auto [hexes, facts] = tets.hexes(std::move(mesh_), default_levels, progress);
    mesh_ = std::move(hexes);
    return facts;
}

const HexMesh& BodyInput::mesh_for(const TetRefinement& tets) const {
    if (bricks_) tets.refuse_bricks(input_);
    return mesh_;
}

WithFacts<BodyInput> open_body(const std::string& input, const CommonOptions& options, const CLI::App& app, Progress* progress,
                               bool shells, ShellsAlone alone) {
    if (kind_of(input) == InputKind::Bricks) {
        auto [bricks, facts] = open_bricks_input(input, app);
        return {{input, std::move(bricks)}, std::move(facts)};
    }
    Reshaped reshaped;
    auto [read, facts] = read_input(input, options, progress, alone, &reshaped);
    std::vector<MeshBlock> blocks = std::move(read.blocks);
    MeshSets sets = std::move(read.sets);
    std::vector<FieldInfo> fields = std::move(read.fields);
    Shells taken;
    HexMesh mesh = facts.unpack(mesh_of(std::move(read), options, shells ? &taken : nullptr));
    WithFacts<BodyInput> body{{input, std::move(mesh)}, std::move(facts)};
    body.value.blocks = std::move(blocks);
    body.value.sets = std::move(sets);
    body.value.of_file = std::move(fields);
    body.value.shells = std::move(taken);
    body.value.moved = std::move(reshaped.moved);
    body.value.in_part = std::move(reshaped.in_part);
    body.value.whole = std::move(reshaped.whole);
    body.value.opacities = std::move(reshaped.opacities);
    return body;
}

}  // namespace subvol::cli
