// SPDX-License-Identifier: Apache-2.0
// Rows of the operators in fit_means.cpp, from the straight cells of a mesh. Lines of the mesh run from edge to edge: in a cell
// at p the edge e has two companions, whose face leads to the next cell; the edge of that cell at p that is not on the face
// goes on in e's direction.
//
//             e'
//             |   next cell         where all cells around e lead to one edge e', p is inside a line e - p - e';
//       ------p------ face          where they lead to none, the line ends at p;
//             |   cell              where they lead to several, p is irregular, as on an axis with five cells around it.
//             e
#include "mean_stencils.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

/// Rows of terms, computed in parallel and stored in order: row(i, sink) calls sink(term) for each term.
template <class Term, class Row>
Rows<Term> rows_of_terms(std::size_t count, const Row& row) {
    constexpr std::size_t kBlock = 1024;
    std::vector<std::vector<Term>> blocks((count + kBlock - 1) / kBlock);
    Rows<Term> rows;
    rows.offsets.assign(count + 1, 0);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        for (std::size_t i = b * kBlock; i < std::min(count, (b + 1) * kBlock); ++i) {
            row(i, [&](const Term& term) { blocks[b].push_back(term); });
            rows.offsets[i + 1] = blocks[b].size();
        }
    });
    std::size_t before = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0 && i % kBlock == 0) before = rows.offsets[i];
        rows.offsets[i + 1] += before;
    }
    rows.values.resize(rows.offsets.back());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        std::ranges::copy(blocks[b], rows.values.begin() + static_cast<std::ptrdiff_t>(rows.offsets[b * kBlock]));
        blocks[b] = {};
    });
    return rows;
}

std::size_t corner_of(const std::array<Index, 8>& cell, Index point) {
    return static_cast<std::size_t>(std::ranges::find(cell, point) - cell.begin());
}

std::size_t axis_of_edge(std::size_t corner, std::size_t other) {
    for (std::size_t a = 0; a < 3; ++a) {
        if (kCornerParameters[corner][a] != kCornerParameters[other][a]) return a;
    }
    return 0;
}

/// The side of the cell that has this corner and is perpendicular to an axis.
std::size_t side_at(std::size_t corner, std::size_t axis) {
    return 2 * axis + static_cast<std::size_t>(kCornerParameters[corner][axis]);
}

Vec3 product(const Mat3& m, const Vec3& v) {
    return m * v;
}

/// Makes the rows. The cells that one goes through are those of the mesh; sharp faces end lines as the boundary does.
class StencilMaker {
public:
    StencilMaker(const HexMesh& mesh, const Topology& topology, MeanStencils& stencils)
        : mesh_(mesh), topology_(topology), stencils_(stencils), at_points_(lists_at_points(mesh.cells, mesh.points.size())) {}

    void integrate_cells() {
        const std::size_t count = mesh_.cells.size();
        stencils_.corners.resize(count);
        cell_volumes_.resize(count);
        std::vector<Vec3> moments(count);
        parallel_each(count, [&](std::size_t c) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = mesh_.points[mesh_.cells[c][k]];
            const CellIntegrals integrals = integrate(x);
            stencils_.corners[c] = integrals.corners;
            cell_volumes_[c] = integrals.volume;
            moments[c] = integrals.moment;
        });
        const Wholes& wholes = stencils_.wholes;
        stencils_.volumes.resize(wholes.size());
        stencils_.centres.resize(wholes.size());
        parallel_each(wholes.size(), [&](std::size_t w) {
            double volume = 0;
            Vec3 moment(0.0);
            for (const Index c : wholes.cells_of(w)) {
                volume += cell_volumes_[c];
                moment += moments[c];
            }
            stencils_.volumes[w] = volume;
            stencils_.centres[w] = moment / volume;
        });
    }

    // g = N⁻¹ Σ d (m_n − m) / |d|², N = Σ d dᵀ / |d|², with a little added for directions without neighbours.
    void make_slopes() {
        const auto each_neighbour = [&](std::size_t w, const auto& visit) {
            for (const Index c : stencils_.wholes.cells_of(w)) {
                for (std::size_t side = 0; side < 6; ++side) {
                    const Index other = beyond(c, side);
                    if (other == kNone || stencils_.wholes.of_cell[other] == w) continue;
                    const std::size_t n = stencils_.wholes.of_cell[other];
                    visit(n, stencils_.centres[n] - stencils_.centres[w]);
                }
            }
        };
        stencils_.slopes = rows_of_terms<MeanTerm<Vec3>>(stencils_.wholes.size(), [&](std::size_t w, const auto& sink) {
            Mat3 normal(0.0);
            each_neighbour(
                w, [&](std::size_t, const Vec3& d) { normal += glm::outerProduct(d, d) / std::max(glm::dot(d, d), 1e-300); });
            const double few = 1e-6 * (normal[0][0] + normal[1][1] + normal[2][2]) + 1e-300;
            for (int a = 0; a < 3; ++a) normal[a][a] += few;
            const Mat3 inverse = glm::inverse(normal);
            each_neighbour(w, [&](std::size_t n, const Vec3& d) {
                const Vec3 slope = product(inverse, d) / std::max(glm::dot(d, d), 1e-300);
                const bool finite = std::isfinite(slope.x + slope.y + slope.z);
                sink({static_cast<Index>(n), finite ? slope : Vec3(0.0)});
            });
        });
    }

    void make_around() {
        stencils_.around = rows_of_terms<MeanTerm<double>>(mesh_.points.size(), [&](std::size_t p, const auto& sink) {
            const double volume = volume_at(p);
            for (const Index c : at_points_[p]) {
                sink({static_cast<Index>(stencils_.wholes.of_cell[c]), cell_volumes_[c] / volume});
            }
        });
        stencils_.offsets.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Vec3 offset(0.0);
            for (const auto& [whole, weight] : stencils_.around[p]) {
                offset += weight * (mesh_.points[p] - stencils_.centres[whole]);
            }
            stencils_.offsets[p] = offset;
        });
    }

    void make_ends() {
        stencils_.ends = rows_of_terms<MeanTerm<double>>(mesh_.points.size(), [&](std::size_t p, const auto& sink) {
            const double volume = volume_at(p);
            for (const Index c : at_points_[p]) add_ends(static_cast<Index>(p), c, cell_volumes_[c] / volume, sink);
        });
        stencils_.mesh_ends.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Vec3 end(0.0);
            for (const auto& [whole, weight] : stencils_.ends[p]) end += weight * (stencils_.centres[whole] - mesh_.points[p]);
            stencils_.mesh_ends[p] = end;
        });
    }

    void make_reaches(const ValuesOnPatches* on_patches) {
        std::vector<std::pair<std::uint64_t, Index>> faces;  // of sides: 6 cell + side, and the face there
        std::vector<std::array<Index, 2>> at_points;
        if (on_patches != nullptr) {
            for (const auto& [side, face] : on_patches->sides) {
                faces.emplace_back(6 * std::uint64_t{side.cell} + side.side, face);
                for (const std::size_t k : kCellFaces[side.side]) at_points.push_back({mesh_.cells[side.cell][k], face});
            }
        }
        std::ranges::sort(faces);
        std::ranges::sort(at_points);
        IndexRows& rows = stencils_.faces;
        rows = {};
        for (Index p = 0; p < mesh_.points.size(); ++p) {
            while (rows.values.size() < at_points.size() && at_points[rows.values.size()][0] == p)
                rows.values.push_back(at_points[rows.values.size()][1]);
            rows.offsets.push_back(rows.values.size());
        }
        const auto face_of = [&](Index c, std::size_t side) {
            const std::uint64_t key = 6 * std::uint64_t{c} + side;
            const auto found = std::ranges::lower_bound(faces, key, {}, &std::pair<std::uint64_t, Index>::first);
            return found != faces.end() && found->first == key ? found->second : kNone;
        };
        stencils_.reaches = rows_of_terms<MeanReach>(mesh_.points.size(), [&](std::size_t p, const auto& sink) {
            for (const Index c : at_points_[p]) {
                if (!is_alone(c)) continue;
                each_end(static_cast<Index>(p), c, [&](std::size_t, std::size_t side, Index second, Index third) {
                    const double way = glm::length(centre(c) - middle_of(c, side)),
                                 step = glm::length(centre(second) - centre(c));
                    if (!(way > 0 && step > 0)) return;
                    sink({whole(c), whole(second), third == kNone ? kNone : whole(third), way / step, face_of(c, side)});
                });
            }
        });
    }

    void make_bends() {
        stencils_.bends = rows_of_terms<MeanTerm<double>>(
            mesh_.points.size(), [&](std::size_t p, const auto& sink) { add_bends(static_cast<Index>(p), sink); });
        stencils_.mesh_bends.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Vec3 bend(0.0);
            for (const auto& [q, weight] : stencils_.bends[p]) bend += weight * (mesh_.points[q] - mesh_.points[p]);
            stencils_.mesh_bends[p] = bend;
        });
    }

private:
    /// A line of the mesh at a point: the neighbour there, and the point on the other side.
    struct Line {
        Index near, far;
        bool forked = false;  // leads to several others
    };

    /// The cell beyond a side, none at the boundary.
    [[nodiscard]] Index beyond(Index cell, std::size_t side) const {
        if (cell == kNone) return kNone;
        const Index face = topology_.cell_faces[cell][side];
        if (topology_.face_on_boundary(face)) return kNone;
        const auto& cells = topology_.face_cells[face];
        return cells[0] == cell ? cells[1] : cells[0];
    }

    /// The cell beyond, entered through a face, and what lies beyond that on its other side.
    [[nodiscard]] Index next_but_one(Index cell, std::size_t side) const {
        const Index next = beyond(cell, side);
        if (next == kNone) return kNone;
        const auto& faces = topology_.cell_faces[next];
        const auto entered = std::ranges::find(faces, topology_.cell_faces[cell][side]) - faces.begin();
        return beyond(next, static_cast<std::size_t>(entered) ^ 1U);
    }

    [[nodiscard]] double volume_at(std::size_t p) const {
        double volume = 0;
        for (const Index c : at_points_[p]) volume += cell_volumes_[c];
        return volume;
    }

    [[nodiscard]] bool is_alone(Index cell) const {
        return cell != kNone && stencils_.wholes.cells_of(stencils_.wholes.of_cell[cell]).size() == 1;
    }
    [[nodiscard]] Index whole(Index cell) const { return static_cast<Index>(stencils_.wholes.of_cell[cell]); }

    /// A face of the boundary with the cells c1, c2, c3 behind it, at distances t1 < t2 < t3, adds (4/3) t1 t2 m[t1, t2, t3]
    /// with the divided difference. Two such faces at an edge add (m − ma − mb + md) / 4, with the cells a and b behind them
    /// and d beside both.
    template <class Sink>
    void add_ends(Index p, Index c, double weight, const Sink& sink) const {
        if (!is_alone(c)) return;
        std::array<Index, 3> behind{kNone, kNone, kNone};
        each_end(p, c, [&](std::size_t axis, std::size_t side, Index second, Index third) {
            behind[axis] = second;
            if (third != kNone) add_face(c, side, second, third, weight, sink);
        });
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Index a = behind[axis], b = behind[(axis + 1) % 3], d = beside(a, b, c);
            if (a == kNone || b == kNone || !is_alone(d)) continue;
            sink({whole(c), weight / 4});
            sink({whole(a), -weight / 4});
            sink({whole(b), -weight / 4});
            sink({whole(d), weight / 4});
        }
    }

    /// Calls call(axis, side, second, third) for each side of a cell at a point that lies on the boundary, with the cells
    /// behind it; third: kNone if there is none.
    template <class Call>
    void each_end(Index p, Index c, const Call& call) const {
        const std::size_t corner = corner_of(mesh_.cells[c], p);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t side = side_at(corner, axis);
            if (!topology_.face_on_boundary(topology_.cell_faces[c][side])) continue;
            const Index second = beyond(c, side ^ 1U), third = next_but_one(c, side ^ 1U);
            if (is_alone(second)) call(axis, side, second, is_alone(third) && third != c ? third : kNone);
        }
    }

    [[nodiscard]] const Vec3& centre(Index cell) const { return stencils_.centres[whole(cell)]; }
    [[nodiscard]] Vec3 middle_of(Index cell, std::size_t side) const {
        Vec3 middle(0.0);
        for (const std::size_t k : kCellFaces[side]) middle += mesh_.points[mesh_.cells[cell][k]] / 4.0;
        return middle;
    }

    template <class Sink>
    void add_face(Index first, std::size_t side, Index second, Index third, double weight, const Sink& sink) const {
        const Vec3 middle = middle_of(first, side);
        const double t1 = glm::length(centre(first) - middle), t2 = t1 + glm::length(centre(second) - centre(first)),
                     t3 = t2 + glm::length(centre(third) - centre(second));
        if (!(t1 > 0 && t2 > t1 && t3 > t2)) return;
        const double factor = weight * 4 / 3 * t1 * t2;
        sink({whole(first), factor / ((t1 - t2) * (t1 - t3))});
        sink({whole(second), factor / ((t2 - t1) * (t2 - t3))});
        sink({whole(third), factor / ((t3 - t1) * (t3 - t2))});
    }

    /// A cell beside both a and b that is not c.
    [[nodiscard]] Index beside(Index a, Index b, Index c) const {
        if (a == kNone || b == kNone) return kNone;
        for (std::size_t i = 0; i < 6; ++i) {
            const Index d = beyond(a, i);
            if (d == kNone || d == c) continue;
            for (std::size_t j = 0; j < 6; ++j) {
                if (beyond(b, j) == d) return d;
            }
        }
        return kNone;
    }

    /// Lines at a point, by their near points in ascending order.
    void lines_at(Index p, std::vector<Line>& lines) const {
        lines.clear();
        for (const Index c : at_points_[p]) {
            const std::size_t corner = corner_of(mesh_.cells[c], p);
            for (const std::size_t other : kCornerNeighbors[corner]) {
                const std::size_t side = side_at(corner, axis_of_edge(corner, other));
                lines.push_back({mesh_.cells[c][other], across(c, side, p)});
            }
        }
        std::ranges::sort(lines,
                          [](const Line& a, const Line& b) { return std::tie(a.near, a.far) < std::tie(b.near, b.far); });
        std::size_t kept = 0;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            Line& last = lines[kept > 0 ? kept - 1 : 0];
            if (kept == 0 || last.near != lines[i].near) {
                lines[kept++] = lines[i];
            } else if (lines[i].far != kNone && last.far != lines[i].far) {
                last.forked = true;
            }
        }
        lines.resize(kept);
        for (const Line& line : lines) close(line, lines);
    }

    /// A line whose way back leads elsewhere is forked, too.
    static void close(const Line& line, std::vector<Line>& lines) {
        if (line.forked || line.far == kNone) return;
        const auto back = std::ranges::lower_bound(lines, line.far, {}, &Line::near);
        const bool returns = back != lines.end() && back->near == line.far && !back->forked && back->far == line.near;
        if (!returns) lines[static_cast<std::size_t>(&line - lines.data())].forked = true;
    }

    /// The point at the other end of the edge that leaves p beyond a side.
    [[nodiscard]] Index across(Index cell, std::size_t side, Index p) const {
        const Index next = beyond(cell, side);
        if (next == kNone) return kNone;
        const auto& quad = topology_.faces[topology_.cell_faces[cell][side]];
        const auto& corners = mesh_.cells[next];
        for (const std::size_t other : kCornerNeighbors[corner_of(corners, p)]) {
            if (std::ranges::find(quad, corners[other]) == quad.end()) return corners[other];
        }
        return kNone;
    }

    /// A line that ends takes the second difference at its next point. The lines of an irregular point count as if they were
    /// as many as in a grid.
    template <class Sink>
    void add_bends(Index p, const Sink& sink) const {
        if (at_points_[p].empty()) return;
        thread_local std::vector<Line> lines, next_lines;
        lines_at(p, lines);
        std::size_t through = 0, ends = 0, forks = 0;
        for (const Line& line : lines) (line.forked ? forks : line.far == kNone ? ends : through) += 1;
        const double dimensions = 3 - static_cast<double>(through) / 2 - static_cast<double>(ends);
        const double fork = forks > 0 ? std::max(0., 2 * dimensions / static_cast<double>(forks)) : 0;
        double own = 0;
        for (const Line& line : lines) {
            if (!line.forked && line.far == kNone) {
                lines_at(line.near, next_lines);
                const auto next = std::ranges::lower_bound(next_lines, p, {}, &Line::near);
                if (next == next_lines.end() || next->near != p || next->forked || next->far == kNone) continue;
                sink({line.near, -2});
                sink({next->far, 1});
                own += 1;
            } else {
                const double weight = line.forked ? fork : 1;
                sink({line.near, weight});
                own -= weight;
            }
        }
        sink({p, own});
    }

    const HexMesh& mesh_;
    const Topology& topology_;
    MeanStencils& stencils_;
    IndexRows at_points_;
    std::vector<double> cell_volumes_;
};

}  // namespace

// Two points of Gauss along each axis are exact.
CellIntegrals integrate(const std::array<Vec3, 8>& x) {
    CellIntegrals integrals;
    auto& [corners, volume, moment] = integrals;
    const double h = .5 / std::sqrt(3.);
    double size = 0;
    for (int g = 0; g < 8; ++g) {
        const Vec3 at(.5 + (g & 1 ? h : -h), .5 + (g & 2 ? h : -h), .5 + (g & 4 ? h : -h));
        std::array<double, 8> values{};
        Mat3 jacobian(0.0);
        for (std::size_t k = 0; k < 8; ++k) {
            std::array<double, 3> f{}, df{};
            for (int a = 0; a < 3; ++a) {
                const bool upper = kCornerParameters[k][static_cast<std::size_t>(a)] == 1;
                f[static_cast<std::size_t>(a)] = upper ? at[a] : 1 - at[a];
                df[static_cast<std::size_t>(a)] = upper ? 1 : -1;
            }
            values[k] = f[0] * f[1] * f[2];
            const Vec3 slope(df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]);
            jacobian += glm::outerProduct(x[k] - x[0], slope);
        }
        const double determinant = glm::determinant(jacobian) / 8;
        volume += determinant;
        size += std::abs(determinant);
        for (std::size_t k = 0; k < 8; ++k) corners[k] += determinant * values[k];
    }
    if (!(volume > .05 * size)) {
        volume = std::max(std::abs(volume), 1e-300);  // an inverted cell counts as a box
        corners.fill(volume / 8);
    }
    for (std::size_t k = 0; k < 8; ++k) moment += corners[k] * (x[k] - x[0]);
    moment += volume * x[0];
    return integrals;
}

MeanStencils mean_stencils(const HexMesh& mesh, const Topology& topology, std::span<const Index> parts,
                           const ValuesOnPatches* on_patches) {
    MeanStencils stencils;
    stencils.wholes = wholes_of(mesh.cells.size(), parts);
    StencilMaker maker(mesh, topology, stencils);
    maker.integrate_cells();
    maker.make_slopes();
    maker.make_around();
    maker.make_ends();
    maker.make_reaches(on_patches);
    maker.make_bends();
    return stencils;
}

}  // namespace subvol::detail
