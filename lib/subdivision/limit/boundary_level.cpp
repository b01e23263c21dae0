// SPDX-License-Identifier: Apache-2.0
// The boundary of a refined mesh without the refined mesh. The rules of all schemes make the points of the boundary from points
// of the boundary alone. So it is enough to keep, at each level, the cells that have a point on the hull: they contain every
// entity that a rule of the boundary looks at.
//
// Cutting off the other cells exposes new faces. None of them has a point on the hull, as every cell at such a point is kept;
// so one point of a face decides whether it belongs to the hull of the whole mesh or was exposed.
#include "subvol/detail/boundary_level.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "subvol/boundary_values.h"
#include "subvol/detail/all_cells.h"
#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/detail/surface_builder.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

using HullFlags = std::vector<std::uint8_t>;  // for each point: whether it is on the hull

HullFlags points_of(std::span<const std::array<Index, 4>> quads, std::size_t points) {
    HullFlags flags(points, 0);
    for (const auto& quad : quads) {
        for (const Index p : quad) flags[p] = 1;
    }
    return flags;
}

HullFlags hull_points(const HexMesh& mesh) {
    return points_of(hull_quads(mesh), mesh.points.size());
}

/// Whether a face of these cells may be one of the hull.
struct OnHull {
    std::span<const std::uint8_t> flags;
    bool operator()(const std::array<Index, 4>& face) const {
        return std::ranges::all_of(face, [&](Index p) { return flags[p] != 0; });
    }
};

/// The cells that have a point on the boundary, and the flags of their points. They are a mesh of their own: creases and sharp
/// faces come along, unused points are left out, and the order of cells and points stays.
struct HullCells {
    HexMesh mesh;
    HullFlags on_hull;

    HullCells(const HexMesh& whole, std::span<const std::uint8_t> flags, bool with_attributes = false) {
        const auto at_hull = [&](const auto& entity) { return std::ranges::any_of(entity, [&](Index p) { return flags[p]; }); };
        std::ranges::copy_if(whole.cells, std::back_inserter(mesh.cells), at_hull);
        std::ranges::copy_if(whole.creases, std::back_inserter(mesh.creases), at_hull);
        std::ranges::copy_if(whole.sharp_faces, std::back_inserter(mesh.sharp_faces), at_hull);
        std::vector<std::uint8_t> used(flags.size(), 0);
        for (const auto& cell : mesh.cells) {
            for (const Index p : cell) used[p] = 1;
        }
        for (std::size_t p = 0; p < used.size(); ++p) {
            if (used[p]) on_hull.push_back(flags[p]);
        }
        mesh.points = whole.points;
        if (with_attributes) mesh.attributes = whole.attributes;
        std::vector<Index> kept;
        for (Attribute& field : mesh.attributes) {
            if (!is_at_cells(whole, field)) field.cells.clear();
            if (kept.empty() && !field.cells.empty()) {
                for (Index c = 0; c < whole.cells.size(); ++c) {
                    if (at_hull(whole.cells[c])) kept.push_back(c);
                }
            }
            field.cells = of_cells(field.cells, field.channels, kept);
        }
        mesh = without_unused_points(std::move(mesh));
    }
};

/// Calls visit(face) for the faces of the whole mesh's hull.
template <class Visit>
void each_hull_face(const Topology& topology, std::span<const std::uint8_t> on_hull, const Visit& visit) {
    for (Index f = 0; f < topology.faces.size(); ++f) {
        const auto face = f;
        if (topology.face_on_hull(face) && on_hull[topology.faces[f][0]]) visit(face);
    }
}

/// The points of the next level that lie on the boundary: those of its faces, edges and points. The numbering says which they
/// are, so that no face of the child has to be looked for.
HullFlags hull_points_of_child(const Topology& parent, const HullFlags& on_hull) {
    // Points keep their numbers; the points of edges, faces and cells follow in blocks.
    const ChildNumbering first(parent);
    HullFlags child(first.end, 0);
    each_hull_face(parent, on_hull, [&](Index face) {
        child[first.faces + face] = 1;
        for (const Index p : parent.faces[face]) child[p] = 1;
        for (const Index e : parent.face_edges[face]) child[first.edges + e] = 1;
    });
    return child;
}

Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const HullFlags& on_hull,
                          const SchemeOptions& scheme) {
    const SchemeRows rows(topology, scheme, SchemeRows::Columns::WithSums);
    const RowInput input(rows, mesh);
    const ChildNumbering first(topology);
    SurfaceBuilder builder(first.cells);  // no cell point is on the boundary
    each_hull_face(topology, on_hull, [&](Index face) {
        const auto& corners = topology.faces[face];
        const auto quad = outward_quad(topology, topology.face_cells[face][0], face);
        const auto center = static_cast<Index>(first.faces + face);
        const auto edge_point = [&](std::size_t k) {  // between corners k and k + 1
            const std::size_t a = slot_of(corners, quad[k]), b = slot_of(corners, quad[(k + 1) % 4]);
            return static_cast<Index>(first.edges + topology.face_edges[face][(a + 1) % 4 == b ? a : b]);
        };
        for (std::size_t k = 0; k < 4; ++k) builder.add({quad[k], edge_point(k), center, edge_point((k + 3) % 4)});
    });
    tbb::enumerable_thread_specific<StencilBuilder> scratch;
    return builder.finish([&](Index p) {
        if (p < rows.kept()) return mesh.points[p];
        StencilBuilder& row = scratch.local();
        row.clear();
        rows.write_row(p, row);
        // Points of equal weight are added before they are multiplied, as where tables of stencils are applied.
        const StencilRuns stencil = row.finish();
        Vec3 position(0.0);
        std::size_t next = 0;
        for (const auto& [weight, count] : stencil.runs) {
            Vec3 sum(0.0);
            for (std::uint32_t i = 0; i < count; ++i) {
                const double* const x = input.points() + 3 * std::size_t{stencil.points[next++]};
                sum += Vec3(x[0], x[1], x[2]);
            }
            position += weight * sum;
        }
        return position;
    });
}

}  // namespace

Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const SchemeOptions& scheme) {
    return boundary_of_child(mesh, topology, HullFlags(mesh.points.size(), 1), scheme);
}

Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull, const SchemeOptions& scheme) {
    const HullCells near(mesh, on_hull);
    return boundary_of_child(near.mesh, build_topology(near.mesh), near.on_hull, scheme);
}

void each_part_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull, const SchemeOptions& scheme,
                        const std::function<void(const Surface&)>& visit) {
    constexpr std::size_t kCells = 250'000, kMostParts = 16;
    const std::size_t parts = std::clamp<std::size_t>(mesh.cells.size() / kCells, 1, kMostParts), points = mesh.points.size();
    for (std::size_t part = 0; part < parts; ++part) {
        // A face belongs to the part of its first point. The rules of its points look at the cells at its four corners.
        const std::size_t begin = points * part / parts, end = points * (part + 1) / parts;
        const auto quads = hull_quads(mesh, [&](const std::array<Index, 4>& face) {
            return begin <= face[0] && face[0] < end && (on_hull.empty() || OnHull{on_hull}(face));
        });
        if (quads.empty()) continue;
        const HullFlags corners = points_of(quads, points);
        std::vector<std::uint8_t> near(mesh.cells.size(), 0);
        parallel_each(near.size(), [&](std::size_t c) {
            near[c] = std::ranges::any_of(mesh.cells[c], [&](Index p) { return corners[p] != 0; });
        });
        MeshSubset some = subset(mesh, near);
        HullFlags own(some.points.size(), 0);
        for (const auto& quad : quads)
            own[static_cast<std::size_t>(std::ranges::lower_bound(some.points, quad[0]) - some.points.begin())] = 1;
        visit(boundary_of_child(some.mesh, build_topology(some.mesh, InteriorCreases::Ignore), own, scheme));
    }
}

HexMesh hull_before_limit(HexMesh mesh, const RefineOptions& options, std::vector<std::uint8_t>& on_hull) {
    if (on_hull.empty()) on_hull = hull_points(mesh);
    RefineOptions once = options;
    once.levels = 1;
    for (int level = 0; level < options.levels; ++level) {
        HullCells near(mesh, on_hull, true);
        Topology topology = build_topology(near.mesh);
        on_hull = hull_points_of_child(topology, near.on_hull);
        // Fields are refined with the points, since the cut mesh keeps the attributes.
        const HexMesh at_cells = take_cell_fields(near.mesh);
        RefinedPoints child = refine_points(std::move(near.mesh), std::move(topology), once);
        mesh = std::move(child.mesh);
        mesh.cells = child_cells(child.parent);
        if (!at_cells.cells.empty()) inherit_cells(at_cells, all_cells(at_cells), 1, mesh);
    }
    HullCells last(mesh, on_hull, true);
    on_hull = std::move(last.on_hull);
    return std::move(last.mesh);
}

namespace {

/// Refines the cells at the boundary, with their attributes. on_hull: of the mesh's points; becomes that of the last level's
HexMesh hull_at_level(HexMesh mesh, const RefineOptions& options, HullFlags& on_hull) {
    return on_limit(hull_before_limit(std::move(mesh), options, on_hull), options.scheme.kind);
}

}  // namespace

Surface boundary_at_level(HexMesh mesh, const RefineOptions& options) {
    HullFlags on_hull = hull_points(mesh);
    return boundary_at_level(std::move(mesh), std::move(on_hull), options);
}

Surface boundary_at_level(HexMesh mesh, std::vector<std::uint8_t> on_hull, const RefineOptions& options) {
    mesh.attributes.clear();
    mesh = hull_at_level(std::move(mesh), options, on_hull);
    return boundary_surface_where(mesh, OnHull{on_hull});
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

/// A mesh in which each point is where its number is on the first axis. Functions that extract a surface return positions only.
/// Run on this mesh, their "positions" tell which points they chose, so that any number of channels can be gathered afterwards.
/// Doubles hold these numbers exactly.
HexMesh numbered(HexMesh mesh) {
    for (std::size_t p = 0; p < mesh.points.size(); ++p) mesh.points[p] = Vec3(static_cast<double>(p), 0, 0);
    mesh.attributes.clear();
    return mesh;
}

std::vector<Index> numbers_in(std::span<const Vec3> points) {
    std::vector<Index> numbers;
    for (const Vec3& p : points) numbers.push_back(static_cast<Index>(p.x));
    return numbers;
}

}  // namespace

BoundaryValues boundary_values(HexMesh mesh, const RefineOptions& options) {
    validate(mesh);
    mesh = without_unused_points(std::move(mesh));
    HullFlags on_hull = hull_points(mesh);
    return boundary_values(MeshHull{std::move(mesh), std::move(on_hull)}, options);
}

BoundaryValues boundary_values(MeshHull hull, const RefineOptions& options) {
    check_levels(options.levels);
    auto& [mesh, on_hull] = hull;
    for (const Attribute& field : mesh.attributes) {
        if (field.channels != 1) throw Error(ErrorCode::InvalidInput, "has more than one component", "field " + field.name);
    }
    mesh = control_mesh(std::move(mesh), options.scheme);
    mesh = hull_at_level(std::move(mesh), options, on_hull);
    BoundaryValues boundary;
    // The points of the mesh that the surface uses, in its order: a surface in which numbers stand for the positions.
    const std::vector<Vec3> points = std::move(mesh.points);
    std::vector<Attribute> fields = std::move(mesh.attributes);
    mesh.points.resize(points.size());
    Surface names = boundary_surface_where(numbered(std::move(mesh)), OnHull{on_hull});
    boundary.surface.triangles = std::move(names.triangles);
    const std::vector<Index> used = numbers_in(names.points);
    for (const Index p : used) boundary.surface.points.push_back(points[p]);
    for (const Attribute& field : fields) {
        std::vector<double>& of_field = boundary.values.emplace_back();
        const double low = field.bounds.empty() ? -HUGE_VAL : field.bounds[0][0],
                     high = field.bounds.empty() ? HUGE_VAL : field.bounds[0][1];
        for (const Index p : used) of_field.push_back(std::min(std::max(field.values[p], low), high));
    }
    return boundary;
}

/// The points of the level that are kept, as numbers of the level before it, and the table of their refinement.
struct BoundaryTables::State {
    struct Level {
        std::vector<Index> kept;
        StencilTable table;
    };
    std::vector<Index> used;  // the points of the control mesh that cells use
    std::size_t control_points = 0;
    std::vector<Level> levels;
    std::optional<StencilTable> limit;
    std::vector<Index> on_surface;  // the points of the last level that the surface uses
    std::vector<std::array<Index, 3>> triangles;

    /// A field of one channel, from the control mesh to the surface.
    [[nodiscard]] std::vector<double> to_surface(const Attribute& field) const {
        const bool plain = field.function == nullptr;
        const std::vector<double> refined =
            to_surface(plain ? field.values : field.arguments, plain ? 1 : field.function->arguments);
        std::vector<double> memory;
        const std::span<const double> values = values_at_places(field, refined, memory);
        return {values.begin(), values.end()};
    }

    /// Some channels, from the control mesh to the surface.
    [[nodiscard]] std::vector<double> to_surface(std::span<const double> control, std::size_t channels) const {
        std::vector<double> values = gathered(control, used, channels);
        for (const Level& level : levels) {
            // The table of a level goes from the points that were kept before it, so these are picked out first.
            const std::vector<double> kept = gathered(values, level.kept, channels);
            values.assign(level.table.rows() * channels, 0);
            level.table.apply(kept, channels, values);
        }
        if (limit) {
            std::vector<double> moved(limit->rows() * channels);
            limit->apply(values, channels, moved);
            values = std::move(moved);
        }
        return gathered(values, on_surface, channels);
    }

    [[nodiscard]] static std::vector<double> gathered(std::span<const double> from, std::span<const Index> points,
                                                      std::size_t channels) {
        std::vector<double> values;
        values.reserve(points.size() * channels);
        for (const Index p : points) {
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(p * channels);
            values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(channels));
        }
        return values;
    }
};

BoundaryTables::BoundaryTables(const HexMesh& whole, const RefineOptions& options) : state_(std::make_unique<State>()) {
    check_levels(options.levels);
    HexMesh mesh = control_mesh(whole, options.scheme);  // creases by angle are those of this shape
    state_->control_points = whole.points.size();
    HexMesh names = numbered(whole);
    for (const Vec3& p : without_unused_points(std::move(names)).points) state_->used.push_back(static_cast<Index>(p.x));
    RefineOptions once = options;
    once.levels = 1;
    HullFlags on_hull = hull_points(mesh);
    for (int level = 0; level < options.levels; ++level) {
        const HullCells near(numbered(std::move(mesh)), on_hull);
        const Topology topology = build_topology(near.mesh);
        RefinementTables tables = refinement_tables(topology, once);
        on_hull = hull_points_of_child(topology, near.on_hull);
        state_->levels.push_back({numbers_in(near.mesh.points), std::move(tables.levels.front())});
        mesh = {};
        mesh.points.resize(state_->levels.back().table.rows());
        mesh.cells = std::move(tables.cells);
        mesh.creases = std::move(tables.creases);
        mesh.sharp_faces = std::move(tables.sharp_faces);
    }
    // Vertices of interpolating schemes lie on the limit already.
    if (!interpolates(options.scheme.kind)) state_->limit = limit_stencils(build_topology(mesh), options.scheme.kind);
    const Surface surface = boundary_surface_where(numbered(std::move(mesh)), OnHull{on_hull});
    state_->on_surface = numbers_in(surface.points);
    state_->triangles = surface.triangles;
}

BoundaryTables::~BoundaryTables() = default;
BoundaryTables::BoundaryTables(BoundaryTables&&) noexcept = default;
BoundaryTables& BoundaryTables::operator=(BoundaryTables&&) noexcept = default;

BoundaryValues BoundaryTables::apply(const HexMesh& mesh) const {
    if (mesh.points.size() != state_->control_points) {
        throw Error(ErrorCode::InvalidInput, "the mesh has another number of points than that of the tables");
    }
    const std::span places(&mesh.points.front().x, 3 * mesh.points.size());
    const std::vector<double> moved = state_->to_surface(places, 3);
    BoundaryValues boundary;
    boundary.surface.triangles = state_->triangles;
    for (std::size_t p = 0; p < moved.size(); p += 3)
        boundary.surface.points.emplace_back(moved[p], moved[p + 1], moved[p + 2]);
    for (const Attribute& field : mesh.attributes) {
        if (field.channels != 1) throw Error(ErrorCode::InvalidInput, "has more than one component", "field " + field.name);
        boundary.values.push_back(state_->to_surface(field));
    }
    return boundary;
}

int detail::sensible_levels(std::size_t triangles, int levels) {
    constexpr std::size_t kMostTriangles = 8'000'000;
    // Each level makes four triangles of one.
    while (levels > 0 && triangles > kMostTriangles >> (2 * levels)) --levels;
    return levels;
}

namespace {

int picture_levels(std::size_t triangles) {
    constexpr std::size_t kManyTriangles = 8000;
    return sensible_levels(triangles, triangles > kManyTriangles ? 1 : 2);
}

}  // namespace

int picture_levels(const HexMesh& mesh, std::optional<int> most) {
    if (most) return std::min(2, *most);
    const std::size_t triangles = boundary_surface(mesh).triangles.size();
    if (std::ranges::none_of(mesh.attributes, &Attribute::constant)) return picture_levels(triangles);
    // Colours mix where cells meet, within a cell of the last level.
    constexpr std::size_t kMostTriangles = 1'000'000;
    constexpr int kMostLevels = 4;
    int levels = picture_levels(triangles);
    while (levels < kMostLevels && triangles <= kMostTriangles >> (2 * (levels + 1))) ++levels;
    return levels;
}

int picture_levels(const MeshHull& hull, std::optional<int> most) {
    return most ? std::min(2, *most) : picture_levels(2 * hull_quads(hull.mesh, OnHull{hull.on_hull}).size());
}

}  // namespace subvol
