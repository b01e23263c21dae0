// SPDX-License-Identifier: Apache-2.0
// Levels of a mixed mesh as tables, and the volume through given points.
//
// The schemes approximate: their limit does not pass through the control points. `interpolate_vertices` looks for control
// points whose limit is at the given points x. With M the limits of vertices as a matrix,
//
//     p ← p + (x − M p),    from p = x
//
// A step takes away the part of an error that M keeps. M is an average with its largest weight at the point itself, so errors
// that alternate from point to point, which it smooths most, last longest. Positions and fields are corrected in the same way,
// each array for itself.
#include "subvol/refine_mixed.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "subvol/detail/mixed_levels.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

/// Levels are tables of weights, so a level needs its cells but neither positions nor fields.
MixedMesh cells_alone(const MixedMesh& mesh) {
    return {{}, mesh.tets, mesh.octahedra, mesh.prisms, mesh.pyramids, mesh.hexes, {}, {}};
}

std::vector<double> applied(const StencilTable& table, std::span<const double> in, std::size_t channels) {
    std::vector<double> out(table.rows() * channels);
    table.apply(in, channels, out);
    return out;
}

std::span<const double> numbers_of(const std::vector<Vec3>& points) {
    return {reinterpret_cast<const double*>(points.data()), 3 * points.size()};
}

std::vector<Vec3> points_of(const std::vector<double>& numbers) {
    std::vector<Vec3> points(numbers.size() / 3);
    if (!points.empty()) std::memcpy(points.data(), numbers.data(), numbers.size() * sizeof(double));
    return points;
}

}  // namespace

MixedLevel detail::level_of(const MixedMesh& mesh, TetScheme scheme, std::optional<double> crease_angle_deg) {
    validate(mesh);
    const std::size_t others = mesh.prisms.size() + mesh.pyramids.size() + mesh.hexes.size();
    if (scheme == TetScheme::Boxspline && others > 0) {
        throw Error(ErrorCode::InvalidInput,
                    "the box spline is defined on tetrahedra and octahedra; the mesh has " + std::to_string(others) +
                        " prisms, pyramids and hexahedra",
                    {}, "cut them into tetrahedra first");
    }
    MixedLevel level;
    level.points = mesh.points.size();
    level.cells = cells_alone(mesh);
    level.boundary = find_boundary(mesh, crease_angle_deg);
    return level;
}

std::vector<double> MixedTables::apply(std::span<const double> control, std::size_t channels) const {
    std::vector<double> values(control.begin(), control.end());
    for (const StencilTable& level : levels) values = applied(level, values, channels);
    return values;
}

MixedTables refinement_tables(const MixedMesh& mesh, const MixedRefineOptions& options) {
    detail::check_tet_levels(options.levels);
    MixedLevel level = level_of(mesh, options.scheme, options.crease_angle_deg);
    MixedTables result;
    result.control_points = mesh.points.size();
    for (int l = 0; l < options.levels; ++l) {
        report_progress(options.progress, "refine", static_cast<double>(l) / options.levels);
        // Only the first level sees positions (for creases by angle). All others follow from the cells, so the tables can be
        // applied to any positions and fields afterwards.
        const SplitNumbers numbers(level.cells, level.points);
        MixedStep step = refine_level(level, numbers, options.scheme);
        result.levels.push_back(std::move(step.table));
        level = std::move(step.child);
    }
    result.fine = std::move(level.cells);
    result.fine.creases = std::move(level.boundary.creases);
    return result;
}

MixedMesh refine(const MixedMesh& mesh, const MixedRefineOptions& options) {
    MixedTables tables = refinement_tables(mesh, options);
    MixedMesh fine = std::move(tables.fine);
    fine.points = points_of(tables.apply(numbers_of(mesh.points), 3));
    for (const Attribute& attribute : mesh.attributes) {
        fine.attributes.push_back(
            {attribute.name, attribute.channels, tables.apply(attribute.values, static_cast<std::size_t>(attribute.channels))});
    }
    return fine;
}

MixedMesh on_limit(MixedMesh mesh, TetScheme scheme) {
    if (scheme == TetScheme::Linear) return mesh;
    const StencilTable table = limit_table(mesh, scheme);
    mesh.points = points_of(applied(table, numbers_of(mesh.points), 3));
    for (Attribute& attribute : mesh.attributes) {
        attribute.values = applied(table, attribute.values, static_cast<std::size_t>(attribute.channels));
    }
    return mesh;
}

namespace {

/// values ← values + (given − limit), once. returns: the largest difference as a part of `range`
double correct(std::vector<double>& values, std::span<const double> given, const std::vector<double>& limit, double range) {
    double largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        // The step p ← p + (x − M p) for one number of the array.
        const double off = given[i] - limit[i];
        values[i] += off;
        largest = std::max(largest, std::abs(off));
    }
    return range > 0 ? largest / range : 0;
}

double range_of(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return values.empty() ? 0 : *high - *low;
}

}  // namespace

MixedInterpolation interpolate_vertices(const MixedMesh& given, TetScheme scheme, double tolerance, int most_steps) {
    MixedInterpolation result{given, 0, 0};
    if (scheme == TetScheme::Linear) return result;
    const StencilTable table = limit_table(given, scheme);
    struct Array {
        std::vector<double> values;
        std::span<const double> given;
        std::size_t channels;
        double range;
    };
    std::vector<Array> arrays;
    const auto add = [&](std::span<const double> numbers, std::size_t channels) {
        arrays.push_back({{numbers.begin(), numbers.end()}, numbers, channels, range_of(numbers)});
    };
    // Positions are an array like any field: M acts on every channel in the same way.
    add(numbers_of(given.points), 3);
    for (const Attribute& attribute : given.attributes) add(attribute.values, static_cast<std::size_t>(attribute.channels));
    while (result.steps < most_steps) {
        result.left = 0;
        for (Array& array : arrays) {
            const auto limit = applied(table, array.values, array.channels);
            result.left = std::max(result.left, correct(array.values, array.given, limit, array.range));
        }
        ++result.steps;
        if (result.left <= tolerance) break;
    }
    result.mesh.points = points_of(arrays.front().values);
    for (std::size_t a = 0; a < given.attributes.size(); ++a)
        result.mesh.attributes[a].values = std::move(arrays[a + 1].values);
    return result;
}

MixedVolume volume_through(const MixedMesh& given, const MixedRefineOptions& options, double tolerance, int most_steps) {
    MixedRefineOptions creases = options;
    creases.levels = 0;  // the control mesh with its creases, which the interpolation must know
    MixedInterpolation through = interpolate_vertices(refine(given, creases), options.scheme, tolerance, most_steps);
    return {on_limit(refine(through.mesh, options), options.scheme), through.left};
}

}  // namespace subvol
