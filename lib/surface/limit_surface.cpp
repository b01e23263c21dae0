// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <algorithm>
#include <cmath>

#include "mesh_subset.h"
#include "subvol/error.h"
#include "surface_maker.h"
#include "surface_shape.h"
#include "surface_share.h"

namespace subvol {

using detail::check_surface_options;
using detail::Cut;
using detail::SettledCut;

namespace {

constexpr int kMostLayers = 3;  // of cells about those that the first look finds; beyond, the mesh is taken as it is

/// Creases are found once, so that all stages have the same.
class Tagged {
public:
    /// The mesh is kept by reference.
    Tagged(const HexMesh& from, const SurfaceOptions& wanted) : options(wanted), from_(from) {
        if (!options.scheme.crease_angle_deg) return;
        copy_ = from;
        tag_creases(*copy_, *options.scheme.crease_angle_deg);
        options.scheme.crease_angle_deg.reset();
    }
    [[nodiscard]] const HexMesh& mesh() const { return copy_ ? *copy_ : from_; }

    SurfaceOptions options;

private:
    const HexMesh& from_;
    std::optional<HexMesh> copy_;
};

/// The cells that a surface may pass through, with three layers about them: nothing else is needed of the mesh.
///
/// owned: a flag for each cell that the surface may be cut from
struct NearSurface {
    detail::MeshSubset part;
    std::vector<std::uint8_t> owned;
};

/// wanted: a flag for each cell of the mesh
NearSurface near_surface(const HexMesh& mesh, const std::vector<std::uint8_t>& wanted) {
    std::vector<std::uint8_t> kept = wanted;
    detail::grow(mesh, kept, detail::kHaloOfLimit);
    NearSurface near{.part = detail::subset(mesh, kept), .owned = {}};
    for (const Index c : near.part.cells) near.owned.push_back(wanted[c]);
    return near;
}

LimitSurface no_surface(const HexMesh& mesh) {
    LimitSurface none;
    none.report.converged = true;
    for (const Attribute& attribute : mesh.attributes) {
        none.fields.push_back({attribute.name, static_cast<std::size_t>(attribute.channels), {}, {}});
    }
    return none;
}

}  // namespace

void detail::check_surface_options(const SurfaceOptions& options) {
    const auto refuse = [](const std::string& reason, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, reason, "surface", allowed);
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
    const detail::LimitExtent whole = detail::limit_extent(mesh);
    std::vector<std::uint8_t> wanted = detail::surface_candidates(tagged.mesh(), field, tagged.options);
    if (std::ranges::find(wanted, 1) == wanted.end()) return no_surface(mesh);
    // The boundary leads nowhere; an isosurface may lead out of the cells that the first look finds.
    for (int layers = 0; layers <= kMostLayers; ++layers) {
        if (layers > 0 || !options.isos.empty()) detail::grow(tagged.mesh(), wanted, 1);
        const NearSurface near = near_surface(tagged.mesh(), wanted);
        auto surface = detail::limit_surface_of_part(near.part.mesh, near.owned, whole, field, tagged.options);
        if (!surface) continue;
        for (LimitQuery& place : surface->places) place.cell = near.part.cells[place.cell];
        return std::move(*surface);
    }
    return *detail::limit_surface_of_part(tagged.mesh(), {}, whole, field, tagged.options);
}

std::string detail::share_of_surface(const HexMesh& mesh, std::string_view field, const SurfaceOptions& options,
                                     const Share& share) {
    check_surface_options(options);
    validate(mesh);
    const Tagged tagged(mesh, options);
    std::vector<std::uint8_t> wanted = surface_candidates(tagged.mesh(), field, tagged.options);
    if (std::ranges::find(wanted, 1) == wanted.end()) return empty_surface_share();
    grow(tagged.mesh(), wanted, layers_of_shares(options));
    const NearSurface near = near_surface(tagged.mesh(), wanted);
    auto bytes = share_of_part(near.part.mesh, near.owned, limit_extent(mesh), field, tagged.options, share,
                               [&](LimitQuery& place) { place.cell = near.part.cells[place.cell]; });
    if (!bytes) fail_far_share("surface");
    return std::move(*bytes);
}

int detail::layers_of_shares(const SurfaceOptions& options) {
    return options.isos.empty() ? 0 : 2;
}

void detail::fail_far_share(const std::string& where) {
    throw Error(ErrorCode::InvalidInput, "an isosurface leads farther than its shares look", where,
                "one process: without --part and mpirun");
}

std::vector<std::uint8_t> detail::surface_candidates(const HexMesh& part, std::string_view field,
                                                     const SurfaceOptions& options) {
    const Tagged tagged(part, options);
    const HexMesh scalar = with_field_only(tagged.mesh(), number_of_field(tagged.mesh(), field, options));
    const bool any_hull = options.boundary || options.cap;
    const Topology topology = any_hull ? build_topology(scalar) : Topology();
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
    const SurfaceMaker maker(tagged.mesh(), owned, whole, field, tagged.options);
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
                                                 const SurfaceOptions& options, const Share& share,
                                                 const std::function<void(LimitQuery&)>& rename) {
    const Tagged tagged(part, options);
    const SurfaceMaker maker(tagged.mesh(), owned, whole, field, tagged.options);
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

std::vector<Option> options_of(SurfaceOptions& options) {
    return {Option("boundary", options.boundary).help("the boundary of the volume (the default without --iso)"),
            Option("cap", options.cap)
                .help("close each isosurface with the part of the boundary where the field is at least its value")
                .only_with("iso"),
            Option("tolerance", options.tolerance)
                .between(1e-9, 1)
                .help("E", "how far triangles may lie from the limit, as a part of the longest side of the box"),
            Option("max-level", options.max_level).between(1, 8).help("L", "refine no further")};
}

}  // namespace subvol
