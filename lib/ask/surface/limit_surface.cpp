// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "hull_cut.h"
#include "settled_cut.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/limit_place.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/surface_share.h"
#include "subvol/detail/word_hash.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "surface_shape.h"

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

namespace subvol::detail {

namespace {

/// Makes the surfaces of a mesh, or shares of them: at the level that their tolerance asks for, their points on the limit.
class SurfaceMaker {
public:
    /// mesh:  may be a part of another one, whose extent is `whole`. It, its flags and the options are kept by reference
    /// owned: a flag for each cell that may be cut; empty: all
    SurfaceMaker(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& whole, std::string_view field,
                 const SurfaceOptions& options);

    /// One share of a surface: a range of the cells that it passes. All shares find the same level. Nothing if the surface
    /// leads into a cell that is not owned.
    [[nodiscard]] std::optional<SettledCut> make(const Cut& cut, const Share& share) const;

private:
    [[nodiscard]] SettledCut make_hull(const Share& share) const;
    [[nodiscard]] std::vector<double> scaled_values(double bend_world) const;
    [[nodiscard]] LimitExtent extent_of_field() const;
    void add_fields(SettledPoints& settled) const;
    [[nodiscard]] bool has_constant_fields() const;
    [[nodiscard]] int next_level(int level, double deviation, double triangles) const;

    const HexMesh& mesh_;
    const SurfaceOptions& options_;
    LimitExtent whole_;
    std::optional<std::size_t> field_;
    Topology topology_;
    HexMesh scalar_;
    std::span<const std::uint8_t> owned_;
    SoupCutter cutter_;
    std::optional<PointSettler> settler_;  // nothing if the boundary alone is made, of a scheme that interpolates
    double tolerance_world_;
};

constexpr int kFirstLevel = 1;

constexpr double kOfRange = 4;  // fields bend by no more than so many tolerances of their range: a step of 8-bit colours

constexpr std::size_t kPointsAtOnce = std::size_t{1} << 20;  // points whose fields are evaluated at a time

constexpr std::size_t kMostLookedAt = 2048;  // cells that decide the level: their 100,000 edges stand for those of all

/// About so many of the cells, one at random of each of as many runs of them.
std::vector<Index> some_of(const std::vector<Index>& cells) {
    const std::size_t run = (cells.size() + kMostLookedAt - 1) / kMostLookedAt;
    std::vector<Index> some;
    for (std::size_t first = 0; first + run <= cells.size(); first += run) some.push_back(cells[first + mixed(first) % run]);
    return some;
}

/// The mesh with one of its attributes, or with none.
HexMesh with_field_only(const HexMesh& mesh, std::optional<std::size_t> field) {
    HexMesh scalar{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
    if (field) scalar.attributes.push_back(mesh.attributes[*field]);
    return scalar;
}

/// The number of the field that isosurfaces are of; nothing if there are none.
std::optional<std::size_t> number_of_field(const HexMesh& mesh, std::string_view name, const SurfaceOptions& options) {
    if (options.isos.empty()) return std::nullopt;
    return static_cast<std::size_t>(&scalar_field(mesh, name) - mesh.attributes.data());
}

/// The number of the field that points are settled with, if there is one: that of the isosurfaces, or the only one of the mesh,
/// which then needs no evaluation of its own.
std::optional<std::size_t> number_of_settled_field(const HexMesh& mesh, std::string_view name, const SurfaceOptions& options) {
    const bool only = mesh.attributes.size() == 1 && mesh.attributes[0].channels == 1;
    return options.isos.empty() && only ? std::optional<std::size_t>(0) : number_of_field(mesh, name, options);
}

/// What is to be cut out, one after the other.
std::vector<Cut> cuts_of(const SurfaceOptions& options) {
    std::vector<Cut> cuts;
    for (const double iso : options.isos) cuts.push_back({iso, options.cap});
    if (options.boundary) cuts.push_back({{}, true});
    return cuts;
}

/// How far triangles may lie from the limit.
double tolerance_world(const SurfaceOptions& options, const LimitExtent& whole) {
    const Vec3 size = whole.box.size();
    return options.tolerance * std::max({size.x, size.y, size.z, 1e-300});
}

SurfaceMaker::SurfaceMaker(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& whole,
                           std::string_view field, const SurfaceOptions& options)
    : mesh_(mesh),
      options_(options),
      whole_(whole),
      field_(number_of_settled_field(mesh, field, options)),
      topology_(build_topology(mesh)),
      scalar_(with_field_only(mesh, field_)),
      owned_(owned),
      cutter_(scalar_, topology_, owned, options.scheme, options.progress),
      tolerance_world_(tolerance_world(options, whole)) {
    if (options.isos.empty() && interpolates(options.scheme.kind)) return;
    settler_.emplace(scalar_, topology_, extent_of_field(), options.scheme, options.progress);
}

LimitExtent SurfaceMaker::extent_of_field() const {
    LimitExtent extent{.box = whole_.box, .cell = whole_.cell};
    if (field_) extent.ranges.push_back(whole_.ranges[*field_]);
    return extent;
}

/// The level to go on with, as far as options allow; the same one if there is none.
///
/// triangles: of the whole surface at this level
int SurfaceMaker::next_level(int level, double deviation, double triangles) const {
    const double more = std::log2(std::max(deviation / tolerance_world_, 1e-9)) / 2;
    const int wanted = level + std::max(0, static_cast<int>(std::ceil(more - 0.05)));
    int next = std::min(wanted, options_.max_level);
    while (next > level && triangles * std::pow(4.0, next - level) > static_cast<double>(options_.max_triangles)) --next;
    return next;
}

/// A surface that passes few cells is cut as a whole at each level; of others some cells are looked at until the level is
/// known.
std::optional<SettledCut> SurfaceMaker::make(const Cut& cut, const Share& share) const {
    if (!cut.iso && interpolates(options_.scheme.kind)) return make_hull(share);
    SettledCut made{.level = std::min(kFirstLevel, options_.max_level), .soup = {}, .settled = {}};
    const int first_level = made.level;
    SurfaceSoup first = cutter_.cut(cut, first_level, cutter_.candidates(cut));
    if (first.leads_out) return {};
    const std::vector<Index> active = first.cells;
    const bool few = active.size() <= kMostLookedAt;
    const std::vector<Index> some = few ? std::vector<Index>() : some_of(active);
    made.soup = few ? std::move(first) : cutter_.cut(cut, first_level, some, {.follow = false});
    const double part = few ? 1 : static_cast<double>(some.size()) / static_cast<double>(active.size());
    for (;;) {
        made.settled = settler_->settle(made.soup, cut, made.level);
        made.deviation_world = settler_->deviation(made.soup, made.settled, made.level);
        const int next = next_level(made.level, made.deviation_world, static_cast<double>(made.soup.triangles.size()) / part);
        if (next == made.level) break;
        made.level = next;
        made.soup = cutter_.cut(cut, made.level, few ? made.soup.cells : some, {.follow = few});
        if (made.soup.leads_out) return {};
    }
    made.converged = made.deviation_world <= 1.1 * tolerance_world_;
    const std::vector<Index> all = few ? made.soup.cells : active;
    const auto [begin, end] = share.range(all.size());
    made.range = {begin, end, all.size()};
    if (few && share.whole()) {
        add_fields(made.settled);
        return made;
    }
    if (!few && share.whole() && made.level == first_level) {
        made.soup = std::move(first);
    } else {
        made.soup = cutter_.cut(cut, made.level, {all.begin() + std::ptrdiff_t(begin), all.begin() + std::ptrdiff_t(end)},
                                {.not_into = all});
        if (made.soup.leads_out) return {};
    }
    made.settled = settler_->settle(made.soup, cut, made.level);
    add_fields(made.settled);
    return made;
}

/// The boundary alone, of a scheme that interpolates: every share makes all of it but for the fields.
SettledCut SurfaceMaker::make_hull(const Share& share) const {
    const double bend_world = (1 - kOfMending) * tolerance_world_ / kTriangleBend;
    const std::vector<double> values = scaled_values(bend_world);
    const HullLeaves hull = refine_hull(mesh_, topology_, owned_, options_.scheme,
                                        {.bend_world = bend_world,
                                         .fields = {values, values.size() / mesh_.points.size()},
                                         .max_level = options_.max_level,
                                         .max_triangles = options_.max_triangles,
                                         .progress = options_.progress});
    SettledCut made = hull_cut(hull, topology_, options_.max_level);
    made.deviation_world *= kTriangleBend;
    made.converged = made.deviation_world <= 1.1 * tolerance_world_;
    const std::size_t count = made.soup.cells.size();
    const auto [begin, end] = share.range(count);
    made.range = {begin, end, count};
    if (!share.whole()) made = part_of(made, made.range);
    add_fields(made.settled);
    return made;
}

/// For each point the channels of all fields that are limits of values and are wanted: kOfRange times the tolerance of a
/// field's range becomes the bend that is allowed.
std::vector<double> SurfaceMaker::scaled_values(double bend_world) const {
    struct Scaled {
        const Attribute* field;
        double scale;
    };
    std::vector<Scaled> fields;
    std::size_t channels = 0;
    for (std::size_t f = 0; options_.fields && f < mesh_.attributes.size(); ++f) {
        const Attribute& field = mesh_.attributes[f];
        const auto [low, high] = whole_.ranges[f];
        const double allowed = kOfRange * options_.tolerance * (high - low);
        if (field.function != nullptr || field.constant || !(allowed > 0)) continue;
        fields.push_back({&field, bend_world / allowed});
        channels += static_cast<std::size_t>(field.channels);
    }
    std::vector<double> values(channels * mesh_.points.size());
    std::size_t first = 0;
    for (const auto& [field, scale] : fields) {
        const auto count = static_cast<std::size_t>(field->channels);
        for (std::size_t p = 0; p < mesh_.points.size(); ++p) {
            for (std::size_t c = 0; c < count; ++c) values[p * channels + first + c] = scale * field->values[p * count + c];
        }
        first += count;
    }
    return values;
}

/// Evaluates the fields at settled points, if they are wanted and the settler has not done so.
void SurfaceMaker::add_fields(SettledPoints& settled) const {
    if (!options_.fields) settled.fields.clear();
    if (!options_.fields || settled.fields.size() == mesh_.attributes.size()) return;
    report_progress(options_.progress, "fields", 0);
    const std::vector<ProbedField> fields = fields_of(mesh_);
    settled.resize(settled.places.size(), fields);
    if (has_constant_fields()) {
        for (std::size_t f = 0; f < fields.size(); ++f) {
            std::ranges::fill(settled.fields[f].values, whole_.ranges[f][0]);
            std::ranges::fill(settled.fields[f].gradients, Vec3(0.0));
        }
        return;
    }
    const LimitEvaluator limit(mesh_, {.scheme = options_.scheme}, whole_);
    for (std::size_t begin = 0; begin < settled.places.size(); begin += kPointsAtOnce) {
        const std::size_t count = std::min(kPointsAtOnce, settled.places.size() - begin);
        const LimitSamples samples = limit.at(std::span(settled.places).subspan(begin, count));
        parallel_each(count, [&](std::size_t i) { take_fields(samples, i, Vec3(0.0), begin + i, settled.fields); });
    }
}

/// Whether each field has one value in all of the mesh, which its limit has, too.
bool SurfaceMaker::has_constant_fields() const {
    for (std::size_t f = 0; f < mesh_.attributes.size(); ++f) {
        if (mesh_.attributes[f].function != nullptr || whole_.ranges[f][0] != whole_.ranges[f][1]) return false;
    }
    return true;
}

}  // namespace

}  // namespace subvol::detail

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
    measure_surface(all.surface, all.report);
    return all;
}

/// Moves the points of the boundary of some cells to where they lie in the limit of the whole mesh.
///
/// cells: the number in the whole mesh of each cell that the surface was made of
void settle_in_whole(const HexMesh& whole, std::span<const Index> cells, const SchemeOptions& scheme, LimitSurface& surface) {
    std::vector<std::uint8_t> kept(whole.cells.size(), 0);
    for (const Index cell : cells) kept[cell] = 1;
    grow(whole, kept, kHaloOfLimit);
    const MeshSubset near = subset(whole, kept);
    std::vector<LimitQuery> queries = surface.places;
    for (LimitQuery& query : queries) {
        const auto at = std::ranges::lower_bound(near.cells, cells[query.cell]);
        query.cell = static_cast<Index>(at - near.cells.begin());
    }
    const LimitSamples samples = evaluate_limit(near.mesh, queries, {.scheme = scheme});
    surface.surface.points = samples.positions;
    for (LimitQuery& place : surface.places) place.cell = cells[place.cell];
    for (std::size_t f = 0; f < surface.fields.size(); ++f) {
        ProbedField& to = surface.fields[f];
        to.values = samples.attributes[f].values;
        for (std::size_t i = 0; i < to.gradients.size(); ++i)
            to.gradients[i] = world_gradient(samples.jacobians[i / to.channels], samples.attributes[f].derivatives[i]);
    }
    measure_surface(surface.surface, surface.report);
}

LimitSurface surface_of_cells(const MeshSource& source, std::string_view field, const SurfaceOptions& options) {
    const HexMesh* const whole = source.mesh();
    if (whole == nullptr || options.cells.size() != whole->cells.size()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.cells.size()) + " flags of cells", "surface",
                    "one for each cell of a mesh in memory");
    }
    validate(*whole);
    const MeshSubset part = subset(*whole, options.cells);
    SurfaceOptions of_part = options;
    of_part.cells = {};
    std::vector<CellSide> sides;
    for (const auto& [cell, side] : options.sides) {
        const auto at = std::ranges::lower_bound(part.cells, cell);
        if (at != part.cells.end() && *at == cell) sides.push_back({static_cast<Index>(at - part.cells.begin()), side});
    }
    of_part.sides = sides;
    LimitSurface surface = limit_surface(part.mesh, field, of_part);
    if (!options.isos.empty() || surface.places.empty()) return surface;
    settle_in_whole(*whole, part.cells, options.scheme, surface);
    return surface;
}

LimitSurface no_surface(const HexMesh* mesh, bool fields) {
    LimitSurface none;
    none.report.converged = true;
    if (mesh == nullptr || !fields) return none;
    for (const Attribute& attribute : mesh->attributes) {
        none.fields.push_back({attribute.name, static_cast<std::size_t>(attribute.channels), {}, {}});
    }
    return none;
}

}  // namespace

LimitSurface limit_surface(const MeshSource& source, std::string_view field, const SurfaceOptions& options) {
    check_surface_options(options);
    if (!options.cells.empty()) return surface_of_cells(source, field, options);
    if (!options.sides.empty()) {
        if (source.mesh() == nullptr)
            throw Error(ErrorCode::InvalidInput, "pieces of a mesh have no patches", source.stored().name, "the mesh itself");
        SurfaceOptions boundary = options;
        boundary.sides = {};
        boundary.isos.clear();
        boundary.improve = false;  // which joins triangles of several sides
        boundary.boundary = true;
        LimitSurface surface = limit_surface(source, field, boundary);
        keep_sides(surface, *source.mesh(), options.sides);
        return surface;
    }
    NearCells cells(source, field, options);
    for (int layers = first_layers(options); layers <= cells.most_layers(); ++layers) {
        const std::optional<NearSurface> near = cells.find(layers);
        if (!near) return no_surface(source.mesh(), options.fields);
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
    for (const Cut& cut : cuts_of(options)) {
        std::optional<SettledCut> one = maker.make(cut, share);
        if (!one) {
            throw Error(ErrorCode::InvalidInput, "an isosurface leads farther than its shares look",
                        source.mesh() != nullptr ? "surface" : source.stored().name, "one process: without --part and mpirun");
        }
        range = {range.begin + one->range.begin, range.end + one->range.end, range.count + one->range.count};
        for (LimitQuery& place : one->settled.places) near->rename(place);
        made.cuts.push_back(std::move(*one));
    }
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
