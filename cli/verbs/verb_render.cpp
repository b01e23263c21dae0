// SPDX-License-Identifier: Apache-2.0
// The verb `render`: pictures and videos of a volume.
//
//     input ─► body             a mesh in memory or in bricks, voxels, kernels, or a file of kernels with levels of detail
//              field, colours   the field of the opacities first, that of the colours last, with their ranges
//              notes            streamlines, shells, edges, marks of extremes, a scale bar, a legend
//              views            from a named direction, several of them, or a turntable
//           ─► maker            draws the body in a view by the method, with depths for what lies within
//           ─► output           one file for each view, or the frames of a video
//
// Of steps all are read once for a common box and common ranges, and again for their pictures if they do not fit in memory.
// Shares are rows of one picture, which splats and tetrahedra can be drawn in, or else whole frames. The limit of a mesh is
// compared with the file's cells once for all steps, and a warning says where they differ.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "body_input.h"
#include "grid_input.h"
#include "input.h"
#include "limit_warning.h"
#include "mesh_figures.h"
#include "options.h"
#include "part_note.h"
#include "picture_notes.h"
#include "picture_output.h"
#include "picture_shares.h"
#include "points_input.h"
#include "render_arguments.h"
#include "sampled_points.h"
#include "share.h"
#include "steps.h"
#include "stream_arguments.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/points_frame.h"
#include "subvol/error.h"
#include "subvol/flow_surface.h"
#include "subvol/limit.h"
#include "subvol/measure.h"
#include "subvol/method.h"
#include "subvol/option.h"
#include "subvol/quantity.h"
#include "subvol/shell_scene.h"
#include "text.h"
#include "verb.h"
#include "video_file.h"

namespace subvol::cli {
namespace {

/// A mesh that is shown, in memory or in pieces, with the field of the opacities first and that of the colours last.
///
/// box:  of the mesh; without cells, of its points
/// flow: the vectors at its points that are drawn
struct ShownBody {
    BodyInput body;
    ShownField field, colors;
    Box box{};
    Flow flow{};
};

/// Whether patches are coloured by their numbers.
bool draws_categories(const CommonOptions& options) {
    return !options.patches.empty() && !options.field && !options.density;
}

/// The bodies of steps are kept from one reading to the next up to so many bytes.
constexpr std::size_t kMostKept_bytes = 256 << 20;

/// The memory of a body of a step, for the most part.
std::size_t bytes_of(const ShownBody& shown) {
    const HexMesh* mesh = shown.body.source().mesh();
    if (mesh == nullptr) return kMostKept_bytes + 1;  // in pieces
    std::size_t bytes =
        (mesh->points.size() + shown.body.shells.points.size()) * sizeof(Vec3) + mesh->cells.size() * sizeof(mesh->cells[0]);
    for (const Attribute& field : mesh->attributes) bytes += field.values.size() * sizeof(field.values[0]);
    return bytes;
}

/// The picture without cells, into which shells are drawn.
Picture empty_picture(const View& view) {
    Picture picture{Image(view.width(), view.height()), {}};
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    return picture;
}

void check_points(const std::vector<Vec3>& points) {
    constexpr double kMost_world = 1e18;  // as of splats; far beyond it, squares and volumes overflow
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3 x = glm::abs(points[p]);
        const double largest = std::max({x.x, x.y, x.z});
        if (largest <= kMost_world) continue;
        throw Error(ErrorCode::InvalidInput, text("point ", p, " has the coordinate ", largest), {},
                    "at most 1e18 can be drawn");
    }
}

Range with_values(Range range, std::span<const double> values) {
    for (const double value : values) range = {std::min(range.min, value), std::max(range.max, value)};
    return range;
}

/// Streamlines as tubes, and arrows, in the colours of the field that gives the colours.
ShellScene flow_scene(const ShownBody& shown, const StreamArguments& streams, const ShownColors& colors,
                      const RenderArguments& arguments, int samples, Progress* progress, Facts& facts) {
    const HexMesh& mesh = *shown.body.source().mesh();
    const RefineOptions refine = arguments.refine.options(0, progress);
    Flow flow = shown.flow;
    flow.limit = {.scheme = refine.scheme, .progress = progress};
    if (!flow.stream_vectors.empty()) flow.seeds = streams.places(mesh, flow.limit);
    return make_opaque_scene(mesh, flow_surface(mesh, flow, facts), refine, arguments.refine.levels, colors.optics, samples,
                             arguments.clip);
}

/// Reads the mesh with its shells and beams. A scheme of tetrahedra refines it, and leaves those out.
///
/// app:    of the command; options that bricks cannot have are refused
/// alone:  Take: of shells without cells the mesh has points alone
/// throws: Error(InvalidInput), also if a point is too far away to be drawn
WithFacts<ShownBody> load_shown_body(const std::string& input, const CommonOptions& options, const RenderArguments& arguments,
                                     const StreamArguments& streams, const CLI::App& app, Progress* progress,
                                     ShellsAlone alone) {
    const bool refined = arguments.tets.asked();  // tetrahedra are refined by other rules than shells
    if (refined) alone = ShellsAlone::Refuse;
    Facts facts;
    CommonOptions reading = options;
    if (arguments.splat.color_field) reading.at_rest.push_back(*arguments.splat.color_field);
    for (const std::string* const vector : {&streams.chosen.streamlines, &streams.chosen.glyphs}) {
        if (!vector->empty()) reading.at_rest.push_back(*vector);
    }
    BodyInput body = facts.unpack(open_body(input, reading, app, progress, !refined, alone));
    Flow flow;
    if (const HexMesh* const mesh = body.source().mesh(); mesh != nullptr && streams.chosen.any()) {
        flow = flow_in(*mesh, streams.chosen, OptionNames::Flags, progress);
        if (!reading.field && !reading.density) reading.field = streams.chosen.length_of(*mesh);
    }
    if (draws_categories(reading)) reading.field = "patch";
    const std::string field = facts.unpack(body.select(reading, OtherFields::Drop, arguments.splat.color_field));
    facts.merge(body.refine(arguments.tets, default_tet_level(arguments.method), progress));
    ShownBody shown{std::move(body), {field, {}}, {field, {}}, {}, std::move(flow)};
    shown.field.range = shown.body.range(field);
    shown.field.unit = unit_of(shown.body.of_file, field);
    shown.colors = shown.field;
    const MeshSource source = shown.body.source();
    shown.box = source.bounds();
    if (const HexMesh* mesh = source.mesh()) {
        check_points(mesh->points);
        check_points(shown.body.shells.points);
        const std::string& colors = mesh->attributes.back().name;
        shown.colors = {colors, shown.body.range(colors), unit_of(shown.body.of_file, colors),
                        categories_of(mesh->attributes.back().values)};
        if (!shown.body.opacities.empty()) {  // colours and views are those of the whole
            const Shells parts = with_fields_of(shown.body.shells, *mesh);
            shown.field.range = with_values(shown.field.range, parts.attributes.front().values);
            shown.colors.range = with_values(shown.colors.range, parts.attributes.back().values);
            for (const Vec3& p : parts.points) shown.box.add(p);
        }
        if (mesh->cells.empty()) {
            for (const Vec3& p : mesh->points) shown.box.add(p);
        }
    }
    return {std::move(shown), std::move(facts)};
}

/// `make_notes` with the shells and beams on their limit.
PictureNotes make_notes(const ShownBody& shown, const ShownColors& colors, RenderArguments& arguments,
                        const StreamArguments& streams, Progress* progress, Facts& facts) {
    const MeshSource source = shown.body.source();
    PictureNotes notes = make_notes(arguments.picture, colors, source.mesh(), facts);
    notes.clip = arguments.clip;
    const bool transparent = arguments.picture.look != Look::Solid || arguments.picture.choices.opacity;
    const bool ends_rays = arguments.method != Method::Footprints;  // else lines lie before or behind the whole
    notes.within =
        ends_rays && (transparent || !draws_kernels(arguments.method)) && notes.edges != nullptr && !notes.edges->cells.empty();
    const int samples =
        PictureStyle{.look = {.look = arguments.picture.look}, .samples = arguments.chosen.style.samples}.sample_count();
    if (streams.chosen.any()) {
        notes.flow = facts.timed(progress, "streamlines", [&] {
            return std::make_shared<const ShellScene>(flow_scene(shown, streams, colors, arguments, samples, progress, facts));
        });
    }
    if (!shown.body.shells.empty()) {
        notes.shells = facts.timed(progress, "sheets", [&] {
            const BodyInput& body = shown.body;
            const RefineOptions refine = arguments.refine.options(0, progress);
            const std::optional<int>& most = arguments.refine.levels;
            ShellScene scene = body.whole ? make_side_scene(*source.mesh(), *body.whole, body.shells, refine, most,
                                                            colors.optics, samples, arguments.clip, body.opacities)
                                          : make_shell_scene(*source.mesh(), body.shells, refine, most, colors.optics, samples,
                                                             arguments.clip);
            scene.ended = ends_rays && transparent && shown.body.opacities.empty();
            return std::make_shared<const ShellScene>(std::move(scene));
        });
    }
    return notes;
}

ShownField united(const ShownField& a, const ShownField& b) {
    std::vector<double> categories;
    if (!a.categories.empty() && !b.categories.empty())
        std::set_union(a.categories.begin(), a.categories.end(), b.categories.begin(), b.categories.end(),
                       std::back_inserter(categories));
    return {b.name, {std::min(a.range.min, b.range.min), std::max(a.range.max, b.range.max)}, b.unit, std::move(categories)};
}

class RenderVerb : public Verb {
public:
    explicit RenderVerb(CLI::App& program)
        : Verb(program, "render", "Render an image or a video.",
               "  subvol render model:ball -o ball.png\n"
               "  subvol render model:ball -o side.exr --view -y --size 1024x768 --tf coolwarm\n"
               "  subvol render model:ball -o turn.mp4 --turntable 120 --legend turn.svg\n"
               "  subvol render model:ball -o reference.exr --method tets --levels 2 --samples 2\n"
               "  subvol render run.pvd -o run.mp4 --step all             a film\n"
               "  subvol render smoke.vdb -o smoke.png --method grid\n"
               "  subvol render smoke.vdb -o smoke.png                   the voxels as kernels") {
        show_limit_of_parts();
        add_input(app(), "FILE", input_,
                  text(input_help(), "; or points (.ply, .vtp, .svk, .vdb), or a .vdb grid or level set"))
            ->required();
        add_option(app(),
                   Option("output", output_)
                       .also("o")
                       .help("IMAGE", "the picture (.png, .jpg, .webp, or .exr for linear floats), or a turntable's video"))
            ->required();
        arguments_.add_to(app());
        streams_.add_to(app());
        add_patches(
            "draw this patch of the boundary alone, as info lists them, or the hull of a set of cells, set:NAME, or the faces "
            "between those of nodes, nodes:NAME (repeatable; "
            "all); "
            "coloured by patch, or by --field");
        add_part_opacities(
            "of a solid: the opacity of the surface of a set of cells or of a region as of --only, 0 to 1; 0 leaves it out "
            "(repeatable)");
        add_option(app(), Option("title", picture_.title).help("TEXT", "a line of text above the body"));
        add_option(app(), Option("time-label", picture_.time_label).help("draw the time of the step above the body"));
        share_.add_to(app(), "rows of the picture, or some of the frames");
        set_essentials({"--output", "--field", "--look", "--tf", "--opacity", "--background", "--size", "--view", "--views",
                        "--camera", "--turntable", "--legend", "--per-edge", "--method", "--levels", "--json"});
        set_groups();
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        if (streams_.chosen.any()) veil_body(picture_.choices, arguments_.clip);
        const BodyKind kind = kind_of_input();
        if (kind == BodyKind::Voxels) grid_ = report.unpack(load_grid(input_, common(), report.progress()));
        arguments_.settle(kind, grid_ && grid_->report().level_set, app());
        check_flow(streams_.chosen, arguments_.method, arguments_.body,
                   common().patches.empty() && common().part_opacities.empty(), OptionNames::Flags);
        refuse_frames_per_second();
        check_parts();
        says_error_ = common().json && arguments_.chosen.image_tolerance;
        const Method method = arguments_.method;
        report.if_long(method == Method::Dense ? "--levels 2, a smaller --size, or --method splat"
                       : draws_kernels(method) ? "a smaller --size, a larger --spacing, or fewer --sheets"
                                               : "a smaller --size, fewer --samples, or --method splat");
        if (asks_for_steps(common()) && arguments_.body != BodyKind::Bricks) {
            if (!common().patches.empty()) throw Error(ErrorCode::InvalidInput, "are drawn at one step", "--patch", "--step N");
            draw_steps(report);
            return 0;
        }
        PictureOutput output(output_, picture_.eye.turntable, picture_);
        set_share(output, picture_.eye.turntable.has_value());
        switch (arguments_.body) {
            case BodyKind::Mesh:
            case BodyKind::Tets:
            case BodyKind::Bricks:
                draw_mesh(output, report);
                break;
            case BodyKind::Voxels:
                draw_voxels(output, report);
                break;
            case BodyKind::Kernels:
            case BodyKind::KernelFile:
                draw_points(output, report);
        }
        finish(output, report);
        return 0;
    }

private:
    [[nodiscard]] BodyKind kind_of_input() const {
        switch (kind_of(input_)) {
            case InputKind::Bricks:
                return BodyKind::Bricks;
            case InputKind::Points:
                return holds_levels(input_) && arguments_.chosen.lod.value_or(0) > 0 ? BodyKind::KernelFile : BodyKind::Kernels;
            case InputKind::Grid:
                return BodyKind::Voxels;
            case InputKind::Mesh:
            case InputKind::Picture:
                break;
        }
        return BodyKind::Mesh;
    }

    /// throws: Error(InvalidInput) where parts have no surfaces of their own, or there are no places of values
    void check_parts() const {
        if (picture_.extremes && arguments_.body != BodyKind::Mesh && arguments_.body != BodyKind::Tets)
            throw Error(ErrorCode::InvalidInput, "needs a mesh in memory", "--extremes");
        if (picture_.extremes && arguments_.clip.slices_alone())
            throw Error(ErrorCode::InvalidInput, "are those of the body, which slices alone do not show", "--extremes",
                        "--around, or subvol slice --extremes");
        if (common().part_opacities.empty()) return;
        if (picture_.look != Look::Solid || picture_.choices.opacity)
            throw Error(ErrorCode::InvalidInput, "is of the surfaces of a solid", "--part-opacity",
                        "--look solid without --opacity");
        if (arguments_.body != BodyKind::Mesh)
            throw Error(ErrorCode::InvalidInput, "needs a mesh of hexahedra in memory", "--part-opacity");
        if (!common().patches.empty())
            throw Error(ErrorCode::InvalidInput, "is of parts of a volume, and --patch draws faces alone", "--part-opacity");
    }

    void refuse_frames_per_second() {
        if (is_video(output_)) return;
        refuse_options(app(), {"--fps", "--duration"}, "has no effect without a video (-o NAME.mp4, .webm or .gif)");
    }

    /// Shares are of frames; of a single picture they are of rows, which only splats and tetrahedra can be drawn in.
    void set_share(PictureOutput& output, bool frames) {
        if (!shares(share_)) return;
        const Share share = share_of(share_);
        if (!frames && (!draws_rows(arguments_.method) || arguments_.chosen.seconds)) {
            throw Error(ErrorCode::InvalidInput, "is not drawn in shares",
                        arguments_.chosen.seconds ? "--seconds" : "--method " + std::string(name_of(arguments_.method)),
                        "--method splat or tets, or shares of frames: --turntable N, --step all");
        }
        if (!frames) rows_.emplace(OwnRows{share, ranks()});
        if (ranks() == nullptr || frames) {
            output.set_share(share, make_note(app(), input_, share));
        } else if (!ranks()->first()) {
            output.set_silent();
        }
    }

    void finish(PictureOutput& output, Report& report) {
        report.merge(output.finish(report.progress()));
        if (ranks() != nullptr && !rows_)
            report["outputs"] = ranks()->gather_list(report.json().value("outputs", Json::array()));
    }

    void set_groups() {
        group("Camera",
              {"--size", "--camera", "--view", "--views", "--up", "--fit", "--ortho", "--turntable", "--fps", "--duration"});
        group("Cuts", {"--clip", "--clip-box", "--slice", "--around"});
        group("Colours and light", {"--look",        "--iso",          "--tf",
                                    "--tf-range",    "--log",          "--symlog",
                                    "--bands",       "--below",        "--above",
                                    "--opacity",     "--opacity-unit", "--legend",
                                    "--legend-side", "--legend-size",  "--legend-format",
                                    "--title",       "--time-label",   "--background",
                                    "--scale-bar",   "--part-opacity", "--extremes",
                                    "--shade",       "--shadows",      "--ambient-occlusion",
                                    "--color-field"});
        group("Streamlines",
              {"--streamlines", "--seeds", "--seed-count", "--stream-direction", "--stream-length", "--stream-time",
               "--stream-tolerance", "--stream-step", "--tube-radius", "--glyphs", "--glyph-count", "--glyph-size"});
        group("Kernels",
              {"--per-edge", "--centers", "--spacing", "--spacing-voxels", "--tolerance", "--footprint", "--footprint-size",
               "--values", "--kernel", "--value-kernel", "--threshold", "--correction", "--reduce", "--refine"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
        group("Methods", {"--method", "--samples", "--seconds", "--backend", "--device", "--sheets", "--plain-sums",
                          "--tolerance-image", "--order", "--kbuffer", "--lod", "--memory", "--part"});
    }

    /// Lets `draw` make pictures in the colours of the fields, and writes their legend.
    ///
    /// draw: gets the ShownColors
    template <class Draw>
    void show(const Box& box, const ShownField& field, const ShownField& colors, PictureOutput& output, Report& report,
              const Draw& draw) {
        box_ = box;
        range_ = field.range;
        if (moved_) picture_.legend_note = text("moved by ", detail::number_text(*moved_->factor, 3), " × ", moved_->field);
        const ShownColors shown{picture_.make_optics(box, field.range, colors.range), picture_.legend_options(field, colors)};
        draw(shown);
        output.set_notes({});  // what they refer to is gone
        if (speaks()) report.merge(picture_.write_legend(shown.optics, shown.legend));
    }

    [[nodiscard]] PictureMaker maker_of(PictureBody body, Report& report) {
        return {std::move(body), arguments_.method_options(box_, range_, report.progress()), rows_ ? &*rows_ : nullptr};
    }

    void write(PictureMaker& maker, const std::vector<View>& views, const Optics& optics, PictureOutput& output,
               Report& report) {
        if (output.draws_within()) {
            Facts facts;
            output.set_boundary(maker.boundary(optics, report.progress(), facts));
            report.merge(facts);
        }
        const auto draw = [&](const View& view, Progress* progress) {
            Picture picture = maker.draw(view, optics, progress);
            if (std::exchange(says_error_, false)) picture.facts.merge(maker.measure_error(picture, view, optics, progress));
            return picture;
        };
        report.merge(output.write(views, draw, report.progress()));
    }

    /// The pictures of shells without cells.
    static void write_alone(const std::vector<View>& views, PictureOutput& output, Report& report) {
        const auto draw = [](const View& view, Progress*) { return empty_picture(view); };
        report.merge(output.write(views, draw, report.progress()));
    }

    /// The points that a named view is fitted to; none for other cameras, which bricks need not be read for.
    [[nodiscard]] std::vector<Vec3> framed_points(PictureMaker& maker, const Optics& optics, Report& report) const {
        if (picture_.eye.camera || picture_.eye.turntable) return {};
        Facts facts;
        std::vector<Vec3> points = maker.framed_points(optics, report.progress(), facts);
        report.merge(facts);
        return points;
    }

    /// The pictures of a body without notes of its own, framed by its box.
    void write(PictureBody body, const ShownColors& shown, PictureOutput& output, Report& report) {
        Facts facts;
        set_notes(make_notes(picture_, shown, nullptr, facts), output);
        report.merge(facts);
        PictureMaker maker = maker_of(std::move(body), report);
        const std::vector<Vec3> framed = framed_points(maker, shown.optics, report);
        write(maker, picture_.make_views(box_, framed), shown.optics, output, report);
    }

    /// Gives the notes to the output, with the scale bar that was asked for.
    void set_notes(PictureNotes notes, PictureOutput& output) const {
        if (picture_.scale_bar) notes.scale_at = box_.center();
        output.set_notes(std::move(notes));
    }

    void set_notes(const ShownBody& mesh, const ShownColors& shown, PictureOutput& output, Report& report) {
        Facts facts;
        PictureNotes notes = make_notes(mesh, shown, arguments_, streams_, report.progress(), facts);
        report.merge(facts);
        if (picture_.extremes) notes.marks = extremes_of(mesh, report);
        set_notes(std::move(notes), output);
    }

    /// The least and the largest value of what gives the colours in what the picture shows of the body, with their places.
    [[nodiscard]] std::vector<PictureMark> extremes_of(const ShownBody& shown, Report& report) const {
        const HexMesh* mesh = shown.body.source().mesh();
        if (mesh == nullptr || mesh->cells.empty())
            throw Error(ErrorCode::InvalidInput, "needs a mesh with opaque cells in memory", "--extremes");
        std::vector<Region> left;
        for (const CutPlane& plane : arguments_.clip.planes) left.push_back(half_space(plane.point, -plane.normal));
        if (arguments_.clip.box) left.push_back(box_region(*arguments_.clip.box));
        HexMesh colored = *mesh;
        colored.attributes = {mesh->attributes.back()};
        const RefineOptions refine = arguments_.refine.options(0, report.progress());
        MeasureOptions options{.scheme = refine.scheme, .progress = report.progress()};
        if (arguments_.refine.levels) {
            colored = on_limit(subvol::refine(colored, refine), refine.scheme.kind);
            options.scheme = {.kind = Scheme::Linear};
        }
        const FieldMeasure found = report.timed("extremes", [&] {
            try {
                const LimitMeasure all =
                    left.empty() ? measure_limit(colored, options) : measure_limit_in(colored, left, options);
                if (!is_model(input_)) report.warn(fold_warning(all.folds));
                return all.whole.fields.front();
            } catch (const Error& error) {
                if (left.empty() || error.code() != ErrorCode::InvalidInput) throw;
                throw Error(ErrorCode::InvalidInput, "nothing is left of the body", "--extremes", "a smaller cut");
            }
        });
        std::vector<PictureMark> marks;
        Json said;
        for (const auto& [name, one] : {std::pair{"min", found.min}, {"max", found.max}}) {
            marks.push_back({one.place, text(name, " ", detail::number_text(one.value, 4))});
            said[name] = one.value;
            said[text(name, "_at")] = place_of(one);
        }
        if (!arguments_.refine.levels) {  // else the cells are those of the level
            for (const auto& [name, one] : {std::pair{"file_min", found.given.min}, {"file_max", found.given.max}}) {
                said[name] = one.value;
                said[text(name, "_at")] = place_of(one);
            }
        }
        if (!is_model(input_))
            report.warn(range_warning(colored.attributes.front(), field_range(*mesh, mesh->attributes.size() - 1),
                                      {.min = found.min.value, .max = found.max.value}));
        report["extremes"] = std::move(said);
        return marks;
    }

    [[nodiscard]] ShownBody load_shown(const CommonOptions& options, Report& report, ShellsAlone alone = ShellsAlone::Refuse) {
        report["input"] = input_;  // for errors
        ShownBody shown =
            report.unpack(load_shown_body(input_, options, arguments_, streams_, app(), report.progress(), alone));
        moved_ = shown.body.moved;
        if (!arguments_.tets.asked() && !said_limit_) {
            const SchemeOptions scheme = arguments_.refine.options(0, report.progress()).scheme;
            report.warn(limit_warning(input_, shown.body.source(), scheme, report.progress()));
            said_limit_ = true;  // once for all steps
        }
        return shown;
    }

    [[nodiscard]] PictureBody body_of(const ShownBody& shown) const {
        PictureBody body{.mesh = shown.body.source(), .tets = arguments_.tets.asked()};
        body.of_file = !is_model(input_) && !picture_.extremes;  // which are searched for, and say it
        return body;
    }

    /// A picture of each step, in one box and with one range of colours: all are read first for these, and again where they
    /// were too large to be kept.
    void draw_steps(Report& report) {
        if (picture_.eye.turntable || arguments_.chosen.seconds || arguments_.method == Method::Grid) {
            throw Error(ErrorCode::InvalidInput, "steps are drawn without it",
                        picture_.eye.turntable      ? "--turntable"
                        : arguments_.chosen.seconds ? "--seconds"
                                                    : "--method grid");
        }
        const MeshSeries series = open_series(input_);
        const FrameRange steps = chosen_steps(series, common());
        PictureOutput output(output_, steps.count(), picture_, steps.first);
        set_share(output, true);
        const CommonOptions all = report.unpack(for_steps(input_, common(), steps, report.progress()));
        Box box, seen;
        ShownField field, colors;
        std::vector<std::optional<ShownBody>> kept(steps.count());  // of each step, as far as memory is given to them
        std::size_t kept_bytes = 0;
        StepsWithFields taken(report);
        std::vector<int> there;
        std::vector<double> times;
        for (int step = steps.first; step <= steps.last; ++step) {
            std::optional<ShownBody> read;
            if (!taken.take(step, [&] { read = load_shown(of_step(all, step), report); })) continue;
            ShownBody& mesh = *read;
            const bool first = there.empty();
            there.push_back(step);
            times.push_back(series.times[static_cast<std::size_t>(step)]);
            field = first ? mesh.field : united(field, mesh.field);
            colors = first ? mesh.colors : united(colors, mesh.colors);
            box.add(mesh.box);
            for (const Vec3& p : mesh.body.shells.points) seen.add(p);
            kept_bytes += bytes_of(mesh);
            if (kept_bytes <= kMostKept_bytes) kept[static_cast<std::size_t>(step - steps.first)] = std::move(mesh);
        }
        taken.finish();
        seen.add(box);
        show(box, field, colors, output, report, [&](const ShownColors& shown) {
            std::vector<View> views;
            for (int step = steps.first; step <= steps.last; ++step) {
                if (std::ranges::find(there, step) == there.end()) {
                    output.leave_out();
                    continue;
                }
                if (!output.wants_next()) {
                    output.skip();
                    continue;
                }
                auto& seen_before = kept[static_cast<std::size_t>(step - steps.first)];
                const ShownBody mesh = seen_before ? std::move(*seen_before) : load_shown(of_step(all, step), report);
                seen_before.reset();
                moved_ = mesh.body.moved;
                set_notes(mesh, shown, output, report);
                if (views.empty()) views = picture_.make_views(seen);
                if (mesh.body.source().cells() == 0) {  // all parts are translucent
                    write_alone(views, output, report);
                    continue;
                }
                PictureMaker maker = maker_of(body_of(mesh), report);
                write(maker, views, shown.optics, output, report);
            }
        });
        finish(output, report);
        report["times"] = times;
    }

    void draw_mesh(PictureOutput& output, Report& report) {
        const ShownBody mesh = load_shown(common(), report, ShellsAlone::Take);
        if (draws_categories(common())) {
            if (!picture_.choices.colors) picture_.choices.colors = "categories";
            for (const Patch& patch : mesh.body.sets.patches) picture_.legend_names.push_back(patch.name);
        }
        if (mesh.body.source().cells() == 0 && mesh.body.opacities.empty()) check_options_of_shells(given_options(app()));
        show(mesh.box, mesh.field, mesh.colors, output, report, [&](const ShownColors& shown) {
            const std::vector<Vec3>& shells = mesh.body.shells.points;
            set_notes(mesh, shown, output, report);
            Box seen = mesh.box;
            for (const Vec3& p : shells) seen.add(p);
            if (mesh.body.source().cells() == 0) {
                return write_alone(picture_.make_views(seen, shells), output, report);
            }
            PictureMaker maker = maker_of(body_of(mesh), report);
            std::vector<Vec3> framed = framed_points(maker, shown.optics, report);
            if (!framed.empty()) framed.insert(framed.end(), shells.begin(), shells.end());
            write(maker, picture_.make_views(seen, framed), shown.optics, output, report);
        });
    }

    /// Rays through voxels, or the voxels as kernels.
    void draw_voxels(PictureOutput& output, Report& report) {
        refuse_mesh_options(app(), "needs a mesh; this is a grid of voxels");
        const VdbGrid& grid = *grid_;
        const bool body = grid.report().level_set && draws_kernels(arguments_.method);  // of density 1
        const ShownField field =
            body ? ShownField{"density", {1, 1}} : ShownField{grid.report().name, {grid.report().min, grid.report().max}};
        show(grid.report().frame, field, field, output, report, [&](const ShownColors& shown) {
            if (arguments_.method == Method::Grid) {
                const auto voxels = grid.voxels();
                return write({.voxels = voxels.get()}, shown, output, report);
            }
            const RbfVolume kernels =
                report.unpack(sample_reported(grid, arguments_.sample, shown.optics.function(), app(), report.progress()));
            write({.kernels = &kernels}, shown, output, report);
        });
    }

    /// Draws a file of points. Each view reads what it needs of a file with levels of detail; without a boundary, all kernels
    /// are read, because all of them decide where the volume ends.
    void draw_points(PictureOutput& output, Report& report) {
        report["input"] = input_;
        if (arguments_.body == BodyKind::KernelFile) {
            const std::uint64_t kept = picture_.eye.turntable ? arguments_.chosen.memory_bytes : 0;
            LevelsInput levels =
                report.unpack(open_levels(input_, common(), arguments_.splat.color_field, kept, app(), report.progress()));
            if (levels.file.contents().boundary_triangles > 0) return draw_levels(levels, output, report);
        }
        const RbfVolume volume =
            report.unpack(load_points(input_, common(), arguments_.splat.color_field, app(), report.progress()));
        const std::size_t last = volume.channels.size() - 1;
        const ShownField field{volume.channels.front().name, channel_range(volume, 0)};
        const ShownField colors{volume.channels.back().name, channel_range(volume, last)};
        show(detail::frame_of(volume), field, colors, output, report,
             [&](const ShownColors& shown) { write({.kernels = &volume}, shown, output, report); });
    }

    void draw_levels(LevelsInput& levels, PictureOutput& output, Report& report) {
        const KernelFileContents& contents = levels.file.contents();
        const auto& field = contents.channels[levels.channels.front()];
        const auto& color = contents.channels[levels.channels.back()];
        show(contents.bounds, {field.name, {field.min, field.max}}, {color.name, {color.min, color.max}}, output, report,
             [&](const ShownColors& shown) {
                 write({.file = &levels.file, .channels = levels.channels}, shown, output, report);
             });
    }

    std::string input_;
    std::string output_;
    RenderArguments arguments_;
    StreamArguments streams_;
    PictureArguments& picture_ = arguments_.picture;
    ShareArgument share_;
    std::optional<PictureShares> rows_{};  // this process draws some rows only
    std::optional<VdbGrid> grid_{};        // of voxels
    Box box_{};                            // of what is shown, with its range
    std::optional<Warp> moved_;            // by --warp
    bool said_limit_ = false;
    bool says_error_ = false;  // of the next picture
    Range range_{};
};

}  // namespace

std::unique_ptr<Verb> make_render_verb(CLI::App& program) {
    return std::make_unique<RenderVerb>(program);
}

}  // namespace subvol::cli
