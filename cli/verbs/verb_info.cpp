// SPDX-License-Identifier: Apache-2.0
// The verb `info`: the figures of what a file holds, by its kind.
//
//     mesh     counts, volume, quality, fields, blocks, patches, sets and steps, and a verdict; also folds of the limit, its
//              volume, or the figures of refined tetrahedra, if these are asked for
//     bricks   the same counts, found brick by brick
//     points   kernel, channels and boundary; of a file with levels of detail its head alone is read
//     grids    kind, active voxels, range and hash of each, and values at given places
//
// A mesh can be inspected in shares: each process finds the figures of a range of cells, and they are joined, or written as
// JSON for `join`. Options that a kind cannot have are refused. --field limits what is listed to one name.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <span>

#include "bricks_input.h"
#include "choices.h"
#include "grid_input.h"
#include "input.h"
#include "limit_warning.h"
#include "mesh_figures.h"
#include "numbers.h"
#include "options.h"
#include "part_note.h"
#include "points_input.h"
#include "share.h"
#include "steps.h"
#include "subvol/certificate.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/join_grids.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "subvol/points_io.h"
#include "subvol/splat.h"
#include "subvol/vdb_grid.h"
#include "tet_refinement.h"
#include "text.h"
#include "vdb_functions.h"
#include "verb.h"

namespace subvol::cli {
namespace {

Json device_json(const GlDevice& device) {
    return {{"index", device.index},
            {"renderer", device.renderer},
            {"hardware", device.hardware},
            {"version", device.version},
            {"max_ssbo_bytes", device.max_ssbo_bytes},
            {"memory_bytes", device.memory_bytes > 0 ? Json(device.memory_bytes) : Json(nullptr)}};
}

class InfoVerb : public Verb {
public:
    explicit InfoVerb(CLI::App& program)
        : Verb(program, "info", "Print statistics of a mesh, a .vdb file or a kernel file, and check the mesh for errors.",
               "  subvol info model:ball\n"
               "  subvol info ball.vdb --at 0,0,0 --at .5,0,0\n"
               "  subvol info part.vtu --folds\n"
               "  subvol info wing.bdf      by meshio or VTK, as files of many other programs\n"
               "  subvol info --gl\n"
               "\n"
               "JSON: blocks and sets, each with name, cells (those that it consists of after the splitting; blocks also "
               "elements, as the file counts them) and volume, as of the whole. With --folds: folds, with verdict, cells "
               "{proved, folded, undecided, irregular} and open_volume, as of "
               "check.") {
        app().add_option("FILE", input_, text(input_help(), ", or a .vdb file, or points (.ply, .vtp, .svk)"));
        add_option(app(), Option("list-fields", list_fields_).help("print the names of a mesh's fields only, one a line"));
        add_option(
            app(),
            Option("folds", folds_).help("how many cells are proved not to fold in the limit of MCQ (check: where they fold)"));
        add_option(app(), Option("limit", limit_).help("volume and box of the limit of MCQ, too"));
        add_option(app(), Option("gl", gl_).help("list the OpenGL devices that can splat"));
        app()
            .add_option("--at", points_,
                        "print the values of a .vdb file's grids there, or of the one that --field names (repeatable)")
            ->type_name("X,Y,Z")
            ->transform(number_list(3, "1,2,3"))
            ->allow_extra_args(false);
        refine_.scheme.clear();
        app()
            .add_option("--scheme", refine_.scheme, "figures of the refined tetrahedra, too: of tetoct or boxspline")
            ->type_name("NAME")
            ->check(offered(tet_schemes()));
        add_option(app(),
                   Option("levels", refine_.levels).between(0, 8).help("L", "of --scheme (default 2)").only_with("scheme"));
        add_option(app(), refine_.described()[2]);  // --crease-angle
        share_.add_to(app(), "the figures of some cells of a mesh, with --json");
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        kind_ = kind_of(input_);
        if (shares(share_) && (list_fields_ || gl_ || input_.empty() || is_no_mesh())) {
            throw Error(ErrorCode::InvalidInput, "only the figures of a mesh are found in shares",
                        ranks() != nullptr ? "info in several processes" : "--part");
        }
        set_refinement();
        if (folds_ && (list_fields_ || input_.empty() || shares(share_) || kind_ == InputKind::Bricks || is_no_mesh())) {
            throw Error(ErrorCode::InvalidInput, "needs a mesh in one piece, and one process", "--folds", "no --folds");
        }
        if (limit_ && (list_fields_ || input_.empty() || shares(share_) || kind_ == InputKind::Bricks || is_no_mesh())) {
            throw Error(ErrorCode::InvalidInput, "needs a mesh in one piece, and one process", "--limit", "no --limit");
        }
        if (is_no_mesh()) refuse_mesh_options(app(), "needs a mesh; these are points or grids");
        if (list_fields_) return list_fields(report);
        if (gl_) describe_gl(report);
        if (input_.empty()) {
            if (!gl_) throw Error(ErrorCode::InvalidInput, "a FILE is needed, or --gl", "info");
        } else {
            describe(report);
        }
        return 0;
    }

private:
    [[nodiscard]] bool is_no_mesh() const { return kind_ == InputKind::Points || kind_ == InputKind::Grid; }

    void describe(Report& report) {
        switch (kind_) {
            case InputKind::Bricks:
                return describe_bricks(report);
            case InputKind::Points:
                return describe_points(report);
            case InputKind::Grid:
                return describe_grids(report);
            case InputKind::Mesh:
            case InputKind::Picture:
                return describe_mesh(report);
        }
    }

    void set_refinement() {
        if (refine_.scheme.empty()) return;
        check_choice("--scheme", refine_.scheme, tet_schemes());
        tets_ = TetRefinement(refine_);
        if (list_fields_ || input_.empty() || shares(share_) || kind_ == InputKind::Bricks || is_no_mesh()) {
            throw Error(ErrorCode::InvalidInput, "needs a mesh in one piece, and one process", "--scheme", "no --scheme");
        }
    }

    static void describe_gl(Report& report) {
        const std::vector<GlDevice> devices = gl_devices();
        report["gl"] = Json(nullptr);
        if (!devices.empty()) report["gl"] = {{"renderer", devices.front().renderer}, {"hardware", devices.front().hardware}};
        report["gl_devices"] = Json::array();
        for (const GlDevice& device : devices) report["gl_devices"].push_back(device_json(device));
    }

    int list_fields(Report& report) {
        if (input_.empty()) throw Error(ErrorCode::InvalidInput, "a FILE is needed", "--list-fields");
        report["fields"] = Json::array();
        const auto list = [&](const std::string& name) {
            if (!shows(name)) return;
            report["fields"].push_back({{"name", name}});
            report.answer(name);
        };
        if (kind_ == InputKind::Bricks) {
            for (const BrickField& field : report.unpack(open_bricks_input(input_, app())).fields) list(field.name);
        } else if (holds_levels(input_)) {
            report["input"] = input_;
            const KernelFile file(input_);
            for (const auto& channel : file.contents().channels) list(channel.name);
        } else if (kind_ == InputKind::Points) {
            report["input"] = input_;
            const RbfVolume volume = report.unpack(read_points_input(input_, report.progress()));
            for (const RbfChannel& channel : volume.channels) list(channel.name);
        } else if (kind_ == InputKind::Grid) {
            for (const VdbGrid& grid : vdb().read_vdb(input_)) list(grid.report().name);
        } else {
            report["input"] = input_;
            const ReadResult read = report.unpack(read_input(input_, common(), report.progress()));
            for (const FieldInfo& field : chosen_fields(read, common())) list(field.name);
        }
        if (report.json().at("fields").empty() && common().field) {
            throw Error(ErrorCode::InvalidInput, "there is no field '" + *common().field + "'", input_, "--list-fields alone");
        }
        report.all_said();
        return 0;
    }

    /// Whether this is the field that --field names, or the one whose component it names; without --field all are shown.
    [[nodiscard]] bool shows(const std::string& name) const {
        return !common().field || *common().field == name || common().field->starts_with(name + ".");
    }

    void refuse_at(const std::string& what) const {
        if (points_.empty()) return;
        throw Error(ErrorCode::InvalidInput, "reads values from grids in .vdb files only, not from " + what, "--at");
    }

    void describe_mesh(Report& report) {
        refuse_at("a mesh");
        const ShellsAlone alone = shares(share_) ? ShellsAlone::Refuse : ShellsAlone::Take;
        report["input"] = input_;
        ReadResult read = report.unpack(read_input(input_, common(), report.progress(), alone));
        read.fields = chosen_fields(read, common());
        if (!is_model(input_)) put_steps(read, report);
        detail::MeshShare about;
        if (shares(share_)) {
            const Share share = share_of(share_);
            about = joined(share, report, [&] { return detail::inspect_share(read.mesh, share, kCellsNamed); });
            if (!speaks()) return;
        } else {
            about.counts = report.timed("inspect", [&] { return figures_of(read, report.progress()); });
            if (about.counts.inverted_cells > 0) about.inverted = inverted_cells(read.mesh, kCellsNamed);
        }
        report.merge(facts_of(about.counts));
        if (read.sharp_edges && read.sharp_edges->steps)
            report.note("its sharp edges are steps, as voxels have them: --crease-angle none makes them smooth");
        if (!read.shells.empty()) {
            const ShellReport shells = inspect(read.shells);
            report["sheets"] = {{"quads", shells.quads},           {"lines", shells.lines},
                                {"points", shells.points},         {"attached_points", shells.attached},
                                {"free_edges", shells.free_edges}, {"nonmanifold_edges", shells.nonmanifold_edges}};
        }
        if (!read.mesh.creases.empty()) report["creases"] = read.mesh.creases.size();
        if (!read.mesh.sharp_faces.empty()) report["sharp_faces"] = read.mesh.sharp_faces.size();
        report["fields"] = Json::array();
        for (const FieldInfo& field : read.fields) {
            report["fields"].push_back({{"name", field.name},
                                        {"location", field.location},
                                        {"components", field.components},
                                        {"min", field.min},
                                        {"max", field.max}});
            if (!field.unit.empty()) report["fields"].back()["unit"] = field.unit;
        }
        std::optional<FoldReport> folds;
        if (folds_) {
            folds = report.timed("folds", [&] { return check_folds(read.mesh, {.progress = report.progress()}).report; });
            Facts found;
            found["folds"] = facts_of(*folds);
            report.merge(found);
        }
        std::optional<LimitBody> limit;
        if (limit_) {
            limit = report.timed("limit", [&] { return limit_body(read.mesh, {}, 2, report.progress()); });
            report["limit_volume"] = limit->volume;
            report["limit_bounds"] = json_of(limit->bounds);
            if (!is_model(input_)) report.warn(limit_warning(*limit));
        }
        if (tets_.asked()) {
            report["refined"] = json_of(report.unpack(tets_.figures(used_mesh(read.mesh, {}), 2, report.progress())));
        }
        if (!share_.given()) report["verdict"] = verdict(about.counts, about.inverted);
        if (gl_) return;  // the table has all
        std::string lines = mesh_lines(read, about, report.json().at("seconds"), steps_text(report.json()));
        lines.pop_back();
        report.say(lines);
        if (limit) report.say(limit_lines(*limit));
        if (folds) report.say(text("folds        ", fold_text(*folds, read.mesh.cells.size()), "; of the limit of MCQ"));
        if (tets_.asked()) report.say(refined_lines(report.json().at("refined")));
        report.all_said();
    }

    [[nodiscard]] static std::string limit_lines(const LimitBody& limit) {
        using detail::number_text;
        std::string lines = "limit        volume " + number_text(limit.volume);
        for (int axis = 0; axis < 3; ++axis)
            lines += text("  ", "xyz"[axis], " ", number_text(limit.bounds.lower[axis]), " … ",
                          number_text(limit.bounds.upper[axis]));
        return lines + "; of MCQ";
    }

    /// The figures of a mesh; shells without cells have only points and a box.
    [[nodiscard]] static MeshReport figures_of(const ReadResult& read, Progress* progress) {
        if (!read.mesh.cells.empty()) return inspect(read.mesh, progress);
        MeshReport report;
        report.points = read.mesh.points.size();
        for (const Vec3& p : read.shells.points) report.bounds.add(p);
        return report;
    }

    void describe_bricks(Report& report) {
        refuse_at("bricks");
        const Bricks bricks = report.unpack(open_bricks_input(input_, app()));
        if (common().field) (void)named_brick_field(bricks, *common().field, true);  // refuses what does not exist
        const Share share = share_of(share_);
        const detail::MeshShare about = joined(
            share, report, [&] { return detail::inspect_share(source_of(bricks), share, kCellsNamed, report.progress()); });
        if (!speaks()) return;
        report.merge(facts_of(about.counts));
        report["halo_layers"] = bricks.halo_layers;
        std::uint64_t bytes = 0;
        for (const Brick& brick : bricks.bricks) bytes += brick.bytes;
        report["bytes"] = bytes;
        report["fields"] = Json::array();
        for (const BrickField& field : bricks.fields) {
            if (!shows(field.name)) continue;
            report["fields"].push_back({{"name", field.name},
                                        {"location", "point"},
                                        {"components", field.channels},
                                        {"min", field.shortest},
                                        {"max", field.longest}});
        }
        if (!share_.given()) report["verdict"] = verdict(about.counts, about.inverted);
    }

    /// The figures of the whole mesh; with --part those of this share, which go into the report.
    ///
    /// inspect: finds the figures of this process's share
    template <class Inspect>
    [[nodiscard]] detail::MeshShare joined(const Share& share, Report& report, const Inspect& inspect) {
        if (share_.given() && !common().json) {
            throw Error(ErrorCode::InvalidInput, "the figures of a share are for `subvol join`, which reads JSON", "--part",
                        "--json, and the output in a file");
        }
        detail::MeshShare figures = report.timed("inspect", inspect);
        if (share_.given()) {
            report["part"] = share.name();
            report["part_note"] = text_of(make_note(app(), input_, share, figures.range));
            report["part_figures"] = json_of(figures);
            return figures;
        }
        return report.unpack(join_ranks(FigureParts{}, figures, ranks(), report.progress())).value_or(figures);
    }

    void put_steps(const ReadResult& read, Report& report) const {
        const MeshSeries series = open_series(input_);
        const std::size_t step = one_step(input_, common()).value_or(series.size() - 1);
        report["steps"] = series.size();
        report["times"] = series.times;
        report["step"] = step;
        report["blocks"] = Json::array();
        for (const MeshBlock& block : read.blocks) {
            const auto set = std::ranges::find(read.sets.sets, block.name, &CellSet::name);
            Json one{{"name", block.name}, {"cells", block.cells}, {"elements", block.cells}};
            if (set != read.sets.sets.end()) {
                one["cells"] = set->cells.size();
                one["volume"] = volume_of(read.mesh, *set);
            }
            report["blocks"].push_back(std::move(one));
        }
        report["patches"] = Json::array();
        for (const Patch& patch : read.sets.patches)
            report["patches"].push_back({{"name", patch.name}, {"faces", patch.sides.size()}});
        report["sets"] = Json::array();
        for (const CellSet& set : read.sets.sets)
            report["sets"].push_back({{"name", set.name}, {"cells", set.cells.size()}, {"volume", volume_of(read.mesh, set)}});
    }

    /// "0 to 4, times 0 … 0.4; this is step 4"; empty if there is one step.
    [[nodiscard]] static std::string steps_text(const Json& json) {
        if (json.value("steps", 1) < 2) return {};
        const Json& times = json.at("times");
        const auto time = [](const Json& t) { return t.is_number() ? text(t.get<double>()) : std::string("unknown"); };
        return text("0 to ", times.size() - 1, ", times ", time(times.front()), " … ", time(times.back()), "; this is step ",
                    json.at("step").get<std::size_t>());
    }

    /// The head of a file with levels of detail; nothing else is read.
    void describe_levels(Report& report) {
        report["input"] = input_;
        KernelFileContents contents = report.timed("read", [&] { return KernelFile(input_).contents(); });
        if (common().field) {
            const LevelsInput levels = report.unpack(open_levels(input_, common(), {}, 0, app(), report.progress()));
            contents.channels = {contents.channels[levels.channels.front()]};
        }
        report["points"] = contents.kernels;
        report["kernel"] = Json::parse(subvol::to_json(contents.kernel));
        report["bounds"] = json_of(contents.bounds);
        report["boundary_triangles"] = contents.boundary_triangles;
        for (const auto& channel : contents.channels) {
            report["channels"].push_back({{"name", channel.name}, {"min", channel.min}, {"max", channel.max}});
        }
        report["levels"] = contents.levels;
        report["blocks"] = contents.blocks;
        report["bytes"] = contents.bytes;
    }

    void describe_points(Report& report) {
        refuse_at("points");
        if (holds_levels(input_)) return describe_levels(report);
        report["input"] = input_;
        RbfVolume volume = report.unpack(read_points_input(input_, report.progress()));
        if (common().field) volume.channels = {volume.channels[find_channel(volume, *common().field, input_)]};
        report["kernel"] = Json::parse(subvol::to_json(volume.kernel));
        report["bounds"] = json_of(volume.bounds);
        report["boundary_triangles"] = volume.boundary.triangles.size();
        for (const RbfChannel& channel : volume.channels) {
            const auto [min, max] = std::ranges::minmax(channel.values);
            report["channels"].push_back({{"name", channel.name}, {"min", min}, {"max", max}});
        }
    }

    void describe_grids(Report& report) {
        report["input"] = input_;
        const VdbContents contents = report.timed("read", [&] { return vdb().read_vdb_contents(input_); });
        if (common().field) (void)select_grid(contents, common().field, input_);  // refuses what does not exist
        report["grids"] = Json::array();
        for (const VdbGrid& grid : contents.grids) {
            const GridReport& about = grid.report();
            if (!shows(about.name)) continue;
            report["grids"].push_back({{"name", about.name},
                                       {"kind", about.kind},
                                       {"active_voxels", about.active_voxels},
                                       {"voxel_size", about.voxel_size_world},
                                       {"bounds", json_of(about.bounds)},
                                       {"min", about.min},
                                       {"max", about.max},
                                       {"bytes", about.bytes},
                                       {"hash", detail::hex_digits(vdb().hash_of_grid(grid))}});
        }
        for (const auto& [name, type] : contents.others) {
            if (shows(name)) report["grids"].push_back({{"name", name}, {"kind", type}});
        }
        if (points_.empty()) return;
        const std::vector<VdbGrid> scalars = probed(contents);
        for (const std::string& point : points_) {
            const Vec3 x = parse_vector("--at", point);
            for (const VdbGrid& scalar : scalars) {
                const std::optional<double> value = scalar.value(x);
                report["at"].push_back(
                    {{"point", json_of(x)}, {"field", scalar.report().name}, {"value", value ? Json(*value) : Json(nullptr)}});
            }
        }
    }

    /// What --at reads: the grid that --field names, else all, vectors by their components.
    [[nodiscard]] std::vector<VdbGrid> probed(const VdbContents& contents) const {
        std::vector<VdbGrid> scalars;
        if (common().field) {
            scalars.push_back(select_grid(contents, common().field, input_));
            return scalars;
        }
        for (const VdbGrid& grid : contents.grids) {
            const std::string& name = grid.report().name;
            if (grid.report().kind == "vector") {
                for (int c = 0; c < 3; ++c) scalars.push_back(vdb().scalar_of(grid, c, name + "." + "xyz"[c]));
            } else {
                scalars.push_back(vdb().scalar_of(grid, std::nullopt, name));
            }
        }
        return scalars;
    }

    std::string input_;
    bool gl_ = false;
    bool folds_ = false;
    bool limit_ = false;
    bool list_fields_ = false;
    InputKind kind_ = InputKind::Mesh;
    std::vector<std::string> points_;
    RefineArguments refine_;  // of --scheme
    TetRefinement tets_;
    ShareArgument share_;
};

}  // namespace

std::unique_ptr<Verb> make_info_verb(CLI::App& program) {
    return std::make_unique<InfoVerb>(program);
}

}  // namespace subvol::cli
