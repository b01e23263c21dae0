// SPDX-License-Identifier: Apache-2.0
// The verb `view`: a session in which a volume is shown and changed by actions, in a window or by a script without one.
//
//     file and options ─► source   reads a step, refines, seeds streamlines, writes and measures pictures
//                      ─► body     a mesh, kernels of points, or voxels with kernels of them
//                      ─► state    camera, field, colours, cuts and method, as `render` would begin
//                      ─► session  runs actions, draws, and gives the state and the command of `render` for it
//
// Actions change the state alone; the options that no action changes are kept as words, those of reading the file apart from
// the others, so that the command draws the same picture. The window opens other files in the same way, one at a time, without
// the options that were about the first. A script reports how long each action waits for a first and for the full picture.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <utility>

#include "bricks_input.h"
#include "choices.h"
#include "grid_input.h"
#include "input.h"
#include "limit_warning.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "picture_arguments.h"
#include "points_input.h"
#include "render_arguments.h"
#include "sample_arguments.h"
#include "sampled_points.h"
#include "splat_arguments.h"
#include "steps.h"
#include "stream_arguments.h"
#include "subvol/detail/points_frame.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"
#include "subvol/option.h"
#include "subvol/picture_metrics.h"
#include "subvol/view_session.h"
#include "subvol/view_window.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// Options of the arguments that a session does not have.
constexpr std::array kNotHere{"--views",       "--turntable",     "--fps",      "--legend",    "--unit",
                              "--threshold",   "--reduce",        "--refine",   "--footprint", "--footprint-size",
                              "--color-field", "--shade",         "--duration", "--scale-bar", "--legend-side",
                              "--legend-size", "--legend-format", "--extremes"};

/// Options whose values actions change, so that the render command has them from the state; and those that only the window has.
constexpr std::array kOfTheState{
    "--iso",      "--clip",       "--clip-box",     "--slice",      "--around", "--size",     "--camera",  "--view",
    "--up",       "--fit",        "--ortho",        "--look",       "--tf",     "--tf-range", "--opacity", "--clamp",
    "--axes",     "--edges",      "--opacity-unit", "--background", "--method", "--field",    "--step",    "--time",
    "--script",   "--screenshot", "--only",         "--warp",       "--window", "--state",    "--json",    "--quiet",
    "--progress", "--log",        "--symlog",       "--bands",      "--below",  "--above"};

std::string text_of(const std::string& file) {
    std::string text = detail::read_text(file);
    if (text.empty()) throw Error(ErrorCode::InvalidInput, "is empty", file, "a JSON array of actions");
    return text;
}

class ViewVerb : public Verb {
public:
    explicit ViewVerb(CLI::App& program)
        : Verb(program, "view", "Show a mesh in an interactive window, or run a script of actions.",
               "  subvol view part.vtk\n"
               "  subvol view\n"
               "  subvol view run.pvd --field T --tf coolwarm\n"
               "  subvol view model:pawn --script turn.json --screenshot pawn.png") {
        show_limit_of_parts();
        add_input(app(), "FILE", input_,
                  text(input_help(),
                       "; or points (.ply, .vtp, .svk, .vdb), or a .vdb grid of floats (a level set: its surface). Without a "
                       "file the window begins with a page that opens one"));
        add_option(app(), Option("script", script_).help("FILE.json", "run a script of actions without a window, then quit"));
        add_option(app(), Option("screenshot", screenshot_).help("FILE", "write the last picture (.png or .exr), then quit"));
        add_option(app(),
                   Option("window", window_).help("play the --script in the window; --screenshot is then of the whole window"));
        add_option(app(), Option("state", saved_).help("FILE.json", "begin with a state that a session has saved"));
        add_option(app(), Option("method", method_name_)
                              .offer(view_methods())
                              .help("NAME", text(subvol::names_of(kViewMethods), ", as of render (default splat)")));
        picture_.add_to(app());
        streams_.add_to(app());
        const auto described = options_of(settings_);
        add_option(app(), *std::ranges::find(described, "samples", &Option::name));
        sample_.add_to(app());
        add_options(app(), options_of(clip_));
        refine_.add_to(app(), "show the refined mesh of this level (default for tets: 1, if large 0; others: the limit)");
        splat_.add_to(app());
        for (const char* option : kNotHere) app().remove_option(app().get_option(option));
        set_essentials({"--script", "--screenshot", "--window", "--state", "--field", "--look", "--tf", "--opacity",
                        "--background", "--size", "--view", "--camera", "--method", "--levels", "--json"});
        group("Camera", {"--size", "--camera", "--view", "--up", "--fit", "--ortho"});
        group("Colours and light", {"--look", "--tf", "--tf-range", "--log", "--symlog", "--bands", "--below", "--above",
                                    "--opacity", "--opacity-unit", "--background", "--clamp"});
        group("Kernels", {"--per-edge", "--centers", "--spacing", "--spacing-voxels", "--tolerance", "--values", "--kernel",
                          "--value-kernel", "--correction"});
        group("The limit", {"--scheme", "--tension", "--levels", "--crease-angle"});
        group("Cuts", {"--clip", "--clip-box", "--slice", "--around"});
        group("Streamlines",
              {"--streamlines", "--seeds", "--seed-count", "--stream-direction", "--stream-length", "--stream-time",
               "--stream-tolerance", "--stream-step", "--tube-radius", "--glyphs", "--glyph-count", "--glyph-size"});
        group("Methods", {"--method", "--samples", "--backend", "--device", "--sheets", "--plain-sums"});
    }

    int run(Report& report) override {
        method_ = named<Method>(method_name_, "--method");
        const bool headless = !window_ && (!script_.empty() || !screenshot_.empty());
        if (input_.empty() && (headless || !script_.empty() || !saved_.empty()))
            throw Error(ErrorCode::InvalidInput, "is missing", "FILE", "the window alone opens without one");
        if (!screenshot_.empty()) check_output(screenshot_, {".png", ".exr"});
        const std::string script = script_.empty() ? "[]" : text_of(script_);
        std::unique_ptr<ViewSession> session;
        if (!input_.empty()) {
            report["input"] = input_;
            Input first{input_, common()};
            for (const std::string* const vector : {&streams_.chosen.streamlines, &streams_.chosen.glyphs}) {
                if (!vector->empty()) first.options.at_rest.push_back(*vector);
            }
            session = session_of(first, !headless || !script_.empty(), report, report.progress());
            report["field"] = session->body().field();
            if (!saved_.empty()) session->run(Json{{"load_state", saved_}}.dump());
        }
        if (headless) {
            play(*session, script, report);
        } else {
            session = open_window(std::move(session), script, report);
            if (session) report["state"] = Json::parse(session->state_json());
        }
        if (session) {
            for (const std::string& warning : session->warnings()) report.warn(warning);
        }
        return 0;
    }

private:
    /// A file, and how it is read.
    struct Input {
        std::string file;
        CommonOptions options;
    };

    /// Reads a file and begins to draw it. method_may_change: options of other methods are not refused
    [[nodiscard]] std::unique_ptr<ViewSession> session_of(const Input& input, bool method_may_change, Report& report,
                                                          Progress* progress) {
        const bool voxels = !holds_points(input.file) && is_vdb_file(input.file);
        const bool points = voxels || holds_points(input.file);
        if (streams_.chosen.any()) veil_body(picture_.choices, clip_);
        std::optional<VdbGrid> grid;
        if (voxels) grid = report.unpack(load_grid(input.file, input.options, progress));
        const bool level_set = grid && grid->report().level_set;
        picture_.settle_look(!points || level_set);
        if (level_set) picture_.refuse_isosurfaces_of_level_set();
        picture_.check();
        const std::size_t warnings_before = report.json().value("warnings", Json::array()).size();
        ViewSource from = source(input, report);
        if (!points && !tets_.asked()) tets_ = TetRefinement(refine_);
        if (!points && tets_.asked())
            from.tets = [this, &report](HexMesh mesh, int level) {
                return report.unpack(tets_.hexes(std::move(mesh), level, report.progress()));
            };
        const BodyKind kind = voxels      ? BodyKind::Voxels
                              : points    ? BodyKind::Kernels
                              : from.tets ? BodyKind::Tets
                                          : BodyKind::Mesh;
        check_flow(streams_.chosen, method_, kind, true, OptionNames::Flags);
        check_options(method_may_change ? methods_of(kind) : bit(method_), kind, given_options(app()));
        if (points) from.points = voxels ? points_of_grid(*grid, report, progress) : points_of_file(input, report, progress);
        HexMesh mesh =
            points ? mesh_of_points(*from.points.volume) : report.unpack(load_mesh(input.file, input.options, progress));
        if (!points && !from.tets) report.warn(limit_warning(input.file, mesh, refine_.options(0, nullptr).scheme, progress));
        std::optional<std::string> field = input.options.density ? std::optional<std::string>("density") : input.options.field;
        if (streams_.chosen.any() && !field) field = streams_.chosen.length_of(mesh);
        if (voxels || (points && !field)) field = from.points.volume->channels.front().name;
        ViewBody body = points ? view_body(mesh, from.points, field) : view_body(mesh, field);
        if (from.tets) {
            const std::string name = body.field();
            body = view_body(from.tets(std::move(body.mesh), default_tet_level(method_)), name);
        }
        const auto methods = methods_of(body);
        if (std::ranges::find(methods, method_name_) == methods.end()) {
            throw Error(ErrorCode::InvalidInput, points ? "points and voxels have no cells" : "a mesh has no voxels",
                        "--method " + method_name_, join(methods));
        }
        MethodOptions settings = settings_;
        settings.kernels = sample_.kernel_options(body.box, refine_.options(0, nullptr), refine_.levels);
        settings.splat = splat_.options();
        const Json warnings = report.json().value("warnings", Json::array());
        for (std::size_t k = warnings_before; k < warnings.size(); ++k) from.notes.push_back(warnings[k]);
        const ViewState start = start_state(body, field, from, input);
        return std::make_unique<ViewSession>(std::move(from), std::move(mesh), start, settings);
    }

    [[nodiscard]] ViewPoints points_of_file(const Input& input, Report& report, Progress* progress) {
        const auto volume = std::make_shared<const RbfVolume>(report.unpack(load_all_points(input.file, app(), progress)));
        if (input.options.field) (void)find_channel(*volume, *input.options.field, input.file);
        return {.volume = volume, .box = detail::frame_of(*volume)};
    }

    /// The voxels with kernels of them; of a level set the kernels of the body within its surface.
    [[nodiscard]] ViewPoints points_of_grid(const VdbGrid& grid, Report& report, Progress* progress) {
        RbfVolume volume = report.unpack(sample_reported(grid, sample_, std::nullopt, app(), progress));
        if (grid.report().level_set)
            return {.volume = std::make_shared<const RbfVolume>(std::move(volume)), .box = grid.report().frame};
        volume.channels.front().name = grid.report().name;
        return {.volume = std::make_shared<const RbfVolume>(std::move(volume)),
                .voxels = grid.voxels(),
                .box = grid.report().frame,
                .range = ValueRange{grid.report().min, grid.report().max}};
    }

    /// Plays the script without a window.
    void play(ViewSession& session, const std::string& script, Report& report) {
        report.timed("play", [&] { session.run_script(script, script_, report.progress()); });
        const auto picture = report.timed("draw", [&] { return session.wait(); });
        if (!screenshot_.empty()) {
            const bool alone = !session.state().compare;
            write_image(screenshot_, session.composed(*picture), background_of(session.state()),
                        alone ? picture->depth : std::vector<float>{});
            report["output"] = screenshot_;
        }
        session.measure();
        if (const auto& figures = session.compared()) report["comparison"] = {{"psnr", figures->psnr}, {"flip", figures->flip}};
        report["method"] = name_of(session.state().method);
        report["backend"] = picture->backend;
        report["points"] = picture->points;
        report["render"] = session.render_command();
        report["state"] = Json::parse(session.state_json());
        report["waits"] = Json::array();
        for (const WaitReport& wait : session.waits()) {
            report["waits"].push_back({{"action", wait.action},
                                       {"first", wait.seconds_first},
                                       {"full", wait.seconds_full},
                                       {"coarse_scale", wait.coarse_scale},
                                       {"boundary", wait.seconds_boundary},
                                       {"kernels", wait.seconds_kernels},
                                       {"draw", wait.seconds_draw}});
        }
        if (const auto& picked = session.picked()) {
            report["picked"] = {{"at", {picked->place.x, picked->place.y, picked->place.z}},
                                {"value", picked->value},
                                {"gradient", {picked->gradient.x, picked->gradient.y, picked->gradient.z}},
                                {"cell", picked->cell}};
        }
    }

    /// Shows the window. returns: what it showed last
    [[nodiscard]] std::unique_ptr<ViewSession> open_window(std::unique_ptr<ViewSession> session, const std::string& script,
                                                           Report& report) {
        WindowOptions options{.script = script_.empty() ? "" : script, .script_file = script_};
        if (!screenshot_.empty()) options.window_shot = [this](const Image& window) { write_image(screenshot_, window); };
        options.first = {input_, common().only, common().warp};
        options.extensions = readable_mesh_extensions();
        options.extensions.insert(options.extensions.end(), {".ply", ".vtp", ".svk", ".vdb"});
        for (const char* model : {"model:pawn", "model:nozzle", "model:ball"}) options.models.emplace_back(model);
        options.recent_list = recent_list();
        options.open = [this, &report](const OpenedFile& file, Progress* progress) {
            const std::scoped_lock lock(reading_);
            Input input{file.name, common()};
            input.options.only = file.only;
            input.options.warp = file.warp;
            if (file.name != input_) forget_first(input.options);
            return session_of(input, true, report, progress);
        };
        return open_view_window(std::move(session), options);
    }

    /// Drops the options that were about the file of the command line.
    void forget_first(CommonOptions& options) {
        options.field.reset();
        options.density.reset();
        options.step.reset();
        options.read.step.reset();
        options.read.time.reset();
        options.read.blocks.clear();
        picture_.choices.range.reset();
        picture_.choices.opacity.reset();
        picture_.eye.camera.reset();
        streams_ = {};
        clip_ = {};
    }

    /// Where the names of files that were opened are kept.
    [[nodiscard]] static std::filesystem::path recent_list() {
        const char *state = std::getenv("XDG_STATE_HOME"), *home = std::getenv("HOME");
        if (state != nullptr && *state != '\0') return std::filesystem::path(state) / "subvol" / "recent";
        if (home != nullptr && *home != '\0') return std::filesystem::path(home) / ".local" / "state" / "subvol" / "recent";
        return {};
    }

    /// What `render` would show: the same camera, colours and light.
    [[nodiscard]] ViewState start_state(const ViewBody& body, const std::optional<std::string>& field, const ViewSource& from,
                                        const Input& input) const {
        const Optics optics = picture_.make_optics(body.box, body.range, body.range);
        const RbfVolume* const kernels = body.points.volume.get();  // framed as in `render`
        const std::vector<Vec3> framed = kernels == nullptr             ? framed_points(body.mesh, picture_.look, optics)
                                         : picture_.look == Look::Solid ? detail::outline_of(*kernels)
                                                                        : std::vector<Vec3>{};
        const View view = picture_.make_views(body.box, framed).front();
        ViewState state{.camera = view.camera(),
                        .up = picture_.eye.up,
                        .width = view.width(),
                        .height = view.height(),
                        .field = field.value_or("")};
        const bool one_state = !may_have_steps(input.file) || body.points.volume;
        const auto series_step = one_state ? std::nullopt : one_step(input.file, input.options);
        state.step = series_step.value_or(from.times.size() - 1);
        state.method = method_;
        state.look = picture_.look_options(body.range);
        if (picture_.background) state.background = picture_.background_color();
        state.axes = picture_.axes;
        state.clip = clip_;
        state.edges = picture_.edges;
        state.flow = {streams_.chosen, streams_.seeds};
        return state;
    }

    [[nodiscard]] ViewSource source(const Input& input, Report& report) {
        const std::string& file = input.file;
        const std::vector<double> times = may_have_steps(file) ? open_series(file).times : std::vector<double>{0};
        const int last = static_cast<int>(times.size()) - 1;
        const CommonOptions all = report.unpack(for_steps(file, input.options, {0, last}, report.progress()));
        const auto read = [this, &report, all, file](std::size_t step) {
            const std::scoped_lock lock(reading_);
            return report.unpack(load_mesh(file, of_step(all, static_cast<int>(step)), report.progress()));
        };
        const auto write = [](const std::filesystem::path& path, const Image& image, const Vec3& background) {
            write_image(path, image, background);
        };
        const auto measure = [](const Image& test, const Image& reference) {
            const PicturePair pair(test, reference);
            return PictureFigures{pair.differences().psnr, pair.flip().mean};
        };
        return {.input = file,
                .read = read,
                .times = times,
                .write_picture = write,
                .measure = measure,
                .seeds =
                    [](const ViewFlow& flow, const HexMesh& mesh, const LimitOptions& limit) {
                        return StreamArguments{flow.chosen, flow.seeds}.places(mesh, limit);
                    },
                .more_words = given_words(false, input.options),
                .read_words = given_words(true, input.options)};
    }

    /// Whether an option is about reading a file.
    [[nodiscard]] static bool is_of_reading(const std::string& name) {
        ReadOptions any;
        const auto described = options_of(any);
        const auto same = [&](const Option& option) { return "--" + option.name == name; };
        return std::ranges::any_of(described, same) || name == "--density" || name == "--weld" || name == "--interpolate-time";
    }

    /// Whether an option is about streamlines or arrows.
    [[nodiscard]] static bool is_of_flow(const std::string& name) {
        FlowChoices any;
        const auto described = options_of(any);
        return name == "--seeds" ||
               std::ranges::any_of(described, [&](const Option& option) { return "--" + option.name == name; });
    }

    /// The options that were given and that no action changes, as words. reading: those for reading the input, else the others
    [[nodiscard]] std::vector<std::string> given_words(bool reading, const CommonOptions& options) {
        std::vector<std::string> words;
        for (const CLI::Option* option : app().get_options()) {
            const std::string name = option->get_name();
            if (option->count() == 0 || option->get_positional() || is_of_reading(name) != reading) continue;
            if (std::ranges::any_of(kOfTheState, [&](const char* known) { return name == known; }) || is_of_flow(name))
                continue;
            for (const std::string& value : option->results()) {
                words.push_back(name);
                if (option->get_items_expected_max() > 0) words.push_back(value);
            }
        }
        if (!reading) return words;
        for (const std::string& region : options.only) words.insert(words.end(), {"--only", region});
        if (options.warp) words.insert(words.end(), {"--warp", *options.warp});
        return words;
    }

    std::string input_, script_, screenshot_, saved_;
    std::string method_name_ = "splat";
    Method method_ = Method::Splat;
    MethodOptions settings_;  // what options choose of them
    bool window_ = false;
    PictureArguments picture_;
    StreamArguments streams_;
    Clip clip_;
    SampleArguments sample_;
    SplatArguments splat_;
    RefineArguments refine_;
    TetRefinement tets_;
    std::mutex reading_;  // one file at a time
};

}  // namespace

std::unique_ptr<Verb> make_view_verb(CLI::App& program) {
    return std::make_unique<ViewVerb>(program);
}

}  // namespace subvol::cli
