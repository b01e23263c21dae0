// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <algorithm>
#include <cmath>

#include "mesh_pieces.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/error.h"
#include "surface_maker.h"
#include "surface_shape.h"
#include "surface_share.h"

// A surface is cut from few cells of a mesh:
//
//      . . . . . . .        *  candidates: the first look at the control values finds that the surface may pass
//      . o o o o . .        o  layers about them into which an isosurface may lead (the boundary leads nowhere)
//      . o * * o o .        +  their halo: the limit in a cell depends on three layers about it
//      + o o * * o .
//      + + o o o o .        All else of the mesh is left out: it changes no bit of the surface.
//      . + + + + + +
//
// If the surface nevertheless leads out of the cells "o", one layer more is tried. Candidates of a mesh in memory are found
// once; of a mesh in pieces they are found piece by piece, and their cells are then gathered from all pieces.

namespace subvol {

using namespace detail;

namespace {

constexpr int kMostLayers = 3;  // of cells about the candidates; beyond, a mesh in memory is taken as it is

/// throws: Error(InvalidInput) if an option is out of range, or nothing is asked for
void check_surface_options(const SurfaceOptions& options) {
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

int first_layers(const SurfaceOptions& options) {
    return options.isos.empty() ? 0 : 1;
}

/// How many layers of cells about the candidates a share looks at: the same for all, so that none can look farther if the
/// surface leads out there.
int layers_of_shares(const SurfaceOptions& options) {
    return options.isos.empty() ? 0 : 2;
}

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

/// A flag for each cell of a part of a mesh: whether the first look finds that a surface may pass through it. In the halo the
/// flags mean nothing.
std::vector<std::uint8_t> surface_candidates(const HexMesh& part, std::string_view field, const SurfaceOptions& options) {
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

/// Cells that a surface is cut from.
///
/// owned:   a flag for each cell that a surface may be cut from; the others are the halo. All of the mesh, if there are none
/// numbers: of the cells in the whole mesh; none: they have the same
struct NearSurface {
    HexMesh mesh;
    std::vector<std::uint8_t> owned;
    std::vector<std::uint64_t> numbers;

    /// From a cell of this mesh to that of the whole.
    void rename(LimitQuery& place) const {
        const std::uint64_t number = numbers[place.cell];
        place.cell = number < kNone ? static_cast<Index>(number) : kNone;
    }
};

/// Finds the cells of a mesh that a surface may pass through, with layers of cells about them, and their halo.
class NearCells {
public:
    NearCells(const MeshSource& source, std::string_view field, const SurfaceOptions& options)
        : source_(source), field_(field), options_(options) {
        const HexMesh* const mesh = source.mesh();
        if (mesh == nullptr) {
            source.check_halo(kHaloOfLimit, "values of the limit");
            return;
        }
        validate(*mesh);
        tagged_.emplace(*mesh, options);
        whole_ = limit_extent(*mesh);
        candidates_ = surface_candidates(tagged_->mesh(), field, tagged_->options);
    }

    /// The extent of the whole mesh, known after the first call of `find`.
    [[nodiscard]] const LimitExtent& whole() const { return whole_; }
    /// The mesh in memory with its creases; null if it is in pieces.
    [[nodiscard]] const HexMesh* mesh() const { return tagged_ ? &tagged_->mesh() : nullptr; }
    /// For the cells that are found.
    [[nodiscard]] const SurfaceOptions& options() const { return tagged_ ? tagged_->options : options_; }
    [[nodiscard]] int most_layers() const {
        return tagged_ ? kMostLayers + first_layers(options_) : source_.stored().halo_layers;
    }

    /// returns: nothing if the surface passes no cell
    [[nodiscard]] std::optional<NearSurface> find(int layers) { return tagged_ ? in_memory(layers) : gathered(layers); }

private:
    [[nodiscard]] std::optional<NearSurface> in_memory(int layers) const {
        std::vector<std::uint8_t> wanted = candidates_;
        if (std::ranges::find(wanted, 1) == wanted.end()) return {};
        grow(tagged_->mesh(), wanted, layers);
        std::vector<std::uint8_t> kept = wanted;
        grow(tagged_->mesh(), kept, kHaloOfLimit);
        MeshSubset part = subset(tagged_->mesh(), kept);
        NearSurface near{std::move(part.mesh), {}, {part.cells.begin(), part.cells.end()}};
        for (const Index c : part.cells) near.owned.push_back(wanted[c]);
        return near;
    }

    [[nodiscard]] std::optional<NearSurface> gathered(int layers) {
        const std::vector<std::uint64_t> wanted = wanted_cells(layers);
        if (wanted.empty()) return {};
        const auto chosen = [&](const MeshPiece& piece) {
            std::vector<std::uint8_t> flags = piece.owned_cells;
            for (std::size_t c = 0; c < flags.size(); ++c) {
                flags[c] = flags[c] && std::ranges::binary_search(wanted, piece.cell_numbers[c]);
            }
            return flags;
        };
        MeshPiece all = *gather_cells(source_.stored(), {.reads = [](std::size_t) { return true; },
                                                         .chooses = chosen,
                                                         .layers = kHaloOfLimit,
                                                         .progress = options_.progress});
        return NearSurface{std::move(all.mesh), std::move(all.owned_cells), std::move(all.cell_numbers)};
    }

    /// The numbers of the candidates of all pieces, and of `layers` of cells about them.
    [[nodiscard]] std::vector<std::uint64_t> wanted_cells(int layers) {
        SurfaceOptions quiet = options_;
        quiet.progress = nullptr;
        std::vector<std::uint64_t> wanted;
        whole_ = {};
        for_each_piece(source_.stored(), "look", options_.progress, [&](std::size_t, const MeshPiece& piece) {
            whole_.add(limit_extent(piece.mesh));
            std::vector<std::uint8_t> flags = surface_candidates(piece.mesh, field_, quiet);
            for (std::size_t c = 0; c < flags.size(); ++c) flags[c] = flags[c] && piece.owned_cells[c];
            grow(piece.mesh, flags, layers);
            for (std::size_t c = 0; c < flags.size(); ++c) {
                if (flags[c]) wanted.push_back(piece.cell_numbers[c]);
            }
        });
        std::ranges::sort(wanted);
        wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
        return wanted;
    }

    const MeshSource& source_;
    std::string_view field_;
    const SurfaceOptions& options_;
    std::optional<Tagged> tagged_;          // of a mesh in memory
    std::vector<std::uint8_t> candidates_;  // of a mesh in memory: a flag for each cell
    LimitExtent whole_;
};

/// The surface cut from the owned cells of a part: the same bits as from the whole. Nothing if it leads into other cells.
std::optional<LimitSurface> surface_of(const HexMesh& part, std::span<const std::uint8_t> owned, const LimitExtent& whole,
                                       std::string_view field, const SurfaceOptions& options) {
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

LimitSurface no_surface(const HexMesh* mesh) {
    LimitSurface none;
    none.report.converged = true;
    if (mesh == nullptr) return none;
    for (const Attribute& attribute : mesh->attributes) {
        none.fields.push_back({attribute.name, static_cast<std::size_t>(attribute.channels), {}, {}});
    }
    return none;
}

}  // namespace

LimitSurface limit_surface(const MeshSource& source, std::string_view field, const SurfaceOptions& options) {
    check_surface_options(options);
    NearCells cells(source, field, options);
    for (int layers = first_layers(options); layers <= cells.most_layers(); ++layers) {
        const std::optional<NearSurface> near = cells.find(layers);
        if (!near) return no_surface(source.mesh());
        auto surface = surface_of(near->mesh, near->owned, cells.whole(), field, cells.options());
        if (!surface) continue;
        for (LimitQuery& place : surface->places) near->rename(place);
        return std::move(*surface);
    }
    if (cells.mesh() != nullptr) return *surface_of(*cells.mesh(), {}, cells.whole(), field, cells.options());
    throw Error(ErrorCode::InvalidInput, "an isosurface leads farther than the halo of its bricks", source.stored().name,
                "split with a larger --halo");
}

SurfaceShareBytes detail::share_of_surface(const MeshSource& source, std::string_view field, const SurfaceOptions& options,
                                           const Share& share) {
    check_surface_options(options);
    NearCells cells(source, field, options);
    const std::optional<NearSurface> near = cells.find(layers_of_shares(options));
    if (!near) return {empty_surface_share()};
    const Tagged tagged(near->mesh, cells.options());
    const SurfaceMaker maker(tagged.mesh(), near->owned, cells.whole(), field, tagged.options);
    SurfaceShare made{.improve = options.improve, .slack_world = tolerance_world(options, cells.whole())};
    ShareRange range;
    std::vector<LimitQuery> places;
    for (const Cut& cut : cuts_of(options)) {
        std::optional<SettledCut> one = maker.make(cut, share);
        if (!one) {
            throw Error(ErrorCode::InvalidInput, "an isosurface leads farther than its shares look",
                        source.mesh() != nullptr ? "surface" : source.stored().name, "one process: without --part and mpirun");
        }
        range = {range.begin + one->range.begin, range.end + one->range.end, range.count + one->range.count};
        places.insert(places.end(), one->settled.places.begin(), one->settled.places.end());
        for (LimitQuery& place : one->settled.places) near->rename(place);
        made.cuts.push_back(std::move(*one));
    }
    made.fields = maker.fields_at(places);
    return {bytes_of(made), range};
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
