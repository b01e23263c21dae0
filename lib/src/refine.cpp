#include "subvol/refine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "boundary_rings.h"
#include "bucket_sort.h"
#include "corner_parameters.h"
#include "schemes.h"
#include "subvol/error.h"

namespace subvol {

using detail::kCornerParameters;
using detail::parallel_each;
using detail::SchemeRules;
using detail::StencilBuilder;

namespace {

std::unique_ptr<SchemeRules> make_rules(const Topology& topology, const RefineOptions& options) {
    switch (options.scheme) {
        case Scheme::Linear:
            return detail::make_linear_rules(topology);
        case Scheme::Mcq:
            return detail::make_mcq_rules(topology, options.tension);
    }
    throw Error(ErrorCode::InvalidInput, "unknown subdivision scheme");
}

/// Where the points of the four kinds start in the child's numbering.
struct ChildNumbering {
    explicit ChildNumbering(const Topology& t)
        : edges(t.point_count), faces(edges + t.edges.size()), cells(faces + t.faces.size()), end(cells + t.cells.size()) {}
    std::size_t edges, faces, cells, end;
};

/// Calls visit(child point, row) for every new point, in parallel.
template <class Visit>
void for_each_stencil(const Topology& topology, const SchemeRules& rules, Progress* progress, const std::string& stage,
                      const Visit& visit) {
    const ChildNumbering first(topology);
    const auto run = [&](std::size_t count, const auto& rule) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 512), [&](const auto& range) {
            StencilBuilder row;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                row.clear();
                const std::size_t point = rule(static_cast<Index>(i), row);
                visit(point, row.finish());
            }
        });
    };
    report_progress(progress, stage, 0.2);
    run(topology.edges.size(), [&](Index e, auto& row) { return rules.edge_point(e, row), first.edges + e; });
    report_progress(progress, stage, 0.5);
    run(topology.faces.size(), [&](Index f, auto& row) { return rules.face_point(f, row), first.faces + f; });
    report_progress(progress, stage, 0.8);
    run(topology.cells.size(),
        [&](Index c, auto& row) { return rules.cell_point(c, row), first.cells + topology.cell_rank[c]; });
    report_progress(progress, stage, 1);
}

/// A place of the 3×3×3 lattice of a refined cell: a corner, or the number of one of its edges or faces, or the cell itself.
struct LatticePlace {
    enum Kind : std::uint8_t { Corner, Edge, Face, Cell } kind = Cell;
    std::uint8_t number = 0;
};

template <std::size_t N>
constexpr std::size_t lattice_offset(const std::array<int, N>& corners) {
    std::array<int, 3> sum{};
    for (const int c : corners) {
        for (std::size_t a = 0; a < 3; ++a) sum[a] += 2 * kCornerParameters[static_cast<std::size_t>(c)][a];
    }
    const int n = static_cast<int>(N);
    return static_cast<std::size_t>(sum[0] / n + 3 * (sum[1] / n) + 9 * (sum[2] / n));
}

constexpr std::array<LatticePlace, 27> make_lattice() {
    std::array<LatticePlace, 27> lattice{};
    for (std::uint8_t k = 0; k < 8; ++k) lattice[lattice_offset(std::array{static_cast<int>(k)})] = {LatticePlace::Corner, k};
    for (std::uint8_t k = 0; k < 12; ++k) lattice[lattice_offset(kCellEdges[k])] = {LatticePlace::Edge, k};
    for (std::uint8_t k = 0; k < 6; ++k) lattice[lattice_offset(kCellFaces[k])] = {LatticePlace::Face, k};
    return lattice;
}

constexpr auto kLattice = make_lattice();

std::vector<std::array<Index, 8>> child_cells(const Topology& topology) {
    const ChildNumbering first(topology);
    std::vector<std::array<Index, 8>> children(8 * topology.cells.size());
    parallel_each(topology.cells.size(), [&](std::size_t c) {
        std::array<Index, 27> points;
        for (std::size_t i = 0; i < 27; ++i) {
            const auto [kind, k] = kLattice[i];
            switch (kind) {
                case LatticePlace::Corner:
                    points[i] = topology.cells[c][k];
                    break;
                case LatticePlace::Edge:
                    points[i] = static_cast<Index>(first.edges + topology.cell_edges[c][k]);
                    break;
                case LatticePlace::Face:
                    points[i] = static_cast<Index>(first.faces + topology.cell_faces[c][k]);
                    break;
                case LatticePlace::Cell:
                    points[i] = static_cast<Index>(first.cells + topology.cell_rank[c]);
                    break;
            }
        }
        for (std::size_t child = 0; child < 8; ++child) {
            for (std::size_t k = 0; k < 8; ++k) {
                const auto& o = kCornerParameters[child];
                const auto& p = kCornerParameters[k];
                children[8 * c + child][k] =
                    points[static_cast<std::size_t>(o[0] + p[0] + 3 * (o[1] + p[1]) + 9 * (o[2] + p[2]))];
            }
        }
    });
    return children;
}

std::vector<std::array<Index, 2>> child_creases(const HexMesh& parent, const Topology& topology) {
    std::vector<std::array<Index, 2>> creases;
    for (const auto& [a, b] : parent.creases) {
        const auto middle = static_cast<Index>(topology.point_count + *topology.find_edge(a, b));
        creases.push_back({a, middle});
        creases.push_back({b, middle});
    }
    return creases;
}

HexMesh refine_once(const HexMesh& parent, const RefineOptions& options, int level) {
    const std::string stage = "refine to level " + std::to_string(level);
    report_progress(options.progress, stage, 0);
    const Topology topology = build_topology(parent);
    const auto rules = make_rules(topology, options);
    const std::size_t count = ChildNumbering(topology).end;
    if (count >= kNone) {
        throw Error(ErrorCode::InvalidInput, "level " + std::to_string(level) + " needs " + std::to_string(count) + " points",
                    {}, "at most 4294967294: use fewer levels");
    }

    HexMesh child;
    child.points.resize(count);
    std::copy(parent.points.begin(), parent.points.end(), child.points.begin());
    for (const auto& attribute : parent.attributes) {
        auto& values = child.attributes.emplace_back(Attribute{attribute.name, attribute.channels, {}}).values;
        values.resize(count * static_cast<std::size_t>(attribute.channels));
        std::copy(attribute.values.begin(), attribute.values.end(), values.begin());
    }
    for_each_stencil(topology, *rules, options.progress, stage, [&](std::size_t point, const auto& row) {
        Vec3 position(0.0);
        for (const auto& [p, w] : row) position += w * parent.points[p];
        child.points[point] = position;
        for (std::size_t a = 0; a < parent.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(parent.attributes[a].channels);
            const double* from = parent.attributes[a].values.data();
            double* to = child.attributes[a].values.data() + point * channels;
            for (const auto& [p, w] : row) {
                for (std::size_t c = 0; c < channels; ++c) to[c] += w * from[p * channels + c];
            }
        }
    });
    child.cells = child_cells(topology);
    child.creases = child_creases(parent, topology);
    return child;
}

Vec3 quad_normal(const HexMesh& mesh, const std::array<Index, 4>& q) {
    return glm::cross(mesh.points[q[2]] - mesh.points[q[0]], mesh.points[q[3]] - mesh.points[q[1]]);
}

/// Tags the smooth boundary edges whose two faces meet at more than `angle_deg`.
void tag_sharp_edges(HexMesh& mesh, double angle_deg) {
    if (!(angle_deg > 0 && angle_deg < 180)) {
        throw Error(ErrorCode::InvalidInput, "the crease angle is " + std::to_string(angle_deg), {},
                    "between 0 and 180 degrees");
    }
    const Topology topology = build_topology(mesh);
    const double limit = std::cos(angle_deg * std::numbers::pi / 180);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        const auto edge = static_cast<Index>(e);
        if (!topology.edge_on_boundary[e] || topology.edge_is_crease[e]) continue;
        const auto [f0, f1] = detail::boundary_faces_of(topology, edge);
        const auto [a, b] = topology.edges[e];
        // Both quads are run through from a to b for one and from b to a for the other: their normals then agree on a plane.
        const auto normal = [&](Index face, Index from, Index to) {
            const auto& q = topology.faces[face];
            const std::size_t k = detail::slot_of(q, from);
            const Vec3 n = quad_normal(mesh, q);
            return q[(k + 1) % 4] == to ? n : -n;
        };
        const Vec3 n0 = normal(f0, a, b), n1 = normal(f1, b, a);
        if (glm::dot(n0, n1) < limit * glm::length(n0) * glm::length(n1)) mesh.creases.push_back({a, b});
    }
}

}  // namespace

HexMesh refine(const HexMesh& mesh, const RefineOptions& options) {
    if (options.levels < 0 || options.levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(options.levels), {}, "0 to 10");
    }
    validate(mesh);
    HexMesh current = without_unused_points(mesh);
    if (options.crease_angle_deg && options.levels > 0) tag_sharp_edges(current, *options.crease_angle_deg);
    for (int level = 1; level <= options.levels; ++level) current = refine_once(current, options, level);
    return current;
}

std::vector<StencilRow> stencils(const Topology& topology, const RefineOptions& options) {
    const auto rules = make_rules(topology, options);
    std::vector<StencilRow> rows(ChildNumbering(topology).end - topology.point_count);
    for_each_stencil(topology, *rules, options.progress, "stencils",
                     [&](std::size_t point, const auto& row) { rows[point - topology.point_count] = row; });
    return rows;
}

}  // namespace subvol
