// SPDX-License-Identifier: Apache-2.0
#include "subvol/flow_surface.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/probe.h"
#include "subvol/quantity.h"

namespace subvol {
namespace {

constexpr const char* kVeil = "0%:.15";

/// Only with another option.
std::vector<Option> with(const char* other, std::vector<Option> all) {
    for (Option& option : all) option.only_with(other);
    return all;
}

std::vector<double> vectors_for(const HexMesh& mesh, const std::string& quantity, const std::string& option,
                                Progress* progress) {
    if (quantity.empty()) return {};
    try {
        return vectors_of(mesh, quantity, progress);
    } catch (const Error& error) {
        throw Error(error.code(), (error.where().empty() ? "" : error.where() + ": ") + error.message(), option,
                    error.allowed());
    }
}

/// Adds triangles whose values are those of their sources.
void append(ColoredSurface& to, const ShellSurface& drawn, const std::vector<double>& values) {
    const auto first = static_cast<Index>(to.surface.points.size());
    to.surface.points.insert(to.surface.points.end(), drawn.surface.points.begin(), drawn.surface.points.end());
    for (const auto& [a, b, c] : drawn.surface.triangles) to.surface.triangles.push_back({first + a, first + b, first + c});
    for (const Index source : drawn.sources) to.values.push_back(values[source]);
}

StreamlineOptions lines_of(const Flow& flow) {
    StreamlineOptions options = flow.chosen.lines;
    options.limit = flow.limit;
    options.progress = flow.limit.progress;
    return options;
}

}  // namespace

std::string FlowChoices::length_of(const HexMesh& mesh) const {
    const std::string& vector = streamlines.empty() ? glyphs : streamlines;
    const bool plain = std::ranges::all_of(vector, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; });
    return plain || mesh.find_attribute(vector) == nullptr ? "length(" + vector + ")" : "length(`" + vector + "`)";
}

std::vector<Option> options_of(FlowChoices& choices) {
    std::vector<Option> all{
        Option("streamlines", choices.streamlines)
            .help("EXPR",
                  "draw streamlines of this vector as tubes, in the colours of the field that is shown, which is the "
                  "length of the vector unless one is named"),
        Option("seed-count", choices.seed_count)
            .between(1, 100000)
            .help("N", "how many seeds: of each text that says where they are, or of middles of cells")
            .only_with("streamlines")};
    std::ranges::move(with("streamlines", options_of(choices.lines)), std::back_inserter(all));
    std::ranges::move(with("streamlines", options_of(choices.tubes)), std::back_inserter(all));
    all.push_back(Option("glyphs", choices.glyphs)
                      .help("EXPR",
                            "draw arrows along this vector, as long as it is large, in middles of cells that stand for "
                            "as much volume each"));
    std::ranges::move(with("glyphs", options_of(choices.arrows)), std::back_inserter(all));
    return all;
}

void veil_body(LookChoices& look, const Clip& clip) {
    if (look.look || look.opacity || look.opacity_unit_world || !look.iso.empty() || !clip.empty()) return;
    look.look = name_of(Look::Solid);
    look.opacity = kVeil;
}

Flow flow_in(const HexMesh& mesh, const FlowChoices& choices, OptionNames names, Progress* progress) {
    return {.chosen = choices,
            .stream_vectors = vectors_for(mesh, choices.streamlines, option_name("streamlines", names), progress),
            .glyph_vectors = vectors_for(mesh, choices.glyphs, option_name("glyphs", names), progress)};
}

ColoredSurface flow_surface(const HexMesh& mesh, const Flow& flow, Facts& facts) {
    HexMesh two = mesh;  // its vectors, and the field of the colours
    const Attribute color = two.attributes.back();
    const double diagonal = bounds(mesh).diagonal();
    ColoredSurface drawn;
    if (!flow.stream_vectors.empty()) {
        two.attributes = {{"streamlines", 3, flow.stream_vectors}, color};
        const Streamlines lines = trace_streamlines(two, "streamlines", flow.seeds, lines_of(flow));
        if (lines.count() == 0) {
            throw Error(ErrorCode::InvalidInput, "no seed lies in the volume", "seeds",
                        "places in the body, whose box info shows");
        }
        facts.merge(facts_of(lines));
        append(drawn, tube_surface(lines, flow.chosen.tubes.radius * diagonal), lines.fields.back().values);
    }
    if (!flow.glyph_vectors.empty()) {
        two.attributes = {{"glyphs", 3, flow.glyph_vectors}, color};
        const std::vector<Vec3> places = middles_of_cells(two, flow.chosen.arrows.count, flow.limit);
        const ProbeResult found = LimitProbe(two, {.limit = flow.limit}).at(places, flow.limit.progress);
        const std::vector<double>& v = found.fields.front().values;
        std::vector<Vec3> vectors;
        for (std::size_t p = 0; p < places.size(); ++p) vectors.emplace_back(v[3 * p], v[3 * p + 1], v[3 * p + 2]);
        append(drawn, arrow_surface(places, vectors, flow.chosen.arrows.size * diagonal), found.fields.back().values);
        facts["glyphs"] = places.size();
    }
    return drawn;
}

}  // namespace subvol
