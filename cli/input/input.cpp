// SPDX-License-Identifier: Apache-2.0
// From the word FILE of a command to the mesh that its verb works on, in this order:
//
//     kind      a mesh, a generated model, a folder of bricks, points, a grid or a picture, by the name and the extension
//     read      the file, the model or all bricks; between two steps, points and values are interpolated linearly in time
//     at rest   a density by an expression, and every quantity that is asked for, are computed in the whole mesh
//     only      the cells of the regions are taken out, or flagged where the verb works in the whole mesh
//     warp      points move by a vector field times a factor
//     patch     faces of the boundary become shells, and no cell is left
//     opacity   translucent parts become shells, and the opaque rest stays a mesh
//     field     one scalar is selected, and a second one if another quantity gives the colours
//
// Quantities come before the cut and the motion, so that they are those of the body as it was given. Where a part is cut out,
// its limit would differ from that of the whole near the cut; such a part is refined at most a few times, so that the two are
// near each other, and what is left of the difference is said.
#include "input.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "field_gaps.h"
#include "grid_input.h"
#include "limit_warning.h"
#include "options.h"
#include "points_input.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "steps.h"
#include "subvol/bricks.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "subvol/expression.h"
#include "subvol/field_bounds.h"
#include "subvol/field_range.h"
#include "subvol/limit_body.h"
#include "subvol/mesh_motion.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/part_of_limit.h"
#include "subvol/quantity.h"
#include "subvol/read_surface.h"
#include "subvol/topology.h"
#include "subvol/warp.h"
#include "text.h"

namespace subvol::cli {
namespace {

const std::string kModelPrefix = "model:";

/// to: a mesh or shells
template <class Points>
void put_density_first(Points& to, const std::string& expression) {
    std::erase_if(to.attributes, [](const Attribute& a) { return a.name == "density"; });
    to.attributes.insert(to.attributes.begin(), Attribute{"density", 1, evaluate_expression(expression, to.points)});
}

/// description: "NAME" or "NAME:RESOLUTION"
ReadResult generate(const std::string& description) {
    const std::size_t colon = description.find(':');
    int resolution = 0;
    if (colon != std::string::npos) {
        const std::string number = description.substr(colon + 1);
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), resolution);
        if (error != std::errc() || end != number.data() + number.size() || resolution == 0) {
            throw Error(ErrorCode::InvalidInput, "'" + number + "' is not a resolution", "model:" + description, "2..512");
        }
    }
    ReadResult result;
    result.mesh = make_model(description.substr(0, colon), resolution);
    for (const Attribute& field : result.mesh.attributes) {
        const auto [min, max] = std::ranges::minmax(field.values);
        result.fields.push_back({field.name, "point", field.channels, min, max});
    }
    return result;
}

/// A model has the creases that it was made with, unless an angle is given.
ReadResult with_creases(ReadResult model, const ReadOptions& options) {
    if (options.crease_angle_deg.value_or(0) > 0) {
        const std::size_t before = model.mesh.creases.size();
        tag_creases(model.mesh, *options.crease_angle_deg);
        model.sharp_edges = {model.mesh.creases.size() - before, false};
    }
    return model;
}

/// For what is not done brick by brick.
HexMesh mesh_of_bricks(const std::string& input, const CommonOptions& options, Progress* progress, Facts& facts) {
    refuse_file_options(options.app, "is settled when a mesh is split; this is a folder of bricks");
    const Bricks bricks = open_bricks(input);
    facts.warn(text("all ", counted(bricks.bricks.size(), "brick"), " (", counted(bricks.cells, "cell"),
                    ") are held in memory together: this is not done brick by brick"));
    return facts.timed(progress, "read", [&] { return whole_mesh(bricks, progress); });
}

constexpr std::string_view kBlockPrefix = "block:";

/// The field of that name in a step, with its gaps, if it has some there; nothing if the step has no such field.
std::optional<Attribute> field_of_step(const ReadResult& step, const std::string& name) {
    const auto with_gaps = std::ranges::find(step.incomplete, name, &Attribute::name);
    if (with_gaps != step.incomplete.end()) return *with_gaps;
    const Attribute* const whole = step.mesh.find_attribute(name);
    return whole == nullptr ? std::nullopt : std::optional(*whole);
}

/// Makes the fields that one of two steps has with gaps those between the steps: they have gaps where either has them. The
/// meshes have no longer those that were whole in one of the steps.
void put_gaps_between(ReadResult& before, ReadResult& after, double part) {
    std::vector<std::string> names;
    for (const ReadResult* step : {&before, &after}) {
        for (const Attribute& field : step->incomplete) {
            if (std::ranges::find(names, field.name) == names.end()) names.push_back(field.name);
        }
    }
    HexMesh first{before.mesh.points, before.mesh.cells, {}, {}, {}}, second{after.mesh.points, after.mesh.cells, {}, {}, {}};
    for (const std::string& name : names) {
        std::optional<Attribute> a = field_of_step(before, name), b = field_of_step(after, name);
        for (ReadResult* step : {&before, &after})
            std::erase_if(step->mesh.attributes, [&](const Attribute& field) { return field.name == name; });
        if (!a || !b) continue;
        first.attributes.push_back(std::move(*a));
        second.attributes.push_back(std::move(*b));
    }
    before.incomplete = mesh_between(std::move(first), second, part).attributes;
    std::erase_if(before.fields, [&](const FieldInfo& info) {
        return before.mesh.find_attribute(info.name) == nullptr &&
               std::ranges::find(before.incomplete, info.name, &Attribute::name) == before.incomplete.end();
    });
    for (const Attribute& field : before.incomplete) {
        const auto info = std::ranges::find(before.fields, field.name, &FieldInfo::name);
        if (info == before.fields.end()) continue;
        const auto channels = static_cast<std::size_t>(field.channels);
        const std::vector<double>& values = field.cells.empty() ? field.values : field.cells;
        info->missing = 0;
        std::optional<std::array<double, 2>> range;
        for (std::size_t i = 0; i + channels <= values.size(); i += channels) {
            double square = 0;
            for (std::size_t c = 0; c < channels; ++c) square += values[i + c] * values[i + c];
            const double value = channels == 1 ? values[i] : std::sqrt(square);
            info->missing += std::isnan(value) ? 1 : 0;
            if (std::isnan(value)) continue;
            if (!range) range = {value, value};
            range = {std::min((*range)[0], value), std::max((*range)[1], value)};
        }
        if (!range) {  // nowhere in both steps
            before.fields.erase(info);
            continue;
        }
        info->min = (*range)[0];
        info->max = (*range)[1];
    }
}

/// What lies between two steps: points and values linearly, the rest as in the step before.
ReadResult read_between(const std::string& input, const BetweenSteps& between, double time, ReadOptions options, Facts& facts) {
    options.step = between.after;
    ReadResult after = read_mesh(input, options);
    options.step = between.before;
    ReadResult read = read_mesh(input, options);
    const auto name_of_time = [](const ReadResult& step) { return step.mesh.time.value_or(0); };
    facts.note(text("time ", time, " is interpolated between step ", between.before, " (time ", name_of_time(read),
                    ") and step ", between.after, " (time ", name_of_time(after), ")"));
    facts["interpolated"] = between.part;
    of_option("--interpolate-time", [&] { put_gaps_between(read, after, between.part); });
    read.mesh = of_option("--interpolate-time", [&] { return mesh_between(std::move(read.mesh), after.mesh, between.part); });
    read.mesh.time = time;
    read.cell_means.clear();  // as in no step
    read.cell_parts.clear();
    for (FieldInfo& field : read.fields) {
        const Attribute* values = read.mesh.find_attribute(field.name);
        if (values == nullptr) continue;
        const Attribute lengths = select_field(read.mesh, "length(`" + field.name + "`)").scalar;
        const auto [least, greatest] = std::ranges::minmax(own_values(values->channels == 1 ? *values : lengths));
        field.min = least;
        field.max = greatest;
    }
    return read;
}

/// The sets without what is not of a part. cells: a flag for each cell, which keep their numbers
MeshSets sets_in_part(MeshSets sets, std::span<const std::uint8_t> cells) {
    for (Patch& patch : sets.patches) std::erase_if(patch.sides, [&](const CellSide& side) { return cells[side.cell] == 0; });
    for (CellSet& set : sets.sets) std::erase_if(set.cells, [&](Index cell) { return cells[cell] == 0; });
    for (NodeSet& set : sets.nodes) std::erase_if(set.cells, [&](const CellCorners& at) { return cells[at.cell] == 0; });
    return sets;
}

/// What --only or --part-opacity leave of a mesh, as a mesh of its own. If the verb works on its limit, that is near to where
/// it lies in the whole, and what is left of the difference is said.
PartOfLimit taken_out(const HexMesh& mesh, std::span<const std::uint8_t> cells, const CommonOptions& options, bool of_file,
                      Facts& facts) {
    RefineArguments refinement;
    if (options.part_levels && options.app != nullptr) {
        const GivenOptions given = given_options(*options.app);
        for (const Option& option : refinement.described()) {
            if (const auto text = given(option.name)) option.read(*text, "--" + option.name);
        }
    }
    if (!options.part_levels || is_tet_scheme(refinement.scheme)) return {only_cells(mesh, cells)};
    const PartOptions wanted{.scheme = refinement.options(0, nullptr).scheme,
                             // --levels are those of the cells as they were given
                             .max_levels = refinement.levels ? 0 : *options.part_levels,
                             .progress = options.listener};
    PartOfLimit part = part_of_limit(mesh, cells, wanted);
    Facts& said = facts.group("part");
    said["levels"] = part.levels;
    said["distance"] = part.distance_world;
    said["field_change"] = part.field_change;
    said["volume_change"] = part.volume_change;
    if (part.levels > 0) {
        facts.note(text("the part is refined ", part.levels == 1 ? "once" : "twice", " to lie as in the whole (",
                        counted(part.mesh.cells.size(), "cell"), ")"));
        const HexMesh control = only_cells(mesh, cells);
        LimitBody body = limit_body(part.mesh, wanted.scheme, 1, options.listener);
        const LimitBody given = limit_body(control, wanted.scheme, 1, options.listener);
        body.given_volume = given.given_volume;
        body.given_bounds = given.given_bounds;
        if (of_file && wanted.scheme.kind != Scheme::Linear) facts.warn(limit_warning(body));
    }
    const std::string warning = detail::part_warning(part, OptionNames::Flags);
    if (!warning.empty()) {
        facts.warn(warning);
    } else if (part.distance_world > wanted.tolerance * bounds(part.mesh).diagonal() ||
               part.field_change > wanted.field_tolerance) {
        facts.note(detail::part_words(part));
    }
    return part;
}

/// What --only, --warp, --patch and --part-opacity make of a mesh. Quantities are computed before, in the whole mesh at rest.
///
/// of_file: it was read from a file, whose cells are what is meant
Reshaped reshape(ReadResult& read, const CommonOptions& options, bool of_file, Facts& facts) {
    const std::vector<Region> regions = regions_of(options);
    if (regions.empty() && !options.warp && options.patches.empty() && options.part_opacities.empty()) return {};
    Reshaped reshaped;
    std::optional<Warp>& moved = reshaped.moved;
    HexMesh mesh = used_mesh(std::move(read.mesh), options);
    if (options.field && mesh.find_attribute(*options.field) == nullptr) {
        mesh.attributes.push_back(select_field(mesh, options.field, options.listener).scalar);
        mesh.attributes.back().name = *options.field;
    }
    for (const std::string& quantity : options.at_rest) {
        if (mesh.find_attribute(quantity) == nullptr)
            mesh.attributes.push_back(field_of(mesh, quantity, quantity, options.listener));
    }
    if (!read.shells.empty()) {
        facts.warn("shells and beams are left out with --only, --warp, --patch and --part-opacity");
        read.shells = {};
    }
    if (!regions.empty()) {
        const std::size_t before = mesh.cells.size();
        const auto cells = of_option("--only", [&] { return cells_in(mesh, regions, read.sets); });
        const auto left = static_cast<std::size_t>(std::ranges::count(cells, 1));
        if (options.parts_in_whole) {
            read.sets = sets_in_part(std::move(read.sets), cells);
            reshaped.in_part = cells;
        } else {
            PartOfLimit part = taken_out(mesh, cells, options, of_file, facts);
            mesh = std::move(part.mesh);
            read.sets = sets_of_children(sets_of_cells(std::move(read.sets), cells), part.levels);
        }
        facts["only_cells"] = left;
        facts.note(text(count_text(left), " of ", counted(before, "cell"), " lie in the region"));
        read.cell_means.clear();
        read.cell_parts.clear();
    }
    if (options.warp) {
        moved = of_option("--warp", [&] { return parse_warp(*options.warp); });
        moved->factor = of_option("--warp", [&] { return move_points(mesh, *moved); });
        Facts& said = facts.group("warp");
        said["field"] = moved->field;
        said["factor"] = *moved->factor;
        facts.note(text("moved by ", *moved->factor, " × ", moved->field));
    }
    if (!options.patches.empty() || !options.part_opacities.empty()) reshaped.whole = mesh;
    if (!options.patches.empty()) {
        std::vector<Patch> patches = patches_of_option(mesh, read.sets, options.patches);
        read.shells = patch_shells(mesh, patches);
        mesh.cells.clear();
        std::vector<std::string> names;
        for (const Patch& patch : patches) names.push_back(text(names.size() + 1, " ", patch.name));
        facts.note("patches: " + join(names));
        read.sets = {std::move(patches), {}};
    }
    if (!options.part_opacities.empty()) {
        TranslucentParts parts = of_option("--part-opacity", [&] {
            std::vector<PartOpacity> asked;
            for (const std::string& part : options.part_opacities) asked.push_back(parse_part_opacity(part));
            return translucent_parts(mesh, asked, read.sets);
        });
        facts["opaque_cells"] = parts.rest.cells.size();
        int levels = 0;
        if (parts.rest.cells.empty()) {
            mesh = std::move(parts.rest);
        } else {
            PartOfLimit rest = taken_out(mesh, parts.cells, options, of_file, facts);
            mesh = std::move(rest.mesh);
            levels = rest.levels;
        }
        read.sets = sets_of_children(sets_of_cells(std::move(read.sets), parts.cells), levels);
        read.shells = std::move(parts.shells);
        read.cell_means.clear();
        read.cell_parts.clear();
        reshaped.opacities = std::move(parts.opacities);
    }
    read.mesh = std::move(mesh);
    return reshaped;
}

}  // namespace

std::vector<Region> regions_of(const CommonOptions& options) {
    return of_option("--only", [&] {
        std::vector<Region> regions;
        for (const std::string& region : options.only) {
            const bool is_block = region.starts_with(kBlockPrefix);  // a set of cells, as all blocks are
            regions.emplace_back(is_block ? "set:" + region.substr(kBlockPrefix.size()) : region);
        }
        return regions;
    });
}

CommonOptions with_whole_cells(CommonOptions options, std::vector<Region>& space) {
    space = space_and_cells(regions_of(options)).space;
    std::erase_if(options.only,
                  [&](const std::string& text) { return std::ranges::find(space, text, &Region::text) != space.end(); });
    return options;
}

std::string input_help() {
    return "a mesh (" + join(readable_mesh_extensions()) + "), or model:NAME[:RESOLUTION]";
}

InputKind kind_of(const std::string& input) {
    if (is_bricks(input) || extension_of(input) == ".bricks") return InputKind::Bricks;
    const std::vector<std::string> meshes = readable_mesh_extensions();
    if (is_model(input) || std::ranges::find(meshes, extension_of(input)) != meshes.end()) return InputKind::Mesh;
    if (holds_points(input)) return InputKind::Points;
    if (is_vdb_file(input)) return InputKind::Grid;
    const bool surface = is_surface_file(input) || detail::names_foreign_surface(input);  // the way to a mesh is said
    return is_mesh_file(input) || surface ? InputKind::Mesh : InputKind::Picture;
}

bool is_model(const std::string& input) {
    return input.starts_with(kModelPrefix);
}

ReadOptions read_options(const std::string& input, const CommonOptions& options) {
    ReadOptions read = options.read;
    if (options.weld && !read.weld) read.weld = 0;
    read.step = one_step(input, options);
    // One option of the command says which edges are sharp, when a file is read and for the scheme.
    const auto angle = options.app == nullptr ? std::nullopt : given_options(*options.app)("crease-angle");
    const std::vector<Option> described = options_of(read);
    if (angle) std::ranges::find(described, "crease-angle", &Option::name)->read(*angle, "--crease-angle");
    return read;
}

WithFacts<ReadResult> read_input(const std::string& input, const CommonOptions& options, Progress* progress, ShellsAlone alone,
                                 Reshaped* reshaped) {
    Facts facts;
    facts["input"] = input;
    if (kind_of(input) == InputKind::Bricks) {
        ReadResult read;
        read.mesh = mesh_of_bricks(input, options, progress, facts);
        return {std::move(read), std::move(facts)};
    }
    const bool model = is_model(input);
    if (model) refuse_file_options(options.app, "says how a file is read; this is a model");
    if (model && !options.read.sharp.empty()) throw Error(ErrorCode::InvalidInput, "a model has no groups", "--sharp");
    if (model && (options.step || options.read.time))
        throw Error(ErrorCode::InvalidInput, "a model has no steps", "--step, --time");
    const auto of_block = [](const std::string& region) { return region.starts_with(kBlockPrefix); };
    if (model && (!options.read.blocks.empty() || std::ranges::any_of(options.only, of_block)))
        throw Error(ErrorCode::InvalidInput, "a model has no blocks", "--blocks");
    ReadResult read = facts.timed(progress, "read", [&] {
        ReadOptions file_options = read_options(input, options);
        if (model) return with_creases(generate(input.substr(kModelPrefix.size())), file_options);
        file_options.shells_alone = alone == ShellsAlone::Take;
        const auto between = between_steps(input, options);
        if (!between) return read_mesh(input, file_options);
        return read_between(input, *between, *options.read.time, file_options, facts);
    });
    for (const std::string& warning : read.warnings) facts.warn(warning);
    refuse_unread(read, input, options);
    facts.merge(take_incomplete(read, input, options));
    say_step(read, facts);
    if (read.sharp_edges) {
        const std::size_t edges = read.sharp_edges->edges;
        facts["sharp_edges"] = edges;
        const double angle = read_options(input, options).crease_angle_deg.value_or(kSharpAngleDeg);
        if (edges > 0) facts.note(text(counted(edges, "sharp edge"), " kept (more than ", angle, "°)"));
    }
    if (read.cell_values) {
        Facts& means = facts.group("cell_values");
        means["method"] = std::string(name_of(read.cell_values->method));
        means["fields"] = read.cell_values->fields;
        means["rms_of_range"] = read.cell_values->rms_of_range;
        means["max_of_range"] = read.cell_values->most_of_range;
    }
    if (read.patch_values) {
        Facts& values = facts.group("patch_values");
        values["fields"] = read.patch_values->fields;
        values["points"] = read.patch_values->points;
        values["change_of_integral"] = read.patch_values->most_of_mean;
        values["most_changed"] = read.patch_values->most_changed;
    }
    if (read.curved) {
        Facts& curved = facts.group("curved");
        curved["cells"] = read.curved->curved;
        curved["hexahedra"] = read.curved->hexes;
        curved["most_hexahedra"] = read.curved->most_hexes;
        curved["tolerance"] = read.curved->tolerance;
        curved["shape_error"] = read.curved->shape_error;
        curved["fields_error"] = read.curved->fields_error;
        curved["limited"] = read.curved->limited;
    }
    if (options.clamp_file) bound_as_given(read.mesh, read.cell_means);
    Reshaped made = reshape(read, options, !model, facts);
    if (reshaped != nullptr) *reshaped = std::move(made);
    return {std::move(read), std::move(facts)};
}

WithFacts<HexMesh> load_mesh(const std::string& input, const CommonOptions& options, Progress* progress, Shells* shells,
                             ShellsAlone alone) {
    auto [read, facts] = read_input(input, options, progress, alone);
    HexMesh mesh = facts.unpack(mesh_of(std::move(read), options, shells));
    return {std::move(mesh), std::move(facts)};
}

WithFacts<HexMesh> load_mesh(const std::string& input, const CommonOptions& options, Progress* progress, MeshSets& sets,
                             Shells* shells) {
    auto [read, facts] = read_input(input, options, progress);
    sets = std::move(read.sets);
    HexMesh mesh = facts.unpack(mesh_of(std::move(read), options, shells));
    return {std::move(mesh), std::move(facts)};
}

WithFacts<HexMesh> mesh_of(ReadResult read, const CommonOptions& options, Shells* shells) {
    Facts facts;
    if (shells != nullptr) {
        *shells = with_density(std::move(read.shells), options);
    } else {
        facts.warn(shells_left_out(read.shells));
    }
    if (read.mesh.cells.empty()) {
        read.mesh.points = shells->points;
        read.mesh.attributes = shells->attributes;
        return {std::move(read.mesh), std::move(facts)};
    }
    return {used_mesh(std::move(read.mesh), options), std::move(facts)};
}

std::vector<FieldInfo> chosen_fields(const ReadResult& read, const CommonOptions& options) {
    if (!options.density && !options.field) return read.fields;
    HexMesh mesh = read.mesh;
    if (mesh.cells.empty()) {
        mesh.points = read.shells.points;
        mesh.attributes = read.shells.attributes;
        if (options.density) put_density_first(mesh, *options.density);
    } else {
        mesh = used_mesh(std::move(mesh), options);
    }
    const std::string name = options.density ? "density" : *options.field;
    const auto range = [](const std::vector<double>& values) { return std::ranges::minmax(values); };
    std::vector<FieldInfo> fields = read.fields;
    if (options.density) {
        const auto [min, max] = range(mesh.attributes.front().values);
        std::erase_if(fields, [&](const FieldInfo& field) { return field.name == name; });
        fields.insert(fields.begin(), {name, "point", 1, min, max});
        return fields;
    }
    const auto found = std::ranges::find(fields, name, &FieldInfo::name);
    if (found != fields.end()) return {*found};
    const SelectedField selected = select_field(mesh, name);  // a component; or there is none of that name
    const auto [min, max] = range(own_values(selected.scalar));
    return {{name, selected.scalar.constant ? "cell" : "point", 1, min, max}};
}

std::string shells_left_out(const Shells& shells) {
    if (shells.empty()) return {};
    const std::string quads = shells.quads.empty() ? "" : counted(shells.quads.size(), "quad");
    const std::string lines = shells.lines.empty() ? "" : counted(shells.lines.size(), "line");
    return text(quads, quads.empty() || lines.empty() ? "" : " and ", lines,
                " of shells and beams left out: render, surface, subdivide and info read them");
}

Shells with_density(Shells shells, const CommonOptions& options) {
    if (options.density && !shells.empty()) put_density_first(shells, *options.density);
    return shells;
}

std::string unit_of(const std::vector<FieldInfo>& fields, const std::string& quantity) {
    for (const FieldInfo& field : fields) {
        const bool component = quantity.starts_with(field.name + ".");
        if (quantity == field.name || component || quantity == "length(" + field.name + ")") return field.unit;
    }
    return {};
}

std::vector<Patch> patches_of_option(const HexMesh& mesh, const MeshSets& sets, const std::vector<std::string>& names) {
    return of_option("--patch", [&] { return chosen_patches(mesh, sets, names); });
}

HexMesh used_mesh(HexMesh read, const CommonOptions& options) {
    HexMesh mesh = without_unused_points(std::move(read));
    const bool done = options.warp && mesh.find_attribute("density") != nullptr;  // at rest, by the first call
    if (options.density && !done) put_density_first(mesh, *options.density);
    return mesh;
}

HexMesh with_written_field(HexMesh mesh, const CommonOptions& options) {
    if (!options.field) return mesh;
    const Attribute* whole = mesh.find_attribute(*options.field);
    Attribute chosen = whole != nullptr ? *whole : select_field(mesh, options.field).scalar;
    mesh.attributes = {std::move(chosen)};
    return mesh;
}

WithFacts<HexMesh> with_selected_field(HexMesh mesh, const CommonOptions& options, const std::optional<std::string>& second) {
    Facts facts;
    const auto select = [&](const std::optional<std::string>& name) {
        try {
            return select_field(mesh, name, options.listener);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::InvalidInput) throw;
            throw NoSuchField(error);
        }
    };
    SelectedField selected = select(options.density ? std::optional<std::string>("density") : options.field);
    facts.warn(selected.warning);
    facts["field"] = selected.scalar.name;
    if (!options.density && !options.field && mesh.attributes.size() > 1 && selected.warning.empty()) {
        facts.note(text(options.draws ? "drawing " : "taking ", selected.scalar.name, " (of ", mesh.attributes.size(),
                        " fields; --field chooses)"));
    }
    std::vector<Attribute> chosen{std::move(selected.scalar)};
    for (std::size_t k = 1; k < options.fields.size(); ++k) {
        SelectedField more = select(options.fields[k]);
        facts.warn(more.warning);
        if (std::ranges::find(chosen, more.scalar.name, &Attribute::name) == chosen.end())
            chosen.push_back(std::move(more.scalar));
    }
    if (second && *second != chosen.front().name) chosen.push_back(select(second).scalar);
    mesh.attributes = std::move(chosen);
    if (options.clamp_file) bound_as_given(mesh);
    return {std::move(mesh), std::move(facts)};
}

Range field_range(const HexMesh& mesh, std::size_t attribute) {
    const auto [min, max] = std::ranges::minmax(own_values(mesh.attributes[attribute]));
    const auto& bounds = mesh.attributes[attribute].bounds;
    return {min, max, !bounds.empty() && std::isfinite(bounds[0][0]) && std::isfinite(bounds[0][1])};
}

}  // namespace subvol::cli
