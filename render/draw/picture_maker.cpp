// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_maker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "kernel_levels.h"
#include "subvol/boundary_shading.h"
#include "subvol/error.h"
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

constexpr int kTetsLevel = 1;

template <class... Parts>
std::string sentence(const Parts&... parts) {
    std::ostringstream stream;
    (stream << ... << parts);
    return stream.str();
}

std::string shown(const char* option, OptionNames names) {
    std::string name = (names == OptionNames::Flags ? "--" : "") + std::string(option);
    if (names == OptionNames::Keywords) std::ranges::replace(name, '-', '_');
    return name;
}

SplatMethod splat_method(Method method, SplatMethod otherwise) {
    if (method == Method::Sheets) return SplatMethod::Sheets;
    return method == Method::Footprints ? SplatMethod::Footprints : otherwise;
}

void add_method(Method method, const char* backend, Facts& facts) {
    facts["method"] = name_of(method);
    facts["backend"] = backend;
}

void add_splats(Method method, const SplatReport& splats, Facts& facts) {
    facts["method"] = name_of(method);
    if (splats.seconds_light > 0) facts.add_seconds("light", splats.seconds_light);
    facts.add_seconds("prepare", splats.seconds_prepare - splats.seconds_light);
    facts.add_seconds("draw", splats.seconds_draw);
    if (splats.seconds_colors > 0) facts.add_seconds("colors", splats.seconds_colors);
    facts["backend"] = splats.backend;
    facts["device"] = splats.device;
    facts["sheets"] = splats.sheets;
}

void add_rays(std::size_t rays, std::size_t lost, Facts& facts) {
    facts["rays"] = rays;
    facts["lost_rays"] = lost;
    if (lost > 0) facts.warn(sentence(lost, " rays were lost inside the mesh"));
}

void add_projected(const ProjectedReport& pt, ProjectedOrder order, Facts& facts) {
    facts.add_seconds("prepare", pt.seconds_prepare);
    facts.add_seconds("sort", pt.seconds_sort);
    facts.add_seconds("draw", pt.seconds_draw);
    facts["device"] = pt.device;
    facts["order"] = name_of(order);
    facts["tets"] = pt.tets;
    facts["degenerate_tets"] = pt.degenerate_tets;
    facts["inverted_tets"] = pt.inverted_tets;
    if (order == ProjectedOrder::Topological) facts["cycles"] = pt.cycles;
    if (order == ProjectedOrder::Lists || order == ProjectedOrder::Havs) facts["fragments"] = pt.fragments;
    if (order == ProjectedOrder::Havs) {
        facts["faces"] = pt.faces;
        facts["faces_drawn"] = pt.faces_drawn;
        facts["late_faces"] = pt.late_faces;
    }
    if (pt.violations) facts["order_violations"] = *pt.violations;
    if (pt.cycles > 0) facts.warn(sentence("the order of the tetrahedra has cycles, which were broken ", pt.cycles, " times"));
    if (pt.late_faces > 0)
        facts.warn(sentence(pt.late_faces, " faces came too late for the k-buffer; use a larger --kbuffer, or --order lists"));
}

void check_light(const PictureStyle& style, OptionNames names) {
    const bool computes_light = draws_kernels(style.method) || style.method == Method::Grid;
    if (computes_light || !is_lit(style.look.look) || style.look.look == Look::Solid) return;
    throw Error(ErrorCode::InvalidInput, "method " + std::string(name_of(style.method)) + " lights the boundary only",
                shown("look", names) + (names == OptionNames::Flags ? " " : "=") + std::string(name_of(style.look.look)),
                "use method splat or sheets, or the colour map isosurface for surfaces without light");
}

void check_lod(const MethodOptions& options) {
    if (!options.lod) return;
    const std::string where = shown("lod", options.names);
    if (!std::isfinite(*options.lod) || *options.lod < 0)
        throw Error(ErrorCode::InvalidInput, sentence(*options.lod, " is not a number of pixels"), where, "0 or more");
    if (options.style.method != Method::Projected) return;
    if (*options.lod > 1)
        throw Error(ErrorCode::InvalidInput, sentence("the fraction of faces is ", *options.lod), where, "0 to 1");
    if (options.order != ProjectedOrder::Havs) {
        throw Error(ErrorCode::InvalidInput,
                    "has no effect without " + shown("order", options.names) + " havs: only this order leaves faces out",
                    where);
    }
}

void check_time(const MethodOptions& options) {
    if (!options.seconds || !options.kernels.levels || !draws_kernels(options.style.method)) return;
    throw Error(ErrorCode::InvalidInput, "has no effect with " + shown("seconds", options.names),
                shown("levels", options.names), "leave one of them out");
}

}  // namespace

void validate(const MethodOptions& options) {
    check_light(options.style, options.names);
    check_lod(options);
    check_time(options);
}

BodyKind PictureBody::kind() const {
    if (bricks != nullptr) return BodyKind::Bricks;
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
    std::optional<BrickHull> hull{};
    std::optional<Surface> brick_boundary{};
    std::optional<BrickTets> brick_tets{};

    /// A splatter for each way of drawing: method, samples, light, and the kernels that it was made for.
    using SplatterKey = std::tuple<Method, int, bool, const RbfVolume*>;
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
        brick_boundary.reset();
        brick_tets.reset();
    }

    [[nodiscard]] const SchemeOptions& scheme() const { return options.kernels.sample.scheme; }
    [[nodiscard]] Method method() const { return options.style.method; }
    [[nodiscard]] bool is_solid() const { return options.style.look.look == Look::Solid; }
    [[nodiscard]] bool is_finished() const { return team == nullptr || team->finishes(); }
    /// Whether the light of the boundary is added to finished pictures.
    [[nodiscard]] bool lights_boundary() const {
        return is_solid() && !draws_kernels(method()) && method() != Method::Grid && is_finished();
    }

    [[nodiscard]] bool paints_boundary() const {
        const LookOptions& look = options.style.look;
        const bool has_boundary = body.mesh != nullptr || body.bricks != nullptr;
        return has_boundary && look.look == Look::Solid && look.opacity.empty() && !look.opacity_unit_world &&
               options.kernels.are_plain() && !options.drop_invisible && options.splat.sheets == 0 && options.splat.normalized;
    }
    /// Shadows and occlusion are those of the kernels: the boundary's own colours have none.
    [[nodiscard]] bool paints_splats() const {
        return paints_boundary() && !options.splat.shadows && options.splat.ambient_occlusion == 0;
    }

    [[nodiscard]] RefineOptions refinement(int level, Progress* progress) const {
        return {.scheme = scheme(), .levels = level, .progress = progress};
    }

    /// As boundary_values has it, up to rounding where the body has been moved.
    const BoundaryValues& skin_of_mesh(Progress* progress, Facts& facts) {
        if (skin) return *skin;
        const HexMesh& mesh = *body.mesh;
        const auto refine = [&] {
            return refinement(picture_levels(mesh, body.tets ? std::optional(0) : options.kernels.levels), progress);
        };
        skin = facts.timed(progress, "boundary", [&] {
            if (!body.moved) return boundary_values(mesh, refine());
            if (!tables) tables.emplace(mesh, refine());
            return tables->apply(mesh);
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
        SampleOptions sample = choices.sample;
        sample.progress = progress;
        if (body.moved && !choices.tets && !choices.levels && !choices.visible && choices.reduce_rmse == 0 &&
            SampleTables::are_for(sample)) {
            volume = facts.timed(progress, "sample", [&] {
                if (!kernel_tables) kernel_tables.emplace(*body.mesh, sample);
                return kernel_tables->apply(*body.mesh).volume;
            });
            return *volume;
        }
        volume = facts.unpack(make_mesh_kernels(*body.mesh, choices));
        return *volume;
    }

    const BrickHull& hull_of_bricks(Progress* progress, Facts& facts) {
        if (!hull) hull = facts.timed(progress, "hull", [&] { return gather_hull(*body.bricks, body.fields, progress); });
        return *hull;
    }

    Facts prepare(const Optics& optics, Progress* progress) {
        check_method(method(), body.kind(), options.names);
        Facts facts;
        if (body.bricks != nullptr) {
            prepare_bricks(progress, facts);
        } else if (draws_kernels(method())) {
            if (options.seconds) return facts;
            if (paints_splats()) (void)skin_of_mesh(progress, facts);
            if (!levels && body.file != nullptr) levels.emplace(*body.file, body.channels, options.lod.value_or(0));
            if (!levels) {
                const RbfVolume& all = kernels(optics, progress, facts);
                levels.emplace(all, options.lod.value_or(0), shown_channels().front(), progress, facts);
            }
        } else if (method() != Method::Grid) {
            prepare_cells(progress, facts);
        }
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
            make_tets(join_split_cells(*body.mesh));
        } else if (missing) {
            const RefineOptions refine = refinement(options.kernels.levels.value_or(kTetsLevel), progress);
            make_tets(facts.unpack(refined_on_limit(*body.mesh, refine, options.kernels.levels_option)));
        }
        if (lights_boundary()) (void)skin_of_mesh(progress, facts);
    }

    void prepare_bricks(Progress* progress, Facts& facts) {
        const bool by_kernels = draws_kernels(method());
        if (by_kernels ? brick_boundary.has_value() : brick_tets.has_value()) return;
        if (is_finished() && (by_kernels ? paints_splats() : is_solid())) {
            const BrickHull& all = hull_of_bricks(progress, facts);
            skin = facts.timed(progress, "boundary", [&] {
                return boundary_values(all, scheme(), by_kernels ? std::nullopt : options.kernels.levels);
            });
        }
        if (by_kernels) {
            SampleOptions sample = options.kernels.sample;
            sample.progress = progress;
            const BrickHull& all = hull_of_bricks(progress, facts);
            brick_boundary = facts.timed(progress, "boundary", [&] { return sample_bricks_boundary(all, sample); });
        }
        hull.reset();
        if (by_kernels) return;
        const BrickTetsOptions tet_options = brick_tets_options(progress);
        brick_tets = facts.timed(progress, "measure", [&] {
            return team != nullptr ? team->measure(*body.bricks, tet_options)
                                   : measure_tets(*body.bricks, tet_options, 0, body.bricks->bricks.size());
        });
        facts["levels"] = tet_options.refine.levels;
        facts["cells"] = brick_tets->tets / 6;
    }

    [[nodiscard]] BrickTetsOptions brick_tets_options(Progress* progress) const {
        return {.refine = refinement(options.kernels.levels.value_or(kTetsLevel), progress),
                .tets = {.progress = progress},
                .memory_bytes = options.memory_bytes};
    }

    /// The channels of the kernels that are drawn: the shown one, and the one of the colours if that is another.
    [[nodiscard]] std::vector<std::size_t> shown_channels() const {
        if (body.kernels != nullptr && !body.channels.empty()) return body.channels;
        const std::size_t count = body.mesh != nullptr      ? body.mesh->attributes.size()
                                  : body.file != nullptr    ? body.channels.size()
                                  : body.kernels != nullptr ? body.kernels->channels.size()
                                                            : 1;
        return count > 1 ? std::vector<std::size_t>{0, count - 1} : std::vector<std::size_t>{0};
    }

    [[nodiscard]] SplatOptions splat_options() const {
        SplatOptions splat = options.splat;
        splat.method = splat_method(method(), options.splat.method);
        splat.samples = options.style.sample_count();
        splat.clip = options.style.clip;
        splat.progress = nullptr;
        if (is_lit(options.style.look.look)) splat.shading = Shading{};
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

    KeptSplatter& splatter(const RbfVolume& kernels, std::size_t version) {
        const SplatOptions splat = splat_options();
        const SplatterKey key{method(), splat.samples, splat.shading.has_value(), &kernels};
        for (KeptSplatter& kept : splatters) {
            if (kept.key == key) return kept;
        }
        return splatters.emplace_back(KeptSplatter{key, Splatter(kernels, splat), version});
    }

    Picture draw_splats(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
        Picture picture;
        const RbfVolume& shown = stand_in != nullptr ? *stand_in : levels->kernels(view, progress, picture.facts);
        const BoundaryValues none;
        const BoundaryValues& colors = paints_splats() ? *skin : none;
        SplatResult drawn;
        if (team != nullptr) {
            drawn = team->splat(shown, splat_options(), colors, view, optics, progress, picture.facts);
        } else {
            const bool in_memory = stand_in == nullptr && draws_all_kernels();
            KeptSplatter& kept = splatter(in_memory ? *levels->all() : shown, in_memory ? 0 : levels->version());
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
        add_splats(method(), drawn.report, picture.facts);
        if (!(options.lod.value_or(0) > 0)) picture.facts["points"] = drawn.report.points;
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        return picture;
    }

    Picture draw_splats_in_time(const View& view, const Optics& optics, Progress* progress) const {
        ProgressiveResult drawn = render_progressively(
            *body.mesh, view, optics,
            {.seconds = *options.seconds, .sample = options.kernels.sample, .splat = splat_options(), .progress = progress});
        Picture picture{std::move(drawn.splat.image), std::move(drawn.splat.depth)};
        add_splats(method(), drawn.splat.report, picture.facts);
        picture.facts["points"] = drawn.splat.report.points;
        picture.facts["steps"] = drawn.steps;
        picture.facts["picture_scale"] = drawn.picture_scale;
        picture.facts["footprint_px"] = drawn.footprint_px;
        return picture;
    }

    Picture draw_brick_splats(const View& view, const Optics& optics, Progress* progress) const {
        Picture picture;
        BrickSplatOptions brick{
            .sample = options.kernels.sample, .splat = splat_options(), .memory_bytes = options.memory_bytes, .scratch = {}};
        brick.sample.progress = brick.splat.progress = progress;
        if (team != nullptr) brick.rows = team->rows(view.height());
        SplatResult drawn = picture.facts.timed(progress, "draw", [&] {
            if (team != nullptr)
                return team->splat(*body.bricks, body.fields, *brick_boundary, brick, view, optics, picture.facts);
            return render_bricks(*body.bricks, body.fields, *brick_boundary, view, optics, brick);
        });
        add_splats(method(), drawn.report, picture.facts);
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
        if (body.bricks != nullptr) {
            BrickTetsOptions brick = brick_tets_options(progress);
            brick.tets = tets_options;
            drawn = render_tets(*body.bricks, body.fields, *brick_tets, view, optics, brick);
            picture.facts.add_seconds("prepare", drawn.report.seconds_build);
        } else {
            drawn = tets->draw(view, optics, tets_options);
        }
        std::array counts{drawn.report.rays, drawn.report.lost_rays};
        if (team != nullptr) team->add_up(counts);
        add_method(Method::Tets, "cpu", picture.facts);
        picture.facts.add_seconds("draw", drawn.report.seconds_draw);
        picture.facts["tets"] = drawn.report.tets;
        picture.facts["degenerate_tets"] = drawn.report.degenerate_tets;
        picture.facts["inverted_tets"] = drawn.report.inverted_tets;
        add_rays(counts[0], counts[1], picture.facts);
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
        add_method(Method::Projected, "gl", picture.facts);
        add_projected(drawn.report, projected_options.order, picture.facts);
        picture.image = std::move(drawn.image);
        return picture;
    }

    Picture draw_dense(const View& view, const Optics& optics, Progress* progress) const {
        const std::optional<int> level = options.kernels.levels;
        DenseResult drawn = render_dense(*body.mesh, {}, view, optics,
                                         {.refine = refinement(0, progress),
                                          .levels = level,
                                          .max_levels = options.max_levels,
                                          .image_tolerance = options.image_tolerance,
                                          .samples = options.style.sample_count(),
                                          .clip = options.style.clip,
                                          .progress = progress});
        const DenseReport& dense = drawn.report;
        Picture picture{std::move(drawn.image)};
        Facts& facts = picture.facts;
        add_method(Method::Dense, "cpu", facts);
        facts.add_seconds("prepare", dense.seconds_build);
        facts.add_seconds("draw", dense.seconds_draw);
        facts["levels"] = dense.levels;
        if (dense.image_change) facts["image_change"] = *dense.image_change;
        facts["converged"] = dense.converged;
        facts["blocks"] = dense.blocks;
        facts["skipped_blocks"] = dense.skipped_blocks;
        facts["micro_cells"] = dense.micro_cells;
        facts["passes"] = dense.passes;
        facts["bytes"] = dense.bytes;
        add_rays(dense.rays, dense.lost_rays, facts);
        if (!level && !dense.converged) {
            facts.warn(sentence("the picture still changes by ", dense.image_change.value_or(0), " at level ", dense.levels,
                                ": --levels draws a finer one"));
        }
        return picture;
    }

    Picture draw_grid(const View& view, const Optics& optics, Progress* progress) const {
        GridResult drawn =
            render_grid(*body.voxels, view, optics,
                        {.samples = options.style.sample_count(), .clip = options.style.clip, .progress = progress});
        Picture picture{std::move(drawn.image)};
        add_method(Method::Grid, "cpu", picture.facts);
        picture.facts.add_seconds("draw", drawn.report.seconds_draw);
        picture.facts["rays"] = drawn.report.rays;
        picture.facts["cells"] = drawn.report.cells;
        picture.facts["blocks"] = drawn.report.blocks;
        return picture;
    }

    Picture drawn_rows(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
        switch (method()) {
            case Method::Splat:
            case Method::Sheets:
            case Method::Footprints:
                if (body.bricks != nullptr) return draw_brick_splats(view, optics, progress);
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

    /// Adds what the boundary gives to a finished picture: light, or for bricks its colours.
    void finish(Picture& picture, const View& view, const Optics& optics) const {
        const int samples = options.style.sample_count();
        const Clip& clip = options.style.clip;
        if (lights_boundary()) {
            light_boundary(picture.image, skin->surface, view, Shading{}, samples, clip);
        } else if (body.bricks != nullptr && skin && !skin->values.empty()) {
            color_boundary(picture.image, skin->surface, skin->values.back(), view, optics, Shading{}, samples, clip);
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
    check_light(style, state_->options.names);
    state_->options.style = style;
}

Facts PictureMaker::prepare(const Optics& optics, Progress* progress, bool splatter) {
    Facts facts = state_->prepare(optics, progress);
    if (splatter && state_->levels && state_->draws_all_kernels()) (void)state_->splatter(*state_->levels->all(), 0);
    return facts;
}

Picture PictureMaker::draw(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
    Facts facts = state_->prepare(optics, progress);
    Picture picture = state_->drawn_rows(view, optics, progress, stand_in);
    if (state_->team != nullptr) state_->team->gather(picture);
    state_->finish(picture, view, optics);
    facts.merge(picture.facts);
    picture.facts = std::move(facts);
    return picture;
}

std::vector<Vec3> PictureMaker::framed_points(const Optics& optics, Progress* progress, Facts& facts) {
    const Look look = state_->options.style.look.look;
    if (state_->body.mesh != nullptr) return subvol::framed_points(*state_->body.mesh, look, optics);
    if (state_->body.bricks == nullptr || look != Look::Solid) return {};
    return state_->hull_of_bricks(progress, facts).mesh.points;
}

bool PictureMaker::paints_boundary() const {
    return state_->paints_boundary();
}

const BoundaryValues& PictureMaker::skin(Progress* progress, Facts& facts) {
    return state_->skin_of_mesh(progress, facts);
}

const RbfVolume& PictureMaker::kernels(const Optics& optics, Progress* progress, Facts& facts) {
    return state_->kernels(optics, progress, facts);
}

}  // namespace subvol
