// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_shells.h"

#include "subvol/detail/incident.h"
#include "subvol/detail/shell_levels.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

using detail::PointKind;
using detail::ShellTopology;
using Terms = std::vector<std::pair<Index, double>>;

/// The limit of a point as weights over its surroundings.
Terms limit_of(const ShellTopology& shell, Index point, Scheme scheme) {
    const Topology& t = shell.topology;
    if (shell.kinds[point] == PointKind::Crease) {
        const auto [a, b] = detail::crease_neighbours(t, point);
        return {{point, 4. / 6}, {a, 1. / 6}, {b, 1. / 6}};
    }
    if (shell.kinds[point] != PointKind::Smooth) return {{point, 1}};
    const auto n = static_cast<double>(t.point_edges[point].size());
    const double itself = scheme == Scheme::CatmullClark ? n / (n + 5) : 4. / 9;
    const double edges = scheme == Scheme::CatmullClark ? 4 / (n + 5) : 4. / 9;
    const double faces = scheme == Scheme::CatmullClark ? 1 / (n + 5) : 1. / 9;
    Terms terms{{point, itself}};
    for (const Index e : t.point_edges[point]) terms.emplace_back(detail::other_end(t, e, point), edges / n);
    detail::each_face_at(t, point, [&](Index f, std::size_t k) { terms.emplace_back(t.faces[f][(k + 2) % 4], faces / n); });
    return terms;
}

/// One channel, or three, of all points moved to the limit.
///
/// of_solid: the same of the limit of the cells
std::vector<double> moved(const detail::ShellLevel& level, const std::vector<Terms>& terms, std::span<const double> values,
                          std::span<const double> of_solid, std::size_t channels) {
    std::vector<double> result(values.size(), 0.0);
    for (std::size_t p = 0; p < terms.size(); ++p) {
        for (std::size_t c = 0; c < channels; ++c) {
            double& value = result[p * channels + c];
            if (level.at[p] != kNone) {
                value = of_solid[level.at[p] * channels + c];
            } else {
                for (const auto& [q, weight] : terms[p]) value += weight * values[q * channels + c];
            }
        }
    }
    return result;
}

}  // namespace

Shells limit_shells(const HexMesh& mesh, const Shells& shells, const RefineOptions& options) {
    detail::ShellLevel level = detail::refine_shell_level(mesh, shells, options);
    const Scheme scheme = options.scheme.kind;
    if (interpolates(scheme) || level.shells.points.empty()) return std::move(level.shells);
    const detail::ShellComplex complex = detail::complex_of(level);
    std::vector<Terms> terms(level.shells.points.size());
    for (Index p = 0; p < terms.size(); ++p) {
        const bool in_quads = !complex.quads.topology.point_edges[p].empty();
        terms[p] = limit_of(in_quads ? complex.quads : complex.lines, p, scheme);
    }
    // The cells about the shells are cut off at some distance: creases there need not be on their boundary.
    HexMesh& solid = level.solid;
    StencilTable table;
    if (!solid.cells.empty()) {
        table = limit_stencils(detail::build_topology(solid, detail::InteriorCreases::Ignore), scheme);
    }
    const auto limit_of_solid = [&](std::span<const double> values, std::size_t channels) {
        std::vector<double> limit(values.size());
        if (!values.empty()) table.apply(values, channels, std::span<double>(limit));
        return limit;
    };
    const auto numbers = [](const std::vector<Vec3>& points) {
        std::vector<double> values;
        values.reserve(3 * points.size());
        for (const Vec3& p : points) values.insert(values.end(), {p.x, p.y, p.z});
        return values;
    };
    const auto places = moved(level, terms, numbers(level.shells.points), limit_of_solid(numbers(solid.points), 3), 3);
    for (std::size_t p = 0; p < terms.size(); ++p) {
        level.shells.points[p] = {places[3 * p], places[3 * p + 1], places[3 * p + 2]};
    }
    for (std::size_t a = 0; a < level.shells.attributes.size(); ++a) {
        Attribute& attribute = level.shells.attributes[a];
        const auto channels = static_cast<std::size_t>(attribute.channels);
        std::vector<double> none;
        const std::vector<double>& of_solid = solid.cells.empty() ? none : solid.attributes[a].values;
        attribute.values = moved(level, terms, attribute.values, limit_of_solid(of_solid, channels), channels);
    }
    return std::move(level.shells);
}

}  // namespace subvol
