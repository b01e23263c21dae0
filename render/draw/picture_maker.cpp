// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_maker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "kernel_levels.h"
#include "picture_facts.h"
#include "sheet_error.h"
#include "subvol/boundary_shading.h"
#include "subvol/detail/limit_words.h"
#include "subvol/detail/mesh_bodies.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/points_frame.h"
#include "subvol/draw_shells.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit.h"
#include "subvol/progressive.h"
#include "subvol/rbf_field.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_tets.h"
#include "subvol/sample_tables.h"
#include "subvol/splat_shares.h"

// What the methods share, from the top of the picture to its bottom:
//
//   style.look ──▶ light ──┬──▶ splat, sheets, footprints: in the splatter, or ──▶ the boundary's own colours (painted)
//                          └──▶ tets, pt, dense: of the boundary, over the finished picture (solids only)
//   levels ──▶ kernels: instead of the limit · tets, pt: 1 by default · dense: none are raised until nothing changes
//   an opaque solid, by splats: skin ──▶ first hits of the rays; at cuts kernels ──▶ values there
//   body   ──▶ kernels ──▶ levels of detail ──▶ splatters     refined mesh ──▶ tetrahedra     skin: values on the boundary

namespace subvol {
namespace {

/// The level of the tetrahedra by default: of more cells those of level 1 would take gigabytes (4.8 kB a cell), and the cells
/// themselves are nearer to the limit than a picture shows (68 dB of a million).
int tets_level(std::uint64_t cells) {
    constexpr std::uint64_t kMostCells = 300'000;
    return cells <= kMostCells ? 1 : 0;
}

/// Moves the knots of opacities and of colours down.
TransferFunction less(TransferFunction function, const std::array<double, 2>& origins) {
    for (auto& knot : function.opacity) knot.value -= origins[0];
    for (auto& knot : function.color) knot.value -= origins[1];
    return function;
}

/// Moves the values of the opacities and those of the colours down.
void move_down(HexMesh& mesh, const std::array<double, 2>& origins) {
    const auto move = [](Attribute& field, double origin) {
        detail::change_values(field, [origin](double value) { return value - origin; });
    };
    move(mesh.attributes.front(), origins[0]);
    if (mesh.attributes.size() > 1) move(mesh.attributes.back(), origins[1]);
}

/// The value that those of kernels are relative to, in 32-bit floats: the middle of a transfer function's range, where it is so
/// narrow that floats would round away what one sees in it (101325 ± .01); else 0, and values keep their bits.
double origin_for(double low, double high) {
    constexpr double kMostRounding = 1e-4, kHalfDigit = 0x1p-25;  // a fortieth of a step of 8 bits
    const double largest = std::max(std::abs(low), std::abs(high));
    return low < high && largest * kHalfDigit > kMostRounding * (high - low) ? low + (high - low) / 2 : 0;
}

SplatMethod splat_method(Method method, SplatMethod otherwise) {
    if (method == Method::Sheets) return SplatMethod::Sheets;
    return method == Method::Footprints ? SplatMethod::Footprints : otherwise;
}

/// A splatter for each way of drawing: method, samples, the part of the light at the eye (-1: not lit), and the kernels that it
/// was made for.
using SplatterKey = std::tuple<Method, int, double, const RbfVolume*>;
struct KeptSplatter {
    SplatterKey key;
    Splatter splatter;
    std::size_t version = 0;  // of the kernels that it draws
};

/// What pictures of kernels share. Later members refer to earlier ones, so it is never cleared in part.
struct PreparedKernels {
    /// Kernels have the values of a mesh less these: of opacities, and of colours.
    std::array<double, 2> origins{};
    /// The mesh in memory and the values on its boundary less these, where they are not 0.
    std::optional<HexMesh> relative_mesh{};
    std::optional<BoundaryValues> relative_skin{};
    std::optional<RbfVolume> volume{};
    std::optional<RbfField> at_cuts{};  // the values of colours
    std::optional<detail::KernelLevels> levels{};
    std::vector<KeptSplatter> splatters{};
};

/// What pictures of tetrahedra share.
struct PreparedCells {
    std::optional<TetsRenderer> tets{};
    std::optional<ProjectedRenderer> projected{};
};

/// What pictures of a mesh in pieces share.
struct PreparedPieces {
    std::optional<Surface> boundary{};
    std::optional<BrickTets> tets{};
};

/// What was made of a body, for each family of methods; a picture of another method of the same body finds it again.
struct Prepared {
    std::optional<BoundaryValues> skin{};
    std::optional<Box> skin_box{};   // of its points
    std::optional<MeshHull> hull{};  // of a mesh in pieces, for as long as something is made of it
    PreparedCells cells{};
    PreparedPieces pieces{};
    std::optional<PreparedKernels> kernels{std::in_place};  // others where the origins change
    bool range_seen = false;                                // whether the range of what is drawn was looked at
};

}  // namespace

BodyKind PictureBody::kind() const {
    if (mesh && mesh->mesh() == nullptr) return BodyKind::Bricks;
    if (voxels != nullptr) return BodyKind::Voxels;
    if (file != nullptr) return BodyKind::KernelFile;
    if (kernels != nullptr) return BodyKind::Kernels;
    return tets ? BodyKind::Tets : BodyKind::Mesh;
}

struct PictureMaker::State {
    PictureBody body;
    MethodOptions options;
    PictureTeam* team;

    std::optional<BoundaryTables> tables{};           // of the cells of the body; made when it is moved
    std::optional<SampleTables> kernel_tables{};      // likewise
    bool bodies_seen = false;                         // whether a picture was looked at for bodies that are too small in it
    std::optional<Prepared> prepared{std::in_place};  // of the body; destroyed as a whole with it

    void set_body(PictureBody next) {
        if (body.shape != next.shape || next.shape == 0) {
            tables.reset();
            kernel_tables.reset();
        }
        body = std::move(next);
        const std::array<double, 2> origins = prepared->kernels->origins;
        prepared.emplace();
        prepared->kernels->origins = origins;
        bodies_seen = body.moved;  // which bodies there are does not change, and moving has to be fast
    }

    [[nodiscard]] std::array<double, 2> origins_for(const Optics& optics) const {
        if (!body.mesh || !draws_kernels(method())) return prepared->kernels->origins;
        const TransferFunction& function = optics.function();
        std::array<double, 4> ends{function.opacity.front().value, function.opacity.back().value, function.color.front().value,
                                   function.color.back().value};
        if (mesh() == nullptr || mesh()->attributes.size() == 1) {  // opacities and colours are of the same values
            ends[0] = ends[2] = std::min(ends[0], ends[2]);
            ends[1] = ends[3] = std::max(ends[1], ends[3]);
        }
        return {origin_for(ends[0], ends[1]), origin_for(ends[2], ends[3])};
    }
    /// Decides on the origins of kernels; kernels with others are given up.
    void settle_origins(const Optics& optics) {
        const std::array<double, 2> next = origins_for(optics);
        if (next == prepared->kernels->origins) return;
        prepared->kernels.emplace();
        prepared->kernels->origins = next;
    }
    [[nodiscard]] bool is_relative() const { return body.mesh && prepared->kernels->origins != std::array<double, 2>{}; }

    const HexMesh& mesh_of_kernels() {
        if (!is_relative()) return *mesh();
        if (!prepared->kernels->relative_mesh) {
            prepared->kernels->relative_mesh = *mesh();
            move_down(*prepared->kernels->relative_mesh, prepared->kernels->origins);
        }
        return *prepared->kernels->relative_mesh;
    }
    const BoundaryValues& skin_of_kernels() {
        if (!is_relative()) return *prepared->skin;
        if (!prepared->kernels->relative_skin) {
            prepared->kernels->relative_skin = *prepared->skin;
            for (double& value : prepared->kernels->relative_skin->values.back()) value -= prepared->kernels->origins[1];
        }
        return *prepared->kernels->relative_skin;
    }
    [[nodiscard]] Optics optics_of_kernels(const Optics& optics) const {
        return is_relative() ? Optics(less(optics.function(), prepared->kernels->origins), optics.opacity_unit()) : optics;
    }

    /// Warns of bodies that the first picture can hardly show.
    void warn_of_tiny_bodies(const View& view, Facts& facts) {
        if (std::exchange(bodies_seen, true) || mesh() == nullptr) return;
        const std::vector<Box> boxes = detail::boxes_of_bodies(*mesh());
        const std::size_t tiny = detail::count_tiny_bodies(boxes, view);
        if (tiny == 0) return;
        facts.warn(std::to_string(tiny) + " of " + std::to_string(boxes.size()) +
                   " bodies in the picture are smaller than a pixel and may not be seen: a larger picture or a nearer camera "
                   "shows them");
    }

    /// Warns if the values on the boundary, or those of kernels at places of the limit, leave the range of the mesh.
    void warn_of_range(Facts& facts) {
        if (!body.of_file || mesh() == nullptr || mesh()->attributes.empty() || std::exchange(prepared->range_seen, true))
            return;
        const Attribute& field = mesh()->attributes.back();
        if (field.derived || field.channels != 1 || own_values(field).empty()) return;
        double least = std::numeric_limits<double>::infinity(), most = -least;
        const auto look = [&](const auto& values, double origin) {
            if (values.empty()) return;
            const auto [low, high] = std::ranges::minmax(values);
            least = std::min(least, low + origin);
            most = std::max(most, high + origin);
        };
        if (prepared->skin) look(prepared->skin->values.back(), 0);
        if (prepared->kernels->volume && options.kernels.are_plain() && !prepared->kernels->volume->channels.empty())
            look(prepared->kernels->volume->channels.back().values, is_relative() ? prepared->kernels->origins[1] : 0);
        const FieldRange range = range_of(field);
        facts.warn(detail::range_words(field.name, range.min[0], range.max[0], least, most, options.names, true));
    }

    /// The mesh, if the body is one in memory; else null.
    [[nodiscard]] const HexMesh* mesh() const { return body.mesh ? body.mesh->mesh() : nullptr; }
    [[nodiscard]] bool is_in_pieces() const { return body.mesh && mesh() == nullptr; }

    [[nodiscard]] const SchemeOptions& scheme() const { return options.kernels.sample.scheme; }
    [[nodiscard]] Method method() const { return options.style.method; }
    [[nodiscard]] bool is_solid() const { return options.style.look.look == Look::Solid; }
    /// Whether a solid has opacities: then its surface is translucent, whatever the method.
    [[nodiscard]] bool is_translucent() const { return is_solid() && !options.style.look.opacity.empty(); }
    [[nodiscard]] bool is_finished() const { return team == nullptr || team->finishes(); }
    /// Whether the light of the boundary is added to finished pictures.
    [[nodiscard]] bool lights_boundary() const {
        return is_solid() && !draws_kernels(method()) && method() != Method::Grid && is_finished();
    }

    [[nodiscard]] bool paints_boundary() const {
        const LookOptions& look = options.style.look;
        return body.mesh && look.look == Look::Solid && look.opacity.empty() && !look.opacity_unit_world &&
               options.kernels.are_plain() && !options.drop_invisible && options.splat.sheets == 0 && options.splat.normalized;
    }
    /// Shadows and occlusion are those of the kernels: the boundary's own colours have none.
    [[nodiscard]] bool paints_splats() const {
        return paints_boundary() && !options.splat.shadows && options.splat.ambient_occlusion == 0;
    }

    [[nodiscard]] bool is_cut() const { return !options.style.clip.empty(); }

    /// Whether pictures of an opaque solid are made of the first hits of its rays alone, where no ray begins inside. Options of
    /// kernels and sheets ask for those. At a cut kernels give the values.
    [[nodiscard]] bool may_show_first_hits() const {
        const SplatMethod splats = options.splat.method;
        return paints_splats() && method() == Method::Splat && (splats == SplatMethod::Auto || splats == SplatMethod::Cpu) &&
               options.style.clip.slices.empty() && (!is_cut() || !is_in_pieces()) && !options.seconds && !options.lod &&
               !options.image_tolerance && !options.splat.device && (!prepared->skin || !prepared->skin->values.empty());
    }
    /// Whether the eye, or the plane of parallel rays, lies before the whole boundary.
    [[nodiscard]] bool shows_first_hits(const View& view) {
        if (!may_show_first_hits()) return false;
        const std::vector<Vec3>& points = prepared->skin->surface.points;
        if (!prepared->skin_box) {
            prepared->skin_box.emplace();
            for (const Vec3& point : points) prepared->skin_box->add(point);
        }
        constexpr double kBefore = 0.01;  // of the diagonal; rays of perspective begin at a hundredth of it
        const Box& box = *prepared->skin_box;
        const auto is_before = [&, least = kBefore * box.diagonal()](const Vec3& point) {
            return view.to_eye(point).z > least;
        };
        const auto corner = [&](int k) {
            const auto end = [&](int axis) { return (k >> axis & 1) != 0 ? box.upper[axis] : box.lower[axis]; };
            return Vec3(end(0), end(1), end(2));
        };
        bool all = true;
        for (int k = 0; k < 8; ++k) all = all && is_before(corner(k));
        return all || std::ranges::all_of(points, is_before);
    }

    /// A mesh in pieces gets the colours of its boundary when all rows are there.
    [[nodiscard]] bool paints_finished() const { return draws_kernels(method()) && paints_splats() && is_finished(); }

    [[nodiscard]] RefineOptions refinement(int level, Progress* progress) const {
        return {.scheme = scheme(), .levels = level, .progress = progress};
    }

    /// As boundary_values has it, up to rounding where the body has been moved.
    const BoundaryValues& skin_of_mesh(Progress* progress, Facts& facts) {
        if (prepared->skin) return *prepared->skin;
        const auto refine = [&](const auto& hull_or_mesh) {
            const std::optional<int> most = body.tets ? std::optional(0) : options.kernels.levels;
            return refinement(picture_levels(hull_or_mesh, most), progress);
        };
        if (is_in_pieces()) {
            const MeshHull& all = hull_of_pieces(progress, facts);
            prepared->skin = facts.timed(progress, "boundary", [&] { return boundary_values(all, refine(all)); });
            return *prepared->skin;
        }
        prepared->skin = facts.timed(progress, "boundary", [&] {
            if (!body.moved) return boundary_values(*mesh(), refine(*mesh()));
            if (!tables) tables.emplace(*mesh(), refine(*mesh()));
            return tables->apply(*mesh());
        });
        return *prepared->skin;
    }

    const RbfVolume& kernels(const Optics& optics, Progress* progress, Facts& facts) {
        if (body.kernels != nullptr) return *body.kernels;
        if (prepared->kernels->volume) return *prepared->kernels->volume;
        KernelOptions choices = options.kernels;
        choices.tets = body.tets;
        choices.progress = progress;
        if (options.drop_invisible && !choices.visible) choices.visible = optics.function();
        if (choices.visible && is_relative()) choices.visible = less(*choices.visible, prepared->kernels->origins);
        SampleOptions sample = choices.sample;
        sample.progress = progress;
        if (body.moved && !choices.tets && !choices.levels && !choices.visible && choices.reduce_rmse == 0 &&
            SampleTables::are_for(sample)) {
            prepared->kernels->volume = facts.timed(progress, "sample", [&] {
                if (!kernel_tables) kernel_tables.emplace(*mesh(), sample);
                return kernel_tables->apply(mesh_of_kernels()).volume;
            });
            return *prepared->kernels->volume;
        }
        prepared->kernels->volume = facts.unpack(make_mesh_kernels(mesh_of_kernels(), choices));
        return *prepared->kernels->volume;
    }

    const MeshHull& hull_of_pieces(Progress* progress, Facts& facts) {
        if (!prepared->hull) prepared->hull = facts.timed(progress, "hull", [&] { return gather_hull(*body.mesh, progress); });
        return *prepared->hull;
    }

    Facts prepare(const Optics& optics, Progress* progress) {
        check_method(method(), body.kind(), options.names);
        settle_origins(optics);
        Facts facts;
        if (is_translucent()) {
            if (!body.mesh) {
                throw Error(ErrorCode::InvalidInput, "of a solid are those of its surface, for which a mesh is needed",
                            option_name("opacity", options.names), "look volume");
            }
            if (!options.style.clip.slices.empty()) {
                throw Error(ErrorCode::InvalidInput, "slices lie in volumes and in opaque solids",
                            option_name("slice", options.names), "look volume, or no " + option_name("opacity", options.names));
            }
            (void)skin_of_mesh(progress, facts);
            prepared->hull.reset();
            return facts;
        }
        if (may_show_first_hits()) {
            (void)skin_of_mesh(progress, facts);
            if (is_cut()) prepare_cuts(optics, progress, facts);
            prepared->hull.reset();
        }
        if (!may_show_first_hits()) prepare_inside(optics, progress, facts);
        warn_of_range(facts);
        return facts;
    }

    /// The values inside a solid that is cut open.
    void prepare_cuts(const Optics& optics, Progress* progress, Facts& facts) {
        if (prepared->kernels->at_cuts) return;
        const RbfVolume& volume = kernels(optics, progress, facts);
        prepared->kernels->at_cuts.emplace(volume, RbfFieldOptions{.channel = shown_channels().back()});
    }

    /// What pictures need that show more than the first hits of a solid.
    void prepare_inside(const Optics& optics, Progress* progress, Facts& facts) {
        if (is_in_pieces()) {
            prepare_pieces(progress, facts);
        } else if (draws_kernels(method())) {
            if (options.seconds) return;
            if (paints_splats()) (void)skin_of_mesh(progress, facts);
            if (!prepared->kernels->levels && body.file != nullptr)
                prepared->kernels->levels.emplace(*body.file, body.channels, options.lod.value_or(0));
            if (!prepared->kernels->levels) {
                const RbfVolume& all = kernels(optics, progress, facts);
                prepared->kernels->levels.emplace(all, options.lod.value_or(0), shown_channels().front(), progress, facts);
            }
        } else if (method() == Method::Grid) {
            if (is_solid() && body.voxels->is_level_set()) {
                throw Error(ErrorCode::InvalidInput, "draws no surface, as which a level set is shown",
                            option_name("method", options.names) + " grid", "method splat; look volume shows its distances");
            }
        } else {
            prepare_cells(progress, facts);
        }
    }

    void prepare_cells(Progress* progress, Facts& facts) {
        const auto make_tets = [&](const auto& fine) {
            if (method() == Method::Tets) {
                prepared->cells.tets.emplace(fine, "", progress);
                facts.add_seconds("prepare", prepared->cells.tets->seconds_build());
            } else {
                prepared->cells.projected.emplace(fine, "", options.splat.device, progress);
                facts.add_seconds("prepare", prepared->cells.projected->seconds_build());
            }
        };
        const bool missing = (method() == Method::Tets && !prepared->cells.tets) ||
                             (method() == Method::Projected && !prepared->cells.projected);
        if (missing && body.tets) {
            make_tets(join_split_cells(*mesh()));
        } else if (missing) {
            const RefineOptions refine =
                refinement(options.kernels.levels.value_or(tets_level(mesh()->cells.size())), progress);
            make_tets(facts.unpack(refined_on_limit(*mesh(), refine, options.kernels.levels_option)));
        }
        if (lights_boundary()) (void)skin_of_mesh(progress, facts);
    }

    void prepare_pieces(Progress* progress, Facts& facts) {
        const bool by_kernels = draws_kernels(method());
        if (by_kernels ? paints_finished() : lights_boundary()) (void)skin_of_mesh(progress, facts);
        if (by_kernels && !prepared->pieces.boundary) {
            SampleOptions sample = options.kernels.sample;
            sample.progress = progress;
            const MeshHull& all = hull_of_pieces(progress, facts);
            prepared->pieces.boundary = facts.timed(progress, "boundary", [&] { return sample_boundary(all, sample); });
        }
        prepared->hull.reset();
        if (by_kernels || prepared->pieces.tets) return;
        const BrickTetsOptions tet_options = piece_tets_options(progress);
        prepared->pieces.tets = facts.timed(progress, "measure", [&] {
            return team != nullptr ? team->measure(*body.mesh, tet_options)
                                   : measure_tets(*body.mesh, tet_options, 0, body.mesh->stored().pieces.size());
        });
        facts["levels"] = tet_options.refine.levels;
        facts["cells"] = prepared->pieces.tets->tets / 6;
    }

    [[nodiscard]] std::uint64_t cells_of_pieces() const {
        std::uint64_t cells = 0;
        for (const PieceExtent& piece : body.mesh->stored().pieces) cells += piece.cells;
        return cells;
    }

    [[nodiscard]] BrickTetsOptions piece_tets_options(Progress* progress) const {
        return {.refine = refinement(options.kernels.levels.value_or(tets_level(cells_of_pieces())), progress),
                .tets = {.progress = progress},
                .memory_bytes = options.memory_bytes};
    }

    /// The channels of the kernels that are drawn: the shown one, and the one of the colours if that is another.
    [[nodiscard]] std::vector<std::size_t> shown_channels() const {
        if (body.kernels != nullptr && !body.channels.empty()) return body.channels;
        const std::size_t count = mesh() != nullptr         ? mesh()->attributes.size()
                                  : body.file != nullptr    ? body.channels.size()
                                  : body.kernels != nullptr ? body.kernels->channels.size()
                                                            : 1;
        return count > 1 ? std::vector<std::size_t>{0, count - 1} : std::vector<std::size_t>{0};
    }

    [[nodiscard]] SplatOptions splat_options(const Optics& optics) const {
        SplatOptions splat = options.splat;
        splat.method = splat_method(method(), options.splat.method);
        splat.samples = options.style.sample_count();
        splat.clip = options.style.clip;
        splat.progress = nullptr;
        if (options.image_tolerance) splat.image_tolerance = *options.image_tolerance;
        if (is_lit(options.style.look.look)) splat.shading = shading_for(optics.function());
        const std::vector<std::size_t> shown = shown_channels();
        splat.channel = shown.front();
        splat.color_channel.reset();
        if (shown.size() > 1) splat.color_channel = shown.back();
        return splat;
    }

    /// Whether splatters are made for all kernels, which are in memory.
    [[nodiscard]] bool draws_all_kernels() const {
        return team == nullptr && draws_kernels(method()) && !options.seconds && prepared->kernels->levels->all() != nullptr;
    }

    KeptSplatter& splatter(const RbfVolume& kernels, std::size_t version, const Optics& optics) {
        const SplatOptions splat = splat_options(optics);
        const SplatterKey key{method(), splat.samples, splat.shading ? splat.shading->head : -1, &kernels};
        for (KeptSplatter& kept : prepared->kernels->splatters) {
            if (kept.key == key) return kept;
        }
        return prepared->kernels->splatters.emplace_back(KeptSplatter{key, Splatter(kernels, splat), version});
    }

    /// Gives a splatter the colours that solids have on their boundary.
    void paint(Splatter& splatter) {
        const BoundaryValues none;
        const BoundaryValues& colors = paints_splats() ? skin_of_kernels() : none;
        if (colors.values.empty())
            splatter.set_boundary_colors(none.surface, {});
        else
            splatter.set_boundary_colors(colors.surface, colors.values.back());
    }

    Picture draw_splats(const View& view, const Optics& of_field, Progress* progress, const RbfVolume* stand_in) {
        Picture picture;
        const Optics optics = optics_of_kernels(of_field);
        const RbfVolume& shown =
            stand_in != nullptr ? *stand_in : prepared->kernels->levels->kernels(view, progress, picture.facts);
        SplatResult drawn;
        if (team != nullptr) {
            drawn = team->splat(shown, splat_options(optics), paints_splats() ? skin_of_kernels() : BoundaryValues{}, view,
                                optics, progress, picture.facts);
        } else {
            const bool in_memory = stand_in == nullptr && draws_all_kernels();
            KeptSplatter& kept = splatter(in_memory ? *prepared->kernels->levels->all() : shown,
                                          in_memory ? 0 : prepared->kernels->levels->version(), optics);
            if (stand_in == nullptr && kept.version != prepared->kernels->levels->version()) {
                kept.splatter.set_kernels(shown);
                kept.version = prepared->kernels->levels->version();
            }
            kept.splatter.set_clip(options.style.clip);
            paint(kept.splatter);
            drawn = kept.splatter.draw(view, optics, progress);
        }
        detail::add_facts(drawn.report, method(), picture.facts);
        if (!(options.lod.value_or(0) > 0)) picture.facts["points"] = drawn.report.points;
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        return picture;
    }

    /// Whether a picture is of sheets whose number its tolerance decides, and can be drawn again with more of them.
    [[nodiscard]] bool has_chosen_sheets() const {
        return (method() == Method::Splat || method() == Method::Sheets) && !is_translucent() && !is_in_pieces() &&
               team == nullptr && !options.seconds && options.splat.sheets == 0;
    }

    /// sheets: those of the picture
    detail::SheetError sheet_error(const Image& image, int sheets, const View& view, const Optics& of_field,
                                   Progress* progress) {
        const Optics optics = optics_of_kernels(of_field);
        Facts unsaid;
        const RbfVolume& shown = prepared->kernels->levels->kernels(view, progress, unsaid);
        Splatter finer(shown, detail::with_more_sheets(splat_options(optics), sheets));
        paint(finer);
        return detail::difference(image, finer.draw(view, optics, progress).image);
    }

    Picture draw_splats_in_time(const View& view, const Optics& optics, Progress* progress) {
        ProgressiveResult drawn = render_progressively(mesh_of_kernels(), view, optics_of_kernels(optics),
                                                       {.seconds = *options.seconds,
                                                        .sample = options.kernels.sample,
                                                        .splat = splat_options(optics),
                                                        .progress = progress});
        Picture picture{std::move(drawn.splat.image), std::move(drawn.splat.depth)};
        detail::add_facts(drawn.splat.report, method(), picture.facts);
        picture.facts["points"] = drawn.splat.report.points;
        picture.facts["steps"] = drawn.steps;
        picture.facts["picture_scale"] = drawn.picture_scale;
        picture.facts["footprint_px"] = drawn.footprint_px;
        return picture;
    }

    Picture draw_piece_splats(const View& view, const Optics& of_field, Progress* progress) const {
        Picture picture;
        const Optics optics = optics_of_kernels(of_field);
        const auto relative = [by = prepared->kernels->origins](HexMesh piece) {
            move_down(piece, by);
            return piece;
        };
        const MeshSource source = is_relative() ? body.mesh->changed(relative) : *body.mesh;
        BrickSplatOptions pieces{.sample = options.kernels.sample,
                                 .splat = splat_options(optics),
                                 .memory_bytes = options.memory_bytes,
                                 .scratch = {}};
        pieces.sample.progress = pieces.splat.progress = progress;
        if (team != nullptr) pieces.rows = team->rows(view.height());
        SplatResult drawn = picture.facts.timed(progress, "draw", [&] {
            if (team != nullptr) return team->splat(source, *prepared->pieces.boundary, pieces, view, optics, picture.facts);
            return render_bricks(source, *prepared->pieces.boundary, view, optics, pieces);
        });
        detail::add_facts(drawn.report, method(), picture.facts);
        picture.facts["points"] = drawn.report.points;
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        return picture;
    }

    Picture draw_tets(const View& view, const Optics& optics, Progress* progress) const {
        const TetsOptions tets_options{.samples = options.style.sample_count(),
                                       .clip = options.style.clip,
                                       .rows = team != nullptr ? team->rows(view.height()) : PixelRows{},
                                       .progress = progress};
        Picture picture;
        TetsResult drawn;
        if (is_in_pieces()) {
            BrickTetsOptions pieces = piece_tets_options(progress);
            pieces.tets = tets_options;
            drawn = render_tets(*body.mesh, *prepared->pieces.tets, view, optics, pieces);
            picture.facts.add_seconds("prepare", drawn.report.seconds_build);
        } else {
            drawn = prepared->cells.tets->draw(view, optics, tets_options);
        }
        std::array counts{drawn.report.rays, drawn.report.lost_rays};
        if (team != nullptr) team->add_up(counts);
        drawn.report.rays = counts[0];
        drawn.report.lost_rays = counts[1];
        detail::add_facts(drawn.report, picture.facts);
        picture.image = std::move(drawn.image);
        return picture;
    }

    Picture draw_projected(const View& view, const Optics& optics, Progress* progress) {
        ProjectedOptions projected_options{.order = options.order,
                                           .kbuffer = options.kbuffer,
                                           .lod = options.lod.value_or(1),
                                           .samples = options.style.sample_count(),
                                           .clip = options.style.clip};
        Picture picture;
        ProjectedResult drawn;
        if (options.seconds) {
            auto best =
                render_progressively(*prepared->cells.projected, view, optics,
                                     {.seconds = *options.seconds, .projected = projected_options, .progress = progress});
            projected_options.order = best.order;
            drawn = std::move(best.projected);
            picture.facts["steps"] = best.steps;
            picture.facts["finished"] = best.finished;
        } else {
            projected_options.progress = progress;
            drawn = prepared->cells.projected->draw(view, optics, projected_options);
        }
        detail::add_facts(drawn.report, projected_options.order, picture.facts);
        picture.image = std::move(drawn.image);
        return picture;
    }

    Picture draw_dense(const View& view, const Optics& optics, Progress* progress) const {
        const std::optional<int> level = options.kernels.levels;
        DenseResult drawn = render_dense(*mesh(), {}, view, optics,
                                         {.refine = refinement(0, progress),
                                          .levels = level,
                                          .max_levels = options.max_levels,
                                          .image_tolerance = options.image_tolerance,
                                          .samples = options.style.sample_count(),
                                          .clip = options.style.clip,
                                          .progress = progress});
        Picture picture{std::move(drawn.image)};
        detail::add_facts(drawn.report, level.has_value(), picture.facts);
        return picture;
    }

    Picture draw_grid(const View& view, const Optics& optics, Progress* progress) const {
        GridResult drawn =
            render_grid(*body.voxels, view, optics,
                        {.samples = options.style.sample_count(), .clip = options.style.clip, .progress = progress});
        Picture picture{std::move(drawn.image)};
        detail::add_facts(drawn.report, picture.facts);
        return picture;
    }

    /// The surface of a solid, one part of it seen through the other. Every process has all rows.
    Picture draw_translucent(const View& view, const Optics& optics) const {
        Picture picture{Image(view.width(), view.height())};
        picture.facts["method"] = name_of(method());
        picture.facts["backend"] = "cpu";
        picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
        ColoredSurface colored{prepared->skin->surface, prepared->skin->values.back()};
        for (const double value : prepared->skin->values.front())
            colored.opacities.push_back(static_cast<float>(alpha_at(optics.function(), value)));
        draw_shells(
            picture.image, picture.depth, colored, {}, view, optics,
            {.shading = shading_for(optics.function()), .samples = options.style.sample_count(), .clip = options.style.clip});
        return picture;
    }

    /// An opaque solid without its kernels; nothing if its boundary is not closed, as cells of both hands leave it: then rays
    /// seem to begin inside.
    std::optional<Picture> draw_first_hits(const View& view, const Optics& optics, Progress* progress) const {
        PixelRows rows;
        if (team != nullptr) {  // and some rows beside them, whose depths decide about lines that are drawn afterwards
            rows = team->rows(view.height());
            rows = {rows.first - kRowsOfTile, rows.end + kRowsOfTile};
        }
        Picture picture;
        BoundaryCut cut{.clip = options.style.clip};
        cut.value_at = [this](const Vec3& place) -> std::optional<double> {
            const std::optional<double> value = prepared->kernels->at_cuts->value(place);
            return value && is_relative() ? *value + prepared->kernels->origins[1] : value;
        };
        BoundaryPicture drawn = picture.facts.timed(progress, "draw", [&] {
            return draw_boundary(prepared->skin->surface, prepared->skin->values.back(), view, optics,
                                 shading_for(optics.function()), options.style.sample_count(), rows, progress, cut);
        });
        std::array inside{drawn.rays_inside};
        if (team != nullptr) team->add_up(inside);
        if (inside.front() > 0) return std::nullopt;
        detail::add_facts_of_first_hits(prepared->skin->surface, picture.facts);
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        return picture;
    }

    Picture drawn_rows(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
        if (is_translucent()) return draw_translucent(view, optics);
        switch (method()) {
            case Method::Splat:
            case Method::Sheets:
            case Method::Footprints:
                if (is_in_pieces()) return draw_piece_splats(view, optics, progress);
                return options.seconds ? draw_splats_in_time(view, optics, progress)
                                       : draw_splats(view, optics, progress, stand_in);
            case Method::Tets:
                return draw_tets(view, optics, progress);
            case Method::Projected:
                return draw_projected(view, optics, progress);
            case Method::Dense:
                return draw_dense(view, optics, progress);
            case Method::Grid:
                break;
        }
        return draw_grid(view, optics, progress);
    }

    /// Adds what the boundary gives to a finished picture: light, or for a mesh in pieces its colours.
    void finish(Picture& picture, const View& view, const Optics& optics) const {
        const int samples = options.style.sample_count();
        const Clip& clip = options.style.clip;
        if (is_translucent()) return;
        if (lights_boundary()) {
            light_boundary(picture.image, prepared->skin->surface, view, shading_for(optics.function()), samples, clip);
        } else if (is_in_pieces() && paints_finished() && !prepared->skin->values.empty()) {
            color_boundary(picture.image, prepared->skin->surface, prepared->skin->values.back(), view, optics,
                           shading_for(optics.function()), samples, clip);
        }
    }
};

PictureMaker::PictureMaker(PictureBody body, MethodOptions options, PictureTeam* team) {
    check_method(options.style.method, body.kind(), options.names);
    validate(options);
    state_ = std::make_unique<State>(State{.body = std::move(body), .options = std::move(options), .team = team});
}

PictureMaker::~PictureMaker() = default;
PictureMaker::PictureMaker(PictureMaker&&) noexcept = default;
PictureMaker& PictureMaker::operator=(PictureMaker&&) noexcept = default;

void PictureMaker::set_body(PictureBody body) {
    state_->set_body(std::move(body));
}

void PictureMaker::set_style(const PictureStyle& style) {
    validate(style, state_->options.names);
    state_->options.style = style;
}

Facts PictureMaker::prepare(const Optics& optics, Progress* progress, bool splatter) {
    Facts facts = state_->prepare(optics, progress);
    if (splatter && state_->prepared->kernels->levels && state_->draws_all_kernels())
        (void)state_->splatter(*state_->prepared->kernels->levels->all(), 0, optics);
    return facts;
}

Picture PictureMaker::draw(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
    Facts facts = state_->prepare(optics, progress);
    state_->warn_of_tiny_bodies(view, facts);
    std::optional<Picture> first_hits;
    if (state_->shows_first_hits(view)) first_hits = state_->draw_first_hits(view, optics, progress);
    if (!first_hits && state_->may_show_first_hits()) state_->prepare_inside(optics, progress, facts);
    Picture picture = first_hits ? std::move(*first_hits) : state_->drawn_rows(view, optics, progress, stand_in);
    if (state_->team != nullptr) state_->team->gather(picture);
    if (!first_hits) state_->finish(picture, view, optics);
    facts.merge(picture.facts);
    picture.facts = std::move(facts);
    return picture;
}

Facts PictureMaker::measure_error(const Picture& picture, const View& view, const Optics& optics, Progress* progress) {
    Facts facts;
    const FactValue* said = picture.facts.find("sheets");
    const auto* sheets = said == nullptr ? nullptr : std::get_if<std::int64_t>(&said->value);
    if (sheets == nullptr || *sheets < 2 || !state_->has_chosen_sheets()) return facts;
    const detail::SheetError error = facts.timed(progress, "error", [&] {
        return state_->sheet_error(picture.image, static_cast<int>(*sheets), view, optics, progress);
    });
    facts["image_error"] = error.rms;
    facts["image_error_max"] = error.largest;
    return facts;
}

std::vector<Vec3> PictureMaker::framed_points(const Optics& optics, Progress* progress, Facts& facts) {
    const Look look = state_->options.style.look.look;
    if (const HexMesh* mesh = state_->mesh()) return subvol::framed_points(*mesh, look, optics);
    const bool in_pieces = state_->is_in_pieces();
    if (look != Look::Solid) {
        if (!in_pieces) return {};
        return facts.timed(progress, "frame",
                           [&] { return subvol::framed_points(*state_->body.mesh, look, optics, progress); });
    }
    if (const RbfVolume* kernels = state_->body.kernels) return detail::outline_of(*kernels);
    if (KernelFile* file = state_->body.file) return file->boundary().points;
    if (!in_pieces) return {};
    return state_->hull_of_pieces(progress, facts).mesh.points;
}

bool PictureMaker::paints_boundary() const {
    return state_->paints_boundary();
}

const BoundaryValues& PictureMaker::skin(Progress* progress, Facts& facts) {
    return state_->skin_of_mesh(progress, facts);
}

const Surface& PictureMaker::boundary(const Optics& optics, Progress* progress, Facts& facts) {
    const bool of_kernels = draws_kernels(state_->method()) && !state_->is_translucent() && !state_->options.seconds &&
                            !state_->may_show_first_hits();
    state_->settle_origins(optics);
    return of_kernels ? state_->kernels(optics, progress, facts).boundary : state_->skin_of_mesh(progress, facts).surface;
}

bool PictureMaker::keeps_kernels(const Optics& optics) const {
    return state_->origins_for(optics) == state_->prepared->kernels->origins;
}

const RbfVolume& PictureMaker::kernels(const Optics& optics, Progress* progress, Facts& facts) {
    state_->settle_origins(optics);
    return state_->kernels(optics, progress, facts);
}

}  // namespace subvol
