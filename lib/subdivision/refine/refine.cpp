// SPDX-License-Identifier: Apache-2.0
// Refines a mesh of hexahedra level by level. The control mesh is checked, loses unused points, and gets creases by angle, if
// these are asked for, once.
//
//     topology of level l − 1 ─┬─► rows of the scheme ─┬─► applied to points and attributes, block by block ─► level l
//                              │                       └─► or kept as a table, applied to any values later
//                              └─► creases, sharp faces and topology of level l
//
// Fields at cells are taken out before and given to the 8^L children of each cell after L levels. Fields that are functions of
// place are refined by their arguments, and restored after that.
//
// Some cells alone are refined as a patch, with two layers of cells around them. Tables of all levels can be applied one after
// the other, or multiplied into one table over the control points.
#include "subvol/refine.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "subvol/detail/all_cells.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/patch.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/refined_memory.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using detail::SchemeRows;

namespace {

std::string stage_of(int level) {
    return "refine to level " + std::to_string(level);
}

/// Points and attributes of the child. The stencils are applied block by block and not kept.
HexMesh child_data(const HexMesh& parent, const SchemeRows& rows, Progress* progress, int level) {
    if (detail::has_functions(parent)) {
        HexMesh made = child_data(detail::with_arguments(HexMesh(parent)), rows, progress, level);
        detail::restore_functions(made, parent.attributes);
        return made;
    }
    HexMesh child;
    child.points.resize(rows.rows());
    std::copy_n(parent.points.begin(), rows.kept(), child.points.begin());
    for (const auto& attribute : parent.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        auto& values =
            child.attributes.emplace_back(Attribute{attribute.name, attribute.channels, {}, attribute.bounds}).values;
        values.resize(rows.rows() * channels);
        std::copy_n(attribute.values.begin(), rows.kept() * channels, values.begin());
    }
    const detail::RowInput input(rows, parent);
    rows.for_each_block(progress, stage_of(level), [&](std::size_t, const StencilTable::Block& block) {
        detail::apply_block(block, input.points(), 3, &child.points[block.first_row].x);
        for (std::size_t a = 0; a < parent.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(parent.attributes[a].channels);
            detail::apply_block(block, input.values(a), channels,
                                child.attributes[a].values.data() + block.first_row * channels);
        }
    });
    return child;
}

StencilTable make_table(const SchemeRows& rows, Progress* progress, int level) {
    std::vector<StencilTable::Block> blocks(rows.block_count());
    rows.for_each_block(progress, stage_of(level),
                        [&](std::size_t number, const StencilTable::Block& block) { blocks[number] = block; });
    return {rows.columns(), rows.kept(), std::move(blocks)};
}

template <class T>
void apply_levels(const RefinementTables& tables, std::span<const T> control, std::size_t channels, std::span<T> fine) {
    const StencilTable none(tables.control_points, tables.control_points, {});
    FlatArray<T> values;  // of the level before
    std::span<const T> coarse = control;
    for (std::size_t l = 0; l + 1 < tables.levels.size(); ++l) {
        FlatArray<T> finer(tables.levels[l].rows() * channels);
        tables.levels[l].apply(coarse, channels, std::span<T>(finer));
        values = std::move(finer);
        coarse = values;
    }
    (tables.levels.empty() ? none : tables.levels.back()).apply(coarse, channels, fine);
}

template <class T>
std::vector<T> apply_levels(const RefinementTables& tables, std::span<const T> control, std::size_t channels) {
    std::vector<T> fine(tables.points() * channels);
    apply_levels(tables, control, channels, std::span<T>(fine));
    return fine;
}

void check_cells(const HexMesh& mesh, std::span<const Index> cells) {
    std::vector<std::uint8_t> named(mesh.cells.size(), 0);
    for (const Index c : cells) {
        if (c >= mesh.cells.size()) {
            throw Error(ErrorCode::InvalidInput, "there is no cell " + std::to_string(c), {},
                        "the mesh has " + std::to_string(mesh.cells.size()) + " cells");
        }
        if (named[c]) throw Error(ErrorCode::InvalidInput, "cell " + std::to_string(c) + " is listed twice");
        named[c] = 1;
    }
}

}  // namespace

void detail::check_memory(int level, double cells, double bytes_per_cell, const std::string& where) {
    const double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    if (level == 0 || cells * bytes_per_cell < memory) return;
    throw Error(ErrorCode::MissingCapability,
                "level " + std::to_string(level) + " has " + number_text(cells) + " cells, which need about " +
                    number_text(std::ceil(cells * bytes_per_cell / 1e9)) + " GB of memory; this machine has " +
                    number_text(std::floor(memory / 1e9)),
                where);
}

HexMesh detail::take_cell_fields(HexMesh& mesh) {
    HexMesh taken;
    if (std::ranges::none_of(mesh.attributes, [&](const Attribute& field) { return is_at_cells(mesh, field); })) return taken;
    taken.cells = mesh.cells;
    for (Attribute& field : mesh.attributes)
        taken.attributes.push_back({.name = field.name,
                                    .channels = field.channels,
                                    .values = {},
                                    .cells = std::exchange(field.cells, {}),
                                    .constant = field.constant});
    return taken;
}

void detail::inherit_cells(const HexMesh& control, std::span<const Index> cells, int levels, HexMesh& fine) {
    const std::size_t children = std::size_t{1} << (3 * levels);
    for (std::size_t a = 0; a < control.attributes.size(); ++a) {
        const Attribute& from = control.attributes[a];
        if (!is_at_cells(control, from)) continue;
        Attribute& to = fine.attributes[a];
        const auto width = static_cast<std::size_t>(from.channels);
        to.cells.reserve(width * cells.size() * children);
        for (const Index c : cells) {
            const std::span<const double> own(from.cells.data() + c * width, width);
            for (std::size_t k = 0; k < children; ++k) to.cells.insert(to.cells.end(), own.begin(), own.end());
        }
        to.constant = from.constant;
        if (to.constant) set_means_at_points(fine, to);
    }
}

void detail::check_levels(int levels) {
    if (levels < 0 || levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(levels), {}, "0 to 10");
    }
}

HexMesh detail::control_mesh(HexMesh mesh, const SchemeOptions& scheme, int levels) {
    check_levels(levels);
    validate(mesh);
    HexMesh control = without_unused_points(std::move(mesh));
    if (scheme.crease_angle_deg && levels > 0) tag_creases(control, *scheme.crease_angle_deg);
    return control;
}

detail::RefinedPoints detail::refine_points(HexMesh control, Topology topology, const RefineOptions& options) {
    RefinedPoints refined{std::move(control), std::move(topology)};
    for (int level = 1; level <= options.levels; ++level) {
        if (level > 1) refined.parent = child_topology(refined.parent);
        HexMesh child = child_data(refined.mesh, SchemeRows(refined.parent, options.scheme, SchemeRows::Columns::WithSums),
                                   options.progress, level);
        child.creases = child_creases(refined.parent);
        child.sharp_faces = child_sharp_faces(refined.parent);
        refined.mesh = std::move(child);
    }
    return refined;
}

HexMesh refine(const HexMesh& mesh, const RefineOptions& options) {
    HexMesh control = detail::control_mesh(mesh, options.scheme, options.levels);
    if (options.levels == 0) return control;
    detail::check_memory(options.levels, static_cast<double>(control.cells.size()) * std::pow(8.0, options.levels),
                         detail::kBytesOfRefinedCell);
    report_progress(options.progress, "topology", 0);
    Topology topology = build_topology(control);
    const HexMesh at_cells = detail::take_cell_fields(control);
    detail::RefinedPoints refined = detail::refine_points(std::move(control), std::move(topology), options);
    refined.mesh.cells = detail::child_cells(refined.parent);
    if (!at_cells.cells.empty()) detail::inherit_cells(at_cells, detail::all_cells(at_cells), options.levels, refined.mesh);
    return std::move(refined.mesh);
}

HexMesh refine_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options) {
    const HexMesh control = detail::control_mesh(mesh, options.scheme, options.levels);
    check_cells(mesh, cells);
    if (cells.empty()) return {};
    HexMesh arguments;
    if (detail::has_functions(control)) arguments = detail::with_arguments(HexMesh(control));
    const detail::PatchSource source(detail::has_functions(control) ? arguments : control);
    HexMesh fine = detail::refine_patch(source, cells, options.scheme, options.levels, 0).mesh;
    detail::restore_functions(fine, control.attributes);
    detail::inherit_cells(control, cells, options.levels, fine);
    return fine;
}

RefinementTables refinement_tables(const Topology& control, const RefineOptions& options) {
    detail::check_levels(options.levels);
    RefinementTables tables;
    tables.control_points = control.point_count;
    tables.cells = control.cells;
    tables.creases = control.creases;
    for (std::size_t f = 0; f < control.face_is_sharp.size(); ++f) {
        if (control.face_is_sharp[f]) tables.sharp_faces.push_back(control.faces[f]);
    }
    const Topology* parent = &control;
    Topology current;
    for (int level = 1; level <= options.levels; ++level) {
        tables.levels.push_back(make_table(SchemeRows(*parent, options.scheme), options.progress, level));
        tables.creases = detail::child_creases(*parent);
        tables.sharp_faces = detail::child_sharp_faces(*parent);
        if (level == options.levels) {
            tables.cells = detail::child_cells(*parent);
        } else {
            current = detail::child_topology(*parent);
            parent = &current;
        }
    }
    return tables;
}

void RefinementTables::apply(std::span<const double> control, std::size_t channels, std::span<double> fine) const {
    apply_levels(*this, control, channels, fine);
}

void RefinementTables::apply(std::span<const float> control, std::size_t channels, std::span<float> fine) const {
    apply_levels(*this, control, channels, fine);
}

std::vector<double> RefinementTables::apply(std::span<const double> control, std::size_t channels) const {
    return apply_levels(*this, control, channels);
}

std::vector<float> RefinementTables::apply(std::span<const float> control, std::size_t channels) const {
    return apply_levels(*this, control, channels);
}

StencilTable RefinementTables::over_control_points() const {
    if (levels.empty()) return {control_points, control_points, {}};
    StencilTable table = levels.front();
    for (std::size_t l = 1; l < levels.size(); ++l) table = levels[l].after(table);
    return table;
}

std::size_t RefinementTables::bytes() const {
    std::size_t bytes = cells.capacity() * sizeof(cells[0]);
    for (const StencilTable& level : levels) bytes += level.bytes();
    return bytes;
}

std::vector<Option> options_of(RefineOptions& options) {
    std::vector<Option> all = options_of(options.scheme);
    all.push_back(Option("levels", options.levels).between(0, 10).help("L", "number of refinements"));
    return all;
}

}  // namespace subvol
