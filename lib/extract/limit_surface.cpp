// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "limit_place.h"
#include "point_settler.h"
#include "soup_cutter.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "surface_part.h"
#include "surface_shape.h"

namespace subvol {

using detail::check_surface_options;
using detail::Cut;
using detail::LimitExtent;
using detail::SettledPoints;
using detail::SurfaceSoup;

namespace {

constexpr int kFirstLevel = 1;
constexpr std::size_t kPointsAtOnce = std::size_t{1} << 20;  // points whose fields are evaluated at a time
constexpr double kCrease = 0.9;  // cosine: normals of the limit and of the triangles that differ by more are on a crease

double longest_side(const Box& box) {
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z});
}

class Extractor {
public:
    Extractor(const HexMesh& mesh, std::string_view field, std::span<const std::uint8_t> owned, LimitExtent whole,
              const SurfaceOptions& options)
        : mesh_(mesh),
          options_(options),
          whole_(std::move(whole)),
          field_(field_number(field)),
          topology_(build_topology(mesh)),
          scalar_(with_field_only(mesh, field_)),
          cutter_(scalar_, topology_, owned, options.scheme, options.progress),
          settler_(scalar_, topology_, extent_of_field(), options.scheme, options.progress),
          tolerance_world_(options.tolerance * std::max(longest_side(whole_.box), 1e-300)) {}

    [[nodiscard]] std::vector<std::uint8_t> candidates() const {
        std::vector<std::uint8_t> flags(mesh_.cells.size(), 0);
        const auto add = [&](const Cut& cut) {
            for (const Index c : cutter_.candidates(cut)) flags[c] = 1;
        };
        for (const double iso : options_.isos) add({iso, options_.cap});
        if (options_.boundary) add({{}, true});
        return flags;
    }

    [[nodiscard]] bool leads_out() const { return leads_out_; }

    LimitSurface run() {
        LimitSurface all;
        all.report.converged = true;
        for (const double iso : options_.isos) append(surface_of({iso, options_.cap}), all);
        if (options_.boundary) append(surface_of({{}, true}), all);
        if (leads_out_) return all;
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

    [[nodiscard]] LimitExtent extent_of_field() const {
        LimitExtent extent{.box = whole_.box};
        if (field_) extent.ranges.push_back(whole_.ranges[*field_]);
        return extent;
    }

    static HexMesh with_field_only(const HexMesh& mesh, std::optional<std::size_t> field) {
        HexMesh scalar = mesh;
        scalar.attributes.clear();
        if (field) scalar.attributes.push_back(mesh.attributes[*field]);
        return scalar;
    }

    /// The surface of one cut, at the level that its tolerance asks for.
    LimitSurface surface_of(const Cut& cut) {
        std::optional<std::vector<Index>> active;
        LimitSurface found;
        for (int level = std::min(kFirstLevel, options_.max_level);;) {
            const SurfaceSoup soup = cutter_.cut(cut, level, active);
            if (soup.leads_out) {
                leads_out_ = true;
                return found;
            }
            const SettledPoints settled = settler_.settle(soup, cut, level);
            const double deviation = settler_.deviation(soup, settled, level);
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

    /// Normals where sides meet, fewer slivers, and no points that no triangle uses.
    void finish(const SurfaceSoup& soup, const SettledPoints& settled, LimitSurface& found) const {
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
            found.report.mended = detail::mend_slivers(
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
        all.report.mended += more.report.mended;
    }

    void evaluate_fields(LimitSurface& all) const {
        const std::size_t count = all.places.size();
        for (const Attribute& attribute : mesh_.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            all.fields.push_back(
                {attribute.name, channels, std::vector<double>(count * channels), std::vector<Vec3>(count * channels)});
        }
        if (all.fields.empty()) return;
        const LimitEvaluator limit(mesh_, {.scheme = options_.scheme}, whole_);
        for (std::size_t begin = 0; begin < count; begin += kPointsAtOnce) {
            const auto places = std::span(all.places).subspan(begin, std::min(kPointsAtOnce, count - begin));
            const LimitSamples samples = limit.at(places);
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
    LimitExtent whole_;
    std::optional<std::size_t> field_;
    Topology topology_;
    HexMesh scalar_;
    detail::SoupCutter cutter_;
    detail::PointSettler settler_;
    double tolerance_world_;
    bool leads_out_ = false;
};

/// Creases are found once, so that all stages have the same.
struct Tagged {
    Tagged(const HexMesh& from, const SurfaceOptions& wanted) : mesh(from), options(wanted) {
        if (!options.scheme.crease_angle_deg) return;
        tag_creases(mesh, *options.scheme.crease_angle_deg);
        options.scheme.crease_angle_deg.reset();
    }
    HexMesh mesh;
    SurfaceOptions options;
};

}  // namespace

void detail::check_surface_options(const SurfaceOptions& options) {
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

LimitSurface limit_surface(const HexMesh& mesh, std::string_view field, const SurfaceOptions& options) {
    check_surface_options(options);
    validate(mesh);
    const Tagged tagged(mesh, options);
    return Extractor(tagged.mesh, field, {}, detail::limit_extent(mesh), tagged.options).run();
}

std::vector<std::uint8_t> detail::surface_candidates(const HexMesh& part, std::string_view field,
                                                     const SurfaceOptions& options) {
    const Tagged tagged(part, options);
    return Extractor(tagged.mesh, field, {}, detail::limit_extent(part), tagged.options).candidates();
}

std::optional<LimitSurface> detail::limit_surface_of_part(const HexMesh& part, std::span<const std::uint8_t> owned,
                                                          const LimitExtent& whole, std::string_view field,
                                                          const SurfaceOptions& options) {
    const Tagged tagged(part, options);
    Extractor extractor(tagged.mesh, field, owned, whole, tagged.options);
    LimitSurface surface = extractor.run();
    if (extractor.leads_out()) return {};
    return surface;
}

}  // namespace subvol
