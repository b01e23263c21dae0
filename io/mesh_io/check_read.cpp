// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "formats.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// Names appear in messages, on terminals, in JSON and in files, and users write them to choose what they name.
void settle_names(ReadResult& result) {
    NamesApart fields("array"), patches("patch"), sets("set of cells"), nodes("set of nodes");
    for (Attribute& attribute : result.mesh.attributes) attribute.name = fields.take(printable(attribute.name));
    for (Attribute& attribute : result.incomplete) attribute.name = fields.take(printable(attribute.name));
    for (std::size_t a = 0; a < result.shells.attributes.size(); ++a)
        result.shells.attributes[a].name = result.mesh.attributes.at(a).name;
    for (FieldInfo& field : result.fields) {
        field.name = printable(field.name);
        field.unit = printable(field.unit);
    }
    for (UnreadField& field : result.unread) {
        field.name = printable(field.name);
        field.why = printable(field.why);
    }
    for (MeshBlock& block : result.blocks) block.name = printable(block.name);
    for (Patch& patch : result.sets.patches) patch.name = patches.take(printable(patch.name));
    for (CellSet& set : result.sets.sets) set.name = sets.take(printable(set.name));
    for (NodeSet& set : result.sets.nodes) set.name = nodes.take(printable(set.name));
    for (std::string& warning : result.warnings) warning = printable(warning);
    for (const NamesApart* names : {&fields, &patches, &sets, &nodes}) names->report(result.warnings);
}

/// Bounds are where the limit is kept: values beyond them would silently become the nearer one.
void check_bounds(const Attribute& attribute, const std::vector<std::uint8_t>& used, std::vector<std::string>& warnings) {
    const auto channels = static_cast<std::size_t>(attribute.channels);
    const auto fail = [&](const std::string& what, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, what, "attribute " + in_quotes(attribute.name), allowed);
    };
    if (attribute.bounds.empty()) return;
    if (attribute.bounds.size() != channels)
        fail("has " + counted(attribute.bounds.size(), "pair", "pairs") + " of bounds",
             "none, or as many as components: " + std::to_string(channels));
    std::size_t outside = 0;
    for (std::size_t c = 0; c < channels; ++c) {
        const auto [low, high] = attribute.bounds[c];
        const std::string range = number_text(low) + " to " + number_text(high);
        if (!(low <= high)) fail("has the bounds " + range, "the lower one first");
        double least = 0, most = 0;
        std::size_t inside = 0, values = 0;
        for (std::size_t p = 0; p < used.size(); ++p) {
            if (!used[p]) continue;
            const double value = attribute.values[p * channels + c];
            least = values == 0 ? value : std::min(least, value);
            most = values == 0 ? value : std::max(most, value);
            inside += low <= value && value <= high ? 1 : 0;
            ++values;
        }
        if (inside == 0) {
            fail("has the bounds " + range + ", and no value lies within them",
                 "its values are " + number_text(least) + " to " + number_text(most));
        }
        // What was rounded may lie a little beyond.
        constexpr double kRounded = .01;
        if (std::max(low - least, most - high) > kRounded * (most - least)) outside += values - inside;
    }
    if (outside == 0) return;
    warnings.push_back(counted(outside, "value", "values") + " of " + in_quotes(attribute.name) +
                       " lie outside of the bounds that the file gives it, where the limit is cut off");
}

}  // namespace

void check_read(ReadResult& result, const std::string& file) {
    try {
        settle_names(result);
        const bool shells_alone = result.mesh.cells.empty() && !result.shells.empty();
        if (!shells_alone) validate(result.mesh);
        if (!result.shells.empty()) validate(result.shells, result.mesh);
        validate(result.sets, result.mesh);
        const std::vector<std::uint8_t> used = used_points(result.mesh);
        for (const Attribute& attribute : result.mesh.attributes) {
            if (!shells_alone) check_bounds(attribute, used, result.warnings);
        }
    } catch (const Error& error) {
        const bool names_file = std::string_view(error.what()).starts_with(file);
        if (names_file) throw;
        throw Error(error.code(), error.what(), file);
    }
}

}  // namespace subvol::detail
