// SPDX-License-Identifier: Apache-2.0
#include "written_fields.h"

#include <algorithm>

#include "input.h"
#include "limit_warning.h"
#include "subvol/error.h"
#include "subvol/field_bounds.h"
#include "subvol/field_range.h"
#include "subvol/quantity.h"
#include "subvol/vdb_contents.h"
#include "text.h"
#include "vdb_functions.h"
#include "vdb_output.h"

namespace subvol::cli {

WrittenFields::WrittenFields(const VdbArguments& asked)
    : fields_(parse_grid_fields(asked.fields)), clamp_(asked.clamp), prune_(asked.prune) {
    for (const std::string& remap : asked.remaps) remaps_.push_back(parse_remap(remap));
}

WithFacts<HexMesh> WrittenFields::chosen(HexMesh mesh, const CommonOptions& options) const {
    Facts facts;
    if (fields_.empty()) {
        mesh = facts.unpack(with_selected_field(std::move(mesh), options));
    } else {
        std::vector<Attribute> chosen;
        for (const auto& [name, source] : fields_) {
            if (name != source) {
                chosen.push_back(field_of(mesh, name, source, options.listener));
                continue;
            }
            if (const Attribute* vector = mesh.find_attribute(name); vector && vector->channels == 3) {
                chosen.push_back(*vector);
                continue;
            }
            SelectedField selected = select_field(mesh, name, options.listener);
            facts.warn(selected.warning);
            chosen.push_back(std::move(selected.scalar));
        }
        mesh.attributes = std::move(chosen);
    }
    for (const Remap& remap : remaps_) apply(remap, mesh);
    if (clamp_ || options.clamp_file) bound_as_given(mesh);
    return {std::move(mesh), std::move(facts)};
}

bool WrittenFields::maps(const Remap& remap, const Attribute& field, const HexMesh& mesh) {
    return remap.grid.empty() ? &field == &mesh.attributes.front() : remap.grid == field.name;
}

void WrittenFields::clamp(const HexMesh& mesh, std::vector<VdbGrid>& grids) const {
    for (VdbGrid& grid : grids) {
        const Attribute* field = mesh.find_attribute(grid.report().name);
        if (field == nullptr || field->name == kVelocity) continue;
        if (const auto bounds = bounds_of(*field)) vdb().clamp_voxels(grid, *bounds);
        for (const Remap& remap : remaps_) {
            if (maps(remap, *field, mesh))
                vdb().clamp_voxels(grid, {{std::min(remap.to_low, remap.to_high)}, {std::max(remap.to_low, remap.to_high)}});
        }
        if (prune_) vdb().prune_voxels(grid, *prune_);
    }
}

void WrittenFields::prune(std::vector<VdbGrid>& grids) const {
    if (!prune_) return;
    for (VdbGrid& grid : grids) vdb().prune_voxels(grid, *prune_);
}

void WrittenFields::refuse_nothing_left(const std::vector<VdbGrid>& grids) const {
    if (!prune_ || has_voxels(grids)) return;
    throw Error(ErrorCode::InvalidInput, "leaves no voxel", text("--prune ", *prune_), "less than the field's values");
}

Facts WrittenFields::overshoot(const HexMesh& mesh, const std::vector<VdbGrid>& grids, bool of_file) const {
    Facts facts;
    for (const VdbGrid& grid : grids) {
        const Attribute* field = mesh.find_attribute(grid.report().name);
        if (field == nullptr || field->channels != 1) continue;
        if (std::ranges::any_of(remaps_, [&](const Remap& remap) { return maps(remap, *field, mesh); })) continue;
        const FieldRange range = range_of(*field);
        say_beyond(facts, field->name, {range.min[0], range.max[0]}, {grid.report().min, grid.report().max},
                   of_file && !field->derived);
    }
    return facts;
}

}  // namespace subvol::cli
