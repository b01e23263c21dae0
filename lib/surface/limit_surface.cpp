// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <cmath>

#include "subvol/error.h"
#include "surface_maker.h"
#include "surface_shape.h"
#include "surface_share.h"

namespace subvol {

using detail::check_surface_options;
using detail::Cut;
using detail::SettledCut;

namespace {

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
    return *detail::limit_surface_of_part(mesh, {}, detail::limit_extent(mesh), field, options);
}

std::string detail::share_of_surface(const HexMesh& mesh, std::string_view field, const SurfaceOptions& options,
                                     const SurfaceShareOf& share) {
    check_surface_options(options);
    validate(mesh);
    return *detail::share_of_part(mesh, {}, detail::limit_extent(mesh), field, options, share, [](LimitQuery&) {});
}

std::vector<std::uint8_t> detail::surface_candidates(const HexMesh& part, std::string_view field,
                                                     const SurfaceOptions& options) {
    const Tagged tagged(part, options);
    const HexMesh scalar = with_field_only(tagged.mesh, number_of_field(tagged.mesh, field, options));
    const Topology topology = build_topology(scalar);
    const SoupCutter cutter(scalar, topology, {}, tagged.options.scheme, options.progress);
    std::vector<std::uint8_t> flags(part.cells.size(), 0);
    for (const Cut& cut : cuts_of(options)) {
        for (const Index c : cutter.candidates(cut)) flags[c] = 1;
    }
    return flags;
}

std::optional<LimitSurface> detail::limit_surface_of_part(const HexMesh& part, std::span<const std::uint8_t> owned,
                                                          const LimitExtent& whole, std::string_view field,
                                                          const SurfaceOptions& options) {
    const Tagged tagged(part, options);
    const SurfaceMaker maker(tagged.mesh, owned, whole, field, tagged.options);
    LimitSurface all;
    all.report.converged = true;
    for (const Cut& cut : cuts_of(options)) {
        const std::optional<SettledCut> made = maker.make(cut, {});
        if (!made) return {};
        report_progress(options.progress, "improve", 0);
        add_cut(*made, options.improve, tolerance_world(options, whole), all);
    }
    all.fields = maker.fields_at(all.places);
    measure_surface(all.surface, all.report);
    return all;
}

std::optional<std::string> detail::share_of_part(const HexMesh& part, std::span<const std::uint8_t> owned,
                                                 const LimitExtent& whole, std::string_view field,
                                                 const SurfaceOptions& options, const SurfaceShareOf& share,
                                                 const std::function<void(LimitQuery&)>& rename) {
    const Tagged tagged(part, options);
    const SurfaceMaker maker(tagged.mesh, owned, whole, field, tagged.options);
    SurfaceShare made{.improve = options.improve, .slack_world = tolerance_world(options, whole)};
    std::vector<LimitQuery> places;
    for (const Cut& cut : cuts_of(options)) {
        std::optional<SettledCut> one = maker.make(cut, share);
        if (!one) return {};
        places.insert(places.end(), one->settled.places.begin(), one->settled.places.end());
        for (LimitQuery& place : one->settled.places) rename(place);
        made.cuts.push_back(std::move(*one));
    }
    made.fields = maker.fields_at(places);
    return bytes_of(made);
}

}  // namespace subvol
