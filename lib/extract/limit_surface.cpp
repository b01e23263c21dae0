// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cell_cutter.h"
#include "limit_place.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "surface_shape.h"

namespace subvol {

using detail::CellTriangles;
using detail::Cut;
using detail::SurfacePoint;

namespace {

constexpr int kFirstLevel = 1;
constexpr int kMostRounds = 12;                       // of Newton's method on an edge
constexpr double kEdgeTolerance = 1e-9;               // of an edge
constexpr std::size_t kBatch = std::size_t{1} << 20;  // points that are moved to the limit at a time
constexpr double kCrease = 0.9;  // cosine: normals of the limit and of the triangles that differ by more are on a crease
constexpr double kTriangleBend = 4.0 / 3;  // the middle of a triangle is farther from a sphere than those of its edges

/// Triangles whose corners are points on edges, before and after these have been moved to the limit.
struct Soup {
    std::vector<SurfacePoint> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::uint8_t> hull;  // of each triangle
    std::size_t cells = 0;
};

/// Where a point is.
struct Settled {
    std::vector<LimitQuery> places;
    std::vector<Vec3> positions, normals;
};

class Extractor {
public:
    Extractor(const HexMesh& mesh, std::string_view field, const SurfaceOptions& options)
        : mesh_(mesh), options_(options), field_(field_number(field)), topology_(build_topology(mesh)) {
        const Vec3 size = bounds(mesh).size();
        tolerance_world_ = options.tolerance * std::max({size.x, size.y, size.z, 1e-300});
        scalar_ = mesh;
        scalar_.attributes.clear();
        if (field_) scalar_.attributes.push_back(mesh.attributes[*field_]);
        limit_.emplace(scalar_, LimitOptions{.scheme = options_.scheme});
    }

    LimitSurface run() {
        LimitSurface all;
        all.report.converged = true;
        for (const double iso : options_.isos) append(surface_of({iso, options_.cap}), all);
        if (options_.boundary) append(surface_of({{}, true}), all);
        report_progress(options_.progress, "fields", 0);
        evaluate_fields(all);
        detail::measure_surface(all.surface, all.report);
        return all;
    }

private:
    [[nodiscard]] std::optional<std::size_t> field_number(std::string_view name) const {
        if (options_.isos.empty()) return std::nullopt;
        return static_cast<std::size_t>(&scalar_field(mesh_, name) - mesh_.attributes.data());
    }

    /// The surface of one cut, at the level that its tolerance asks for.
    LimitSurface surface_of(const Cut& cut) {
        std::optional<std::vector<Index>> active;
        LimitSurface found;
        for (int level = std::min(kFirstLevel, options_.max_level);;) {
            const Soup soup = cut_cells(cut, level, active);
            const Settled settled = settle(soup, cut, level);
            const double deviation = deviation_of(soup, settled, level);
            const double more = std::log2(std::max(deviation / tolerance_world_, 1e-9)) / 2;
            const int wanted = level + std::max(0, static_cast<int>(std::ceil(more - 0.05)));
            int next = std::min(wanted, options_.max_level);
            while (next > level && static_cast<double>(soup.triangles.size()) * std::pow(4.0, next - level) >
                                       static_cast<double>(options_.max_triangles)) {
                --next;
            }
            if (next == level) {
                found.report.level = level;
                found.report.cells = soup.cells;
                found.report.deviation_world = deviation;
                found.report.converged = deviation <= 1.1 * tolerance_world_;
                finish(soup, settled, found);
                return found;
            }
            level = next;
        }
    }

    /// The control cells through which the surface may pass, by the values at the vertices of level 1 or 2.
    std::vector<Index> candidates(const Cut& cut) {
        std::vector<std::uint8_t> wanted(mesh_.cells.size(), 0);
        if (cut.iso) {
            std::vector<Index> all(mesh_.cells.size());
            for (Index c = 0; c < all.size(); ++c) all[c] = c;
            const DenseCells cells(scalar_, {.scheme = options_.scheme, .levels = 1, .progress = options_.progress}, true,
                                   DenseBits::ToRounding);
            cells.for_each(all, [&](const DenseCell& cell) {
                const auto [low, high] = std::ranges::minmax(cell.values[0]);
                // Between the vertices of level 1 values go beyond theirs by less than this part of their range.
                const double slack = 0.3 * (high - low);
                const bool crossed = low - slack < *cut.iso && high + slack >= *cut.iso;
                const bool on_hull = cut.hull && has_hull(cell.cell) && high + slack >= *cut.iso;
                wanted[cell.cell] = crossed || on_hull ? 1 : 0;
            });
        } else {
            for (Index c = 0; c < wanted.size(); ++c) wanted[c] = has_hull(c) ? 1 : 0;
        }
        std::vector<Index> found;
        for (Index c = 0; c < wanted.size(); ++c) {
            if (wanted[c] != 0) found.push_back(c);
        }
        return found;
    }

    [[nodiscard]] bool has_hull(Index cell) const {
        return std::ranges::any_of(topology_.cell_faces[cell], [&](Index f) { return topology_.face_on_hull(f); });
    }

    /// Cuts the candidates, and neighbours into which the surface leads from them, until no more are found.
    Soup cut_cells(const Cut& cut, int level, std::optional<std::vector<Index>>& active) {
        if (!active) active = candidates(cut);
        const detail::GridNumbers numbers(topology_, level);
        const DenseCells dense(scalar_, {.scheme = options_.scheme, .levels = level, .progress = options_.progress}, true);
        std::vector<Index> slots(mesh_.cells.size(), kNone);
        std::vector<CellTriangles> parts;
        std::vector<Index> cells, todo = *active;
        while (!todo.empty()) {
            for (const Index cell : todo) {
                slots[cell] = static_cast<Index>(cells.size());
                cells.push_back(cell);
            }
            parts.resize(cells.size());
            dense.for_each(todo, [&](const DenseCell& cell) {
                const std::span<const double> values = field_ && cut.iso ? cell.values[0] : std::span<const double>();
                parts[slots[cell.cell]] = detail::cut_cell(cell, values, cut, topology_, numbers);
            });
            todo = reached(cells, parts, todo.size(), slots, level);
        }
        std::erase_if(cells, [&](Index cell) { return parts[slots[cell]].triangles.empty(); });
        std::ranges::sort(cells);
        active = cells;
        return join(cells, parts, slots);
    }

    /// Cells that have not been cut, but share a face with a point on it.
    [[nodiscard]] std::vector<Index> reached(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                                             std::size_t last, const std::vector<Index>& slots, int level) const {
        const auto end = static_cast<std::uint16_t>(1U << level);
        std::vector<Index> found;
        for (std::size_t i = cells.size() - last; i < cells.size(); ++i) {
            for (const SurfacePoint& point : parts[i].points) {
                if (point.a == point.b) continue;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (point.at[0][axis] != point.at[1][axis]) continue;
                    if (point.at[0][axis] == 0) add_neighbors(cells[i], 2 * axis, slots, found);
                    if (point.at[0][axis] == end) add_neighbors(cells[i], 2 * axis + 1, slots, found);
                }
            }
        }
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

    void add_neighbors(Index cell, std::size_t side, const std::vector<Index>& slots, std::vector<Index>& found) const {
        for (const Index other : topology_.face_cells[topology_.cell_faces[cell][side]]) {
            if (other != kNone && slots[other] == kNone) found.push_back(other);
        }
    }

    /// One list of points for all cells: those that several cells have, once.
    static Soup join(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                     const std::vector<Index>& slots) {
        struct Named {
            detail::VertexNumber a, b;
            std::uint64_t at;  // in the order of cells and their points
            auto operator<=>(const Named&) const = default;
        };
        std::vector<Named> named;
        std::vector<std::size_t> starts;
        for (const Index cell : cells) {
            starts.push_back(named.size());
            for (const SurfacePoint& point : parts[slots[cell]].points) named.push_back({point.a, point.b, named.size()});
        }
        std::vector<const SurfacePoint*> given;
        for (const Index cell : cells) {
            for (const SurfacePoint& point : parts[slots[cell]].points) given.push_back(&point);
        }
        tbb::parallel_sort(named.begin(), named.end());
        Soup soup;
        soup.cells = cells.size();
        std::vector<Index> numbers(named.size());
        for (std::size_t i = 0; i < named.size(); ++i) {
            const bool again = i > 0 && named[i].a == named[i - 1].a && named[i].b == named[i - 1].b;
            if (!again) soup.points.push_back(*given[named[i].at]);
            // A point of the hull has a face of it in some of its cells only.
            if (again && soup.points.back().side == 6 && given[named[i].at]->side != 6)
                soup.points.back() = *given[named[i].at];
            numbers[named[i].at] = static_cast<Index>(soup.points.size() - 1);
        }
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const CellTriangles& part = parts[slots[cells[c]]];
            for (const auto& t : part.triangles) {
                soup.triangles.push_back({numbers[starts[c] + t[0]], numbers[starts[c] + t[1]], numbers[starts[c] + t[2]]});
            }
            soup.hull.insert(soup.hull.end(), part.hull.begin(), part.hull.end());
        }
        return soup;
    }

    /// A point on its way along an edge.
    struct Moving {
        std::size_t point;
        double low = 0, high = 1;  // the crossing is between them
        double t = 0;
        bool done = false;
    };

    static Vec3 place_on_edge(const SurfacePoint& point, double t, int level) {
        const auto end = [&](std::size_t e) {
            return std::ldexp(1.0, -level) * Vec3(point.at[e][0], point.at[e][1], point.at[e][2]);
        };
        return (1 - t) * end(0) + t * end(1);
    }

    /// Moves all points to the limit.
    Settled settle(const Soup& soup, const Cut& cut, int level) const {
        Settled settled;
        settled.places.resize(soup.points.size());
        settled.positions.resize(soup.points.size());
        settled.normals.resize(soup.points.size());
        for (std::size_t begin = 0; begin < soup.points.size(); begin += kBatch) {
            report_progress(options_.progress, "to the limit",
                            static_cast<double>(begin) / static_cast<double>(soup.points.size()));
            std::vector<Moving> moving;
            for (std::size_t p = begin; p < std::min(soup.points.size(), begin + kBatch); ++p) {
                const SurfacePoint& point = soup.points[p];
                const double difference = point.off[0] - point.off[1];
                moving.push_back({p, 0, 1, point.a == point.b || difference == 0 ? 0 : point.off[0] / difference});
            }
            move(soup, cut, level, moving, settled);
        }
        return settled;
    }

    void move(const Soup& soup, const Cut& cut, int level, std::vector<Moving>& moving, Settled& settled) const {
        std::vector<LimitQuery> queries;
        for (int round = 0; !moving.empty(); ++round) {
            queries.clear();
            for (const Moving& one : moving) {
                queries.push_back({soup.points[one.point].cell, place_on_edge(soup.points[one.point], one.t, level)});
            }
            const LimitSamples samples = limit_->at(queries);
            detail::parallel_each(moving.size(), [&](std::size_t i) {
                Moving& one = moving[i];
                const SurfacePoint& point = soup.points[one.point];
                const Vec3 along = place_on_edge(point, 1, level) - place_on_edge(point, 0, level);
                double by = 0;
                if (point.a != point.b) {
                    const double off = samples.attributes[0].values[i] - *cut.iso;
                    const double slope = glm::dot(samples.attributes[0].derivatives[i], along);
                    if ((off >= 0) == (point.off[0] >= 0)) {
                        one.low = one.t;
                    } else {
                        one.high = one.t;
                    }
                    double next = one.t - off / slope;
                    if (!(next > one.low && next < one.high)) next = off == 0 ? one.t : 0.5 * (one.low + one.high);
                    by = next - one.t;
                }
                const bool last = std::abs(by) < 1e-3 || round + 1 == kMostRounds;
                if (!last) {
                    one.t += by;
                    return;
                }
                // What is left is linear to within the square of the step.
                const Vec3 step = by * along;
                settled.places[one.point] = {queries[i].cell, glm::clamp(queries[i].uvw + step, Vec3(0.0), Vec3(1.0))};
                settled.positions[one.point] = samples.positions[i] + samples.jacobians[i] * step;
                settled.normals[one.point] = normal_of(point, samples, i, cut);
                one.done = std::abs(by) < kEdgeTolerance || round + 1 == kMostRounds || std::abs(by) < 1e-3;
            });
            std::erase_if(moving, [](const Moving& one) { return one.done; });
        }
    }

    /// Against the gradient, or outwards on the hull.
    static Vec3 normal_of(const SurfacePoint& point, const LimitSamples& samples, std::size_t i, const Cut& cut) {
        const Mat3& jacobian = samples.jacobians[i];
        Vec3 normal(0.0);
        if (cut.iso && point.a != point.b) {
            normal = -detail::world_gradient(jacobian, samples.attributes[0].derivatives[i]);
        } else if (point.side < 6) {
            const int axis = point.side / 2;
            normal = glm::cross(jacobian[(axis + 1) % 3], jacobian[(axis + 2) % 3]) * (point.side % 2 == 1 ? 1.0 : -1.0);
        }
        const double length = glm::length(normal);
        return length > 0 ? normal / length : Vec3(0.0);
    }

    /// How far most triangles are from the limit: all but one edge in a thousand, as normals are arbitrary where gradients
    /// vanish.
    [[nodiscard]] double deviation_of(const Soup& soup, const Settled& settled, int level) const {
        std::vector<double> bends(3 * soup.triangles.size(), 0);
        std::vector<std::size_t> hull;
        for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
            if (soup.hull[t] != 0) hull.push_back(t);
        }
        detail::parallel_each(soup.triangles.size(), [&](std::size_t t) {
            if (soup.hull[t] != 0) return;
            for (std::size_t k = 0; k < 3; ++k) {
                const Index a = soup.triangles[t][k], b = soup.triangles[t][(k + 1) % 3];
                bends[3 * t + k] = kTriangleBend * detail::bend(settled.positions[a], settled.positions[b], settled.normals[a],
                                                                settled.normals[b]);
            }
        });
        add_hull_bends(soup, settled, level, hull, bends);
        if (bends.empty()) return 0;
        const std::size_t most = bends.size() - 1 - bends.size() / 1000;
        std::nth_element(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(most), bends.end());
        return bends[most];
    }

    /// Of triangles on the hull: by the limit in the middle of their edges.
    void add_hull_bends(const Soup& soup, const Settled& settled, int level, const std::vector<std::size_t>& hull,
                        std::vector<double>& bends) const {
        constexpr std::size_t kMostProbes = 40000;
        struct Probe {
            Index a, b;
        };
        const std::size_t stride = 1 + 3 * hull.size() / kMostProbes;
        std::vector<Probe> probes;
        std::vector<LimitQuery> queries;
        for (std::size_t i = 0; i < 3 * hull.size(); i += stride) {
            const auto& t = soup.triangles[hull[i / 3]];
            const Index a = t[i % 3], b = t[(i + 1) % 3];
            const SurfacePoint &from = soup.points[a], &to = soup.points[b];
            if (from.cell != to.cell || from.a != from.b || to.a != to.b) continue;
            const Vec3 middle = 0.5 * (place_on_edge(from, 0, level) + place_on_edge(to, 0, level));
            if (!on_hull(from.cell, middle)) continue;
            probes.push_back({a, b});
            queries.push_back({from.cell, middle});
        }
        bends.reserve(bends.size() + probes.size());
        for (std::size_t t : hull) bends[3 * t] = bends[3 * t + 1] = bends[3 * t + 2] = 0;
        const LimitSamples samples = limit_->at(queries);
        std::size_t next = 0;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const Vec3 &a = settled.positions[probes[i].a], &b = settled.positions[probes[i].b];
            // Each probe stands for `stride` edges of the hull.
            const double far = kTriangleBend * distance_to_line(samples.positions[i], a, b);
            for (std::size_t n = 0; n < stride && next < 3 * hull.size(); ++n, ++next)
                bends[3 * hull[next / 3] + next % 3] = far;
        }
    }

    [[nodiscard]] bool on_hull(Index cell, const Vec3& uvw) const {
        for (std::size_t f = 0; f < 6; ++f) {
            const double t = uvw[static_cast<int>(f / 2)];
            if (t == (f % 2 == 0 ? 0.0 : 1.0) && topology_.face_on_hull(topology_.cell_faces[cell][f])) return true;
        }
        return false;
    }

    static double distance_to_line(const Vec3& p, const Vec3& a, const Vec3& b) {
        const double length = glm::distance(a, b);
        return length > 0 ? glm::length(glm::cross(p - a, b - a)) / length : glm::distance(p, a);
    }

    /// Normals where sides meet, fewer slivers, and no points that no triangle uses.
    void finish(const Soup& soup, const Settled& settled, LimitSurface& found) const {
        std::vector<Vec3> of_hull(soup.points.size(), Vec3(0.0)), of_iso = of_hull, normals = settled.normals;
        std::vector<std::uint8_t> creased(soup.points.size(), 0);
        const auto facet = [&](const std::array<Index, 3>& t) {
            const Vec3& a = settled.positions[t[0]];
            return glm::cross(settled.positions[t[1]] - a, settled.positions[t[2]] - a);
        };
        for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
            for (const Index p : soup.triangles[t]) (soup.hull[t] != 0 ? of_hull : of_iso)[p] += facet(soup.triangles[t]);
        }
        for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
            if (soup.hull[t] == 0) continue;
            const Vec3 normal = facet(soup.triangles[t]);
            for (const Index p : soup.triangles[t]) {
                if (glm::dot(normal, settled.normals[p]) < kCrease * glm::length(normal)) creased[p] = 1;
            }
        }
        const auto unit = [](const Vec3& v) { return glm::length(v) > 0 ? v / glm::length(v) : Vec3(0.0); };
        for (std::size_t p = 0; p < normals.size(); ++p) {
            const bool hull = of_hull[p] != Vec3(0.0), iso = of_iso[p] != Vec3(0.0);
            if (hull && iso) {
                normals[p] = unit(unit(of_hull[p]) + (normals[p] != Vec3(0.0) ? normals[p] : unit(of_iso[p])));
                creased[p] = 1;
            } else if (creased[p] != 0 || normals[p] == Vec3(0.0)) {
                normals[p] = unit(hull ? of_hull[p] : of_iso[p]);
            }
        }
        found.surface.triangles = soup.triangles;
        if (options_.improve) {
            report_progress(options_.progress, "improve", 0);
            found.report.collapsed = detail::collapse_slivers(
                settled.positions, normals, detail::sharp_lines(settled.positions, found.surface.triangles, soup.hull),
                tolerance_world_, found.surface.triangles);
        }
        std::vector<Index> numbers(soup.points.size(), kNone);
        for (const auto& t : found.surface.triangles) {
            for (const Index p : t) numbers[p] = 0;
        }
        for (std::size_t p = 0; p < numbers.size(); ++p) {
            if (numbers[p] == kNone) continue;
            numbers[p] = static_cast<Index>(found.surface.points.size());
            found.surface.points.push_back(settled.positions[p]);
            found.normals.push_back(normals[p]);
            found.places.push_back(settled.places[p]);
        }
        for (auto& t : found.surface.triangles) {
            for (Index& p : t) p = numbers[p];
        }
    }

    static void append(LimitSurface more, LimitSurface& all) {
        const auto first = static_cast<Index>(all.surface.points.size());
        for (auto t : more.surface.triangles) {
            for (Index& p : t) p += first;
            all.surface.triangles.push_back(t);
        }
        all.surface.points.insert(all.surface.points.end(), more.surface.points.begin(), more.surface.points.end());
        all.normals.insert(all.normals.end(), more.normals.begin(), more.normals.end());
        all.places.insert(all.places.end(), more.places.begin(), more.places.end());
        all.report.level = std::max(all.report.level, more.report.level);
        all.report.deviation_world = std::max(all.report.deviation_world, more.report.deviation_world);
        all.report.converged = all.report.converged && more.report.converged;
        all.report.cells += more.report.cells;
        all.report.collapsed += more.report.collapsed;
    }

    void evaluate_fields(LimitSurface& all) const {
        const std::size_t count = all.places.size();
        for (const Attribute& attribute : mesh_.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            all.fields.push_back(
                {attribute.name, channels, std::vector<double>(count * channels), std::vector<Vec3>(count * channels)});
        }
        if (all.fields.empty()) return;
        for (std::size_t begin = 0; begin < count; begin += kBatch) {
            const auto places = std::span(all.places).subspan(begin, std::min(kBatch, count - begin));
            const LimitSamples samples = evaluate_limit(mesh_, places, {.scheme = options_.scheme});
            for (std::size_t f = 0; f < all.fields.size(); ++f) {
                const std::size_t channels = all.fields[f].channels;
                detail::parallel_each(places.size() * channels, [&](std::size_t i) {
                    all.fields[f].values[begin * channels + i] = samples.attributes[f].values[i];
                    all.fields[f].gradients[begin * channels + i] =
                        detail::world_gradient(samples.jacobians[i / channels], samples.attributes[f].derivatives[i]);
                });
            }
        }
    }

    const HexMesh& mesh_;
    const SurfaceOptions& options_;
    std::optional<std::size_t> field_;
    Topology topology_;
    std::optional<LimitEvaluator> limit_;  // of scalar_
    HexMesh scalar_;
    double tolerance_world_ = 0;
};

void check(const SurfaceOptions& options) {
    const auto refuse = [](const std::string& what, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, what, "surface", allowed);
    };
    if (options.isos.empty() && !options.boundary) refuse("nothing is asked for", "an isovalue, or the boundary");
    for (const double iso : options.isos) {
        if (!std::isfinite(iso)) refuse("an isovalue is not finite", "finite numbers");
    }
    if (options.cap && options.isos.empty()) refuse("there is nothing to cap", "an isovalue");
    if (!(options.tolerance > 0 && options.tolerance <= 1))
        refuse("the tolerance is out of range", "greater than 0, at most 1");
    if (options.max_level < 1 || options.max_level > 8) refuse("the finest level is out of range", "1 to 8");
}

}  // namespace

LimitSurface limit_surface(const HexMesh& mesh, std::string_view field, const SurfaceOptions& options) {
    check(options);
    validate(mesh);
    HexMesh tagged = mesh;
    SurfaceOptions wanted = options;
    if (options.scheme.crease_angle_deg) {  // once, so that all stages have the same creases
        tag_creases(tagged, *options.scheme.crease_angle_deg);
        wanted.scheme.crease_angle_deg.reset();
    }
    return Extractor(tagged, field, wanted).run();
}

}  // namespace subvol
