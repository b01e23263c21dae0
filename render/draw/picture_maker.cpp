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
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_tets.h"
#include "subvol/sample_tables.h"

// What the methods share, from the top of the picture to its bottom:
//
//   style.look ──▶ light ──┬──▶ splat, sheets, footprints: in the splatter, or ──▶ the boundary's own colours (painted)
//                          └──▶ tets, pt, dense: of the boundary, over the finished picture (solids only)
//   levels ──▶ kernels: instead of the limit · tets, pt: 1 by default · dense: none are raised until nothing changes
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

    std::optional<BoundaryTables> tables{};       // of the cells of the body; made when it is moved
    std::optional<SampleTables> kernel_tables{};  // likewise
    std::optional<BoundaryValues> skin{};
    std::optional<RbfVolume> volume{};
    std::optional<detail::KernelLevels> levels{};
    std::optional<TetsRenderer> tets{};
    std::optional<ProjectedRenderer> projected{};
    std::optional<MeshHull> hull{};  // of a mesh in pieces, like the next two
    std::optional<Surface> piece_boundary{};
    std::optional<BrickTets> piece_tets{};
    // Kernels have the values of a mesh less these: of opacities, and of colours. Where they are not 0, a mesh in memory and
    // the values on its boundary are kept less these, too.
    std::array<double, 2> origins{};
    std::optional<HexMesh> relative_mesh{};
    std::optional<BoundaryValues> relative_skin{};
    bool range_seen = false;   // whether the range of what is drawn was looked at
    bool bodies_seen = false;  // whether a picture was looked at for bodies that are too small in it

    /// A splatter for each way of drawing: method, samples, the part of the light at the eye (-1: not lit), and the kernels
    /// that it was made for.
    using SplatterKey = std::tuple<Method, int, double, const RbfVolume*>;
    struct KeptSplatter {
        SplatterKey key;
        Splatter splatter;
        std::size_t version = 0;  // of the kernels that it draws
    };
    std::vector<KeptSplatter> splatters{};

    void set_body(PictureBody next) {
        splatters.clear();  // they refer to the kernels
        levels.reset();     // so do these
        if (body.shape != next.shape || next.shape == 0) {
            tables.reset();
            kernel_tables.reset();
        }
        body = std::move(next);
        skin.reset();
        volume.reset();
        tets.reset();
        projected.reset();
        hull.reset();
        piece_boundary.reset();
        piece_tets.reset();
        relative_mesh.reset();
        relative_skin.reset();
        range_seen = false;
        bodies_seen = body.moved;  // which bodies there are does not change, and moving has to be fast
    }

    [[nodiscard]] std::array<double, 2> origins_for(const Optics& optics) const {
        if (!body.mesh || !draws_kernels(method())) return origins;
        const TransferFunction& function = optics.function();
        std::array<double, 4> ends{function.opacity.front().value, function.opacity.back().value, function.color.front().value,
                                   function.color.back().value};
        if (mesh() == nullptr || mesh()->attributes.size() == 1) {  // opacities and colours are of the same values
            ends[0] = ends[2] = std::min(ends[0], ends[2]);
            ends[1] = ends[3] = std::max(ends[1], ends[3]);
        }
        return {origin_for(ends[0], ends[1]), origin_for(ends[2], ends[3])};
    }
    /// Decides on `origins`; kernels with others are given up.
    void settle_origins(const Optics& optics) {
        const std::array<double, 2> next = origins_for(optics);
        if (next == origins) return;
        origins = next;
        splatters.clear();
        levels.reset();
        volume.reset();
        relative_mesh.reset();
        relative_skin.reset();
    }
    [[nodiscard]] bool is_relative() const { return body.mesh && origins != std::array<double, 2>{}; }

    const HexMesh& mesh_of_kernels() {
        if (!is_relative()) return *mesh();
        if (!relative_mesh) {
            relative_mesh = *mesh();
            move_down(*relative_mesh, origins);
        }
        return *relative_mesh;
    }
    const BoundaryValues& skin_of_kernels() {
        if (!is_relative()) return *skin;
        if (!relative_skin) {
            relative_skin = *skin;
            for (double& value : relative_skin->values.back()) value -= origins[1];
        }
        return *relative_skin;
    }
    [[nodiscard]] Optics optics_of_kernels(const Optics& optics) const {
        return is_relative() ? Optics(less(optics.function(), origins), optics.opacity_unit()) : optics;
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
        if (!body.of_file || mesh() == nullptr || mesh()->attributes.empty() || std::exchange(range_seen, true)) return;
        const Attribute& field = mesh()->attributes.back();
        if (field.derived || field.channels != 1 || own_values(field).empty()) return;
        double least = std::numeric_limits<double>::infinity(), most = -least;
        const auto look = [&](const auto& values, double origin) {
            if (values.empty()) return;
            const auto [low, high] = std::ranges::minmax(values);
            least = std::min(least, low + origin);
            most = std::max(most, high + origin);
        };
        if (skin) look(skin->values.back(), 0);
        if (volume && options.kernels.are_plain() && !volume->channels.empty())
            look(volume->channels.back().values, is_relative() ? origins[1] : 0);
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

    /// A mesh in pieces gets the colours of its boundary when all rows are there.
    [[nodiscard]] bool paints_finished() const { return draws_kernels(method()) && paints_splats() && is_finished(); }

    [[nodiscard]] RefineOptions refinement(int level, Progress* progress) const {
        return {.scheme = scheme(), .levels = level, .progress = progress};
    }

    /// As boundary_values has it, up to rounding where the body has been moved.
    const BoundaryValues& skin_of_mesh(Progress* progress, Facts& facts) {
        if (skin) return *skin;
        const auto refine = [&](const auto& hull_or_mesh) {
            const std::optional<int> most = body.tets ? std::optional(0) : options.kernels.levels;
            return refinement(picture_levels(hull_or_mesh, most), progress);
        };
        if (is_in_pieces()) {
            const MeshHull& all = hull_of_pieces(progress, facts);
            skin = facts.timed(progress, "boundary", [&] { return boundary_values(all, refine(all)); });
            return *skin;
        }
        skin = facts.timed(progress, "boundary", [&] {
            if (!body.moved) return boundary_values(*mesh(), refine(*mesh()));
            if (!tables) tables.emplace(*mesh(), refine(*mesh()));
            return tables->apply(*mesh());
        });
        return *skin;
    }

    const RbfVolume& kernels(const Optics& optics, Progress* progress, Facts& facts) {
        if (body.kernels != nullptr) return *body.kernels;
        if (volume) return *volume;
        KernelOptions choices = options.kernels;
        choices.tets = body.tets;
        choices.progress = progress;
        if (options.drop_invisible && !choices.visible) choices.visible = optics.function();
        if (choices.visible && is_relative()) choices.visible = less(*choices.visible, origins);
        SampleOptions sample = choices.sample;
        sample.progress = progress;
        if (body.moved && !choices.tets && !choices.levels && !choices.visible && choices.reduce_rmse == 0 &&
            SampleTables::are_for(sample)) {
            volume = facts.timed(progress, "sample", [&] {
                if (!kernel_tables) kernel_tables.emplace(*mesh(), sample);
                return kernel_tables->apply(mesh_of_kernels()).volume;
            });
            return *volume;
        }
        volume = facts.unpack(make_mesh_kernels(mesh_of_kernels(), choices));
        return *volume;
    }

    const MeshHull& hull_of_pieces(Progress* progress, Facts& facts) {
        if (!hull) hull = facts.timed(progress, "hull", [&] { return gather_hull(*body.mesh, progress); });
        return *hull;
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
            hull.reset();
            return facts;
        }
        if (is_in_pieces()) {
            prepare_pieces(progress, facts);
        } else if (draws_kernels(method())) {
            if (options.seconds) return facts;
            if (paints_splats()) (void)skin_of_mesh(progress, facts);
            if (!levels && body.file != nullptr) levels.emplace(*body.file, body.channels, options.lod.value_or(0));
            if (!levels) {
                const RbfVolume& all = kernels(optics, progress, facts);
                levels.emplace(all, options.lod.value_or(0), shown_channels().front(), progress, facts);
            }
        } else if (method() == Method::Grid) {
            if (is_solid() && body.voxels->is_level_set()) {
                throw Error(ErrorCode::InvalidInput, "draws no surface, as which a level set is shown",
                            option_name("method", options.names) + " grid", "method splat; look volume shows its distances");
            }
        } else {
            prepare_cells(progress, facts);
        }
        warn_of_range(facts);
        return facts;
    }

    void prepare_cells(Progress* progress, Facts& facts) {
        const auto make_tets = [&](const auto& fine) {
            if (method() == Method::Tets) {
                tets.emplace(fine, "", progress);
                facts.add_seconds("prepare", tets->seconds_build());
            } else {
                projected.emplace(fine, "", options.splat.device, progress);
                facts.add_seconds("prepare", projected->seconds_build());
            }
        };
        const bool missing = (method() == Method::Tets && !tets) || (method() == Method::Projected && !projected);
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
        if (by_kernels && !piece_boundary) {
            SampleOptions sample = options.kernels.sample;
            sample.progress = progress;
            const MeshHull& all = hull_of_pieces(progress, facts);
            piece_boundary = facts.timed(progress, "boundary", [&] { return sample_boundary(all, sample); });
        }
        hull.reset();
        if (by_kernels || piece_tets) return;
        const BrickTetsOptions tet_options = piece_tets_options(progress);
        piece_tets = facts.timed(progress, "measure", [&] {
            return team != nullptr ? team->measure(*body.mesh, tet_options)
                                   : measure_tets(*body.mesh, tet_options, 0, body.mesh->stored().pieces.size());
        });
        facts["levels"] = tet_options.refine.levels;
        facts["cells"] = piece_tets->tets / 6;
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
        return team == nullptr && draws_kernels(method()) && !options.seconds && levels->all() != nullptr;
    }

    KeptSplatter& splatter(const RbfVolume& kernels, std::size_t version, const Optics& optics) {
        const SplatOptions splat = splat_options(optics);
        const SplatterKey key{method(), splat.samples, splat.shading ? splat.shading->head : -1, &kernels};
        for (KeptSplatter& kept : splatters) {
            if (kept.key == key) return kept;
        }
        return splatters.emplace_back(KeptSplatter{key, Splatter(kernels, splat), version});
    }

    Picture draw_splats(const View& view, const Optics& of_field, Progress* progress, const RbfVolume* stand_in) {
        Picture picture;
        const Optics optics = optics_of_kernels(of_field);
        const RbfVolume& shown = stand_in != nullptr ? *stand_in : levels->kernels(view, progress, picture.facts);
        const BoundaryValues none;
        const BoundaryValues& colors = paints_splats() ? skin_of_kernels() : none;
        SplatResult drawn;
        if (team != nullptr) {
            drawn = team->splat(shown, splat_options(optics), colors, view, optics, progress, picture.facts);
        } else {
            const bool in_memory = stand_in == nullptr && draws_all_kernels();
            KeptSplatter& kept = splatter(in_memory ? *levels->all() : shown, in_memory ? 0 : levels->version(), optics);
            if (stand_in == nullptr && kept.version != levels->version()) {
                kept.splatter.set_kernels(shown);
                kept.version = levels->version();
            }
            kept.splatter.set_clip(options.style.clip);
            if (colors.values.empty())
                kept.splatter.set_boundary_colors(none.surface, {});
            else
                kept.splatter.set_boundary_colors(colors.surface, colors.values.back());
            drawn = kept.splatter.draw(view, optics, progress);
        }
        detail::add_facts(drawn.report, method(), picture.facts);
        if (!(options.lod.value_or(0) > 0)) picture.facts["points"] = drawn.report.points;
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        return picture;
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
        const auto relative = [by = origins](HexMesh piece) {
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
            if (team != nullptr) return team->splat(source, *piece_boundary, pieces, view, optics, picture.facts);
            return render_bricks(source, *piece_boundary, view, optics, pieces);
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
            drawn = render_tets(*body.mesh, *piece_tets, view, optics, pieces);
            picture.facts.add_seconds("prepare", drawn.report.seconds_build);
        } else {
            drawn = tets->draw(view, optics, tets_options);
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
            auto best = render_progressively(
                *projected, view, optics, {.seconds = *options.seconds, .projected = projected_options, .progress = progress});
            projected_options.order = best.order;
            drawn = std::move(best.projected);
            picture.facts["steps"] = best.steps;
            picture.facts["finished"] = best.finished;
        } else {
            projected_options.progress = progress;
            drawn = projected->draw(view, optics, projected_options);
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
        ColoredSurface colored{skin->surface, skin->values.back()};
        for (const double value : skin->values.front())
            colored.opacities.push_back(static_cast<float>(alpha_at(optics.function(), value)));
        draw_shells(
            picture.image, picture.depth, colored, {}, view, optics,
            {.shading = shading_for(optics.function()), .samples = options.style.sample_count(), .clip = options.style.clip});
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
            light_boundary(picture.image, skin->surface, view, shading_for(optics.function()), samples, clip);
        } else if (is_in_pieces() && paints_finished() && !skin->values.empty()) {
            color_boundary(picture.image, skin->surface, skin->values.back(), view, optics, shading_for(optics.function()),
                           samples, clip);
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
    if (splatter && state_->levels && state_->draws_all_kernels()) (void)state_->splatter(*state_->levels->all(), 0, optics);
    return facts;
}

Picture PictureMaker::draw(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
    Facts facts = state_->prepare(optics, progress);
    state_->warn_of_tiny_bodies(view, facts);
    Picture picture = state_->drawn_rows(view, optics, progress, stand_in);
    if (state_->team != nullptr) state_->team->gather(picture);
    state_->finish(picture, view, optics);
    facts.merge(picture.facts);
    picture.facts = std::move(facts);
    return picture;
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
    const bool of_kernels = draws_kernels(state_->method()) && !state_->is_translucent() && !state_->options.seconds;
    state_->settle_origins(optics);
    return of_kernels ? state_->kernels(optics, progress, facts).boundary : state_->skin_of_mesh(progress, facts).surface;
}

bool PictureMaker::keeps_kernels(const Optics& optics) const {
    return state_->origins_for(optics) == state_->origins;
}

const RbfVolume& PictureMaker::kernels(const Optics& optics, Progress* progress, Facts& facts) {
    state_->settle_origins(optics);
    return state_->kernels(optics, progress, facts);
}

}  // namespace subvol
