// SPDX-License-Identifier: Apache-2.0
// The approximating schemes on extruded quad meshes: in section they are surface schemes, which are implemented here again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "lib/test_meshes.h"
#include "subvol/refine.h"

namespace subvol {
namespace extrusion_test {

constexpr double kRounding = 1e-13;  // a few hundred double operations on coordinates of size one

using test::mean;
using test::mean_at;

/// `valence` sectors of 2×2 quads about point 0, all points in z = 0.
struct Section {
    std::vector<Vec3> points;
    std::vector<std::array<Index, 4>> quads;
};

Section make_fan(int valence) {
    Section section;
    std::map<std::pair<long, long>, Index> ids;
    const auto spoke = [&](int s) {
        const double angle = 2 * std::numbers::pi * s / valence;
        return Vec3(std::cos(angle), std::sin(angle), 0);
    };
    for (int s = 0; s < valence; ++s) {
        const auto at = [&](int i, int j) {
            const Vec3 x = double(i) * spoke(s) + double(j) * spoke((s + 1) % valence);
            const std::pair key{std::lround(x.x * 1e6), std::lround(x.y * 1e6)};
            const auto [found, is_new] = ids.try_emplace(key, static_cast<Index>(section.points.size()));
            if (is_new) section.points.push_back(x + Vec3(.1 * std::sin(3 * x.y + x.x), .1 * std::cos(2 * x.x), 0));
            return found->second;
        };
        for (int k = 0; k < 4; ++k) {
            const int i = k % 2, j = k / 2;
            section.quads.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return section;
}

using Entity = std::set<Index>;  // the ids of a section's point, edge or quad

/// Where a surface scheme puts the points of a section's points, edges and quads. Interior points by
/// `vertex(V, edge middles, face means)`; the rim is a cubic spline, its corners (points of one quad) are fixed.
template <class Vertex>
std::map<Entity, Vec3> refine_section(const Section& section, const Vertex& vertex) {
    const auto& x = section.points;
    std::map<Entity, Vec3> fine;
    std::map<Entity, std::vector<Vec3>> face_means;  // about points and edges
    std::map<Index, std::set<Index>> neighbours;
    for (const auto& q : section.quads) {
        const Vec3 middle = mean_at(x, q);
        fine[Entity(q.begin(), q.end())] = middle;
        for (std::size_t k = 0; k < 4; ++k) {
            const Index a = q[k], b = q[(k + 1) % 4];
            face_means[{a}].push_back(middle);
            face_means[{a, b}].push_back(middle);
            neighbours[a].insert(b);
            neighbours[b].insert(a);
        }
    }
    const auto on_rim = [&](Index a, Index b) { return face_means.at({a, b}).size() == 1; };
    for (Index a = 0; a < x.size(); ++a) {
        std::vector<Vec3> middles, rim;
        for (const Index b : neighbours[a]) {
            const auto& faces = face_means.at({a, b});
            middles.push_back((x[a] + x[b]) / 2.0);
            if (on_rim(a, b)) rim.push_back(x[b]);
            fine[{a, b}] = on_rim(a, b) ? middles.back() : (middles.back() + mean(faces)) / 2.0;
        }
        const auto& faces = face_means.at({a});
        if (rim.empty()) {
            fine[{a}] = vertex(x[a], middles, faces);
        } else {
            fine[{a}] = faces.size() == 1 ? x[a] : .75 * x[a] + .25 * mean(rim);
        }
    }
    return fine;
}

/// The points of the parent on whose vertex, edge, face or cell each child point sits, in the numbering of `refine`.
std::vector<std::vector<Index>> parents_of(const Topology& topology) {
    std::vector<std::vector<Index>> parents;
    for (Index p = 0; p < topology.point_count; ++p) parents.push_back({p});
    for (const auto& edge : topology.edges) parents.emplace_back(edge.begin(), edge.end());
    for (const auto& face : topology.faces) parents.emplace_back(face.begin(), face.end());
    const std::size_t cells = parents.size();
    parents.resize(cells + topology.cells.size());
    for (std::size_t c = 0; c < topology.cells.size(); ++c) {
        parents[cells + topology.cell_ordinal[c]].assign(topology.cells[c].begin(), topology.cells[c].end());
    }
    return parents;
}

HexMesh extrude(const Section& section, Index layers) {
    const auto count = static_cast<Index>(section.points.size());
    HexMesh mesh;
    for (Index z = 0; z <= layers; ++z) {
        for (const auto& p : section.points) mesh.points.push_back(p + Vec3(0, 0, z));
    }
    for (Index z = 0; z < layers; ++z) {
        for (const auto& q : section.quads) {
            std::array<Index, 8> cell;
            for (std::size_t k = 0; k < 4; ++k) {
                cell[k] = q[k] + z * count;
                cell[k + 4] = cell[k] + count;
            }
            mesh.cells.push_back(cell);
        }
    }
    return mesh;
}

/// Every child point lies over the point of its section, at the mean height of its parents, except those that `exempt` selects.
template <class Exempt>
void expect_extrusion(const Section& section, Scheme scheme, const std::map<Entity, Vec3>& expected, const Exempt& exempt) {
    const HexMesh mesh = extrude(section, 3), fine = refine(mesh, {.scheme = {scheme}});
    const auto parents = parents_of(build_topology(mesh));
    for (std::size_t p = 0; p < fine.points.size(); ++p) {
        Entity entity;
        for (const Index parent : parents[p]) entity.insert(parent % static_cast<Index>(section.points.size()));
        const double height = mean_at(mesh.points, parents[p]).z;
        if (exempt(entity, height)) continue;
        EXPECT_LT(glm::distance(fine.points[p], expected.at(entity) + Vec3(0, 0, height)), kRounding) << p;
    }
}

TEST(CatmullClark, OfAnExtrusionIsTheSurfaceSchemeInSection) {
    for (const int valence : {3, 4, 5, 6, 7}) {
        const Section section = make_fan(valence);
        const auto rule = [](const Vec3& v, const auto& middles, const auto& faces) {
            const auto n = static_cast<double>(faces.size());
            return (mean(faces) + 2.0 * mean(middles) + (n - 3) * v) / n;
        };
        // The vertex rule of MacCracken and Joy does not depend on the valence: on the line over an irregular point it differs.
        const auto on_irregular_line = [&](const Entity& entity, double height) {
            return valence != 4 && entity == Entity{0} && (height == 1 || height == 2);
        };
        expect_extrusion(section, Scheme::CatmullClark, refine_section(section, rule), on_irregular_line);
    }
}

TEST(CatmullClark, VertexRuleOnAnExtrudedIrregularLine) {
    for (const int valence : {3, 5, 6}) {
        const Section section = make_fan(valence);
        // Of 2n cells, n faces lie across the line and 2n along it; n edges lie across and 2 along.
        const auto rule = [](const Vec3& v, const auto& middles, const auto& faces) {
            const auto n = static_cast<double>(faces.size());
            const Vec3 f = mean(faces), m = mean(middles);
            return (f + (f + 2.0 * m) + 3.0 * (n * m + 2.0 * v) / (n + 2) + v) / 8.0;
        };
        const auto elsewhere = [](const Entity& entity, double height) {
            return entity != Entity{0} || (height != 1 && height != 2);
        };
        expect_extrusion(section, Scheme::CatmullClark, refine_section(section, rule), elsewhere);
    }
}

TEST(Bsxw, OfAnExtrusionIsTheSurfaceAverageInSection) {
    for (const int valence : {3, 4, 5, 6, 7}) {
        const Section section = make_fan(valence);
        // The mean of the small quads' centroids (V + 2M + F)/4.
        const auto rule = [](const Vec3& v, const auto& middles, const auto& faces) {
            return (v + 2.0 * mean(middles) + mean(faces)) / 4.0;
        };
        expect_extrusion(section, Scheme::Bsxw, refine_section(section, rule), [](const Entity&, double) { return false; });
    }
}

}  // namespace extrusion_test
}  // namespace subvol
