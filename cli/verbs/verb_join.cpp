// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "mesh_figures.h"
#include "options.h"
#include "outputs.h"
#include "part_kinds.h"
#include "subvol/brick_points.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/surface_share.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/option.h"
#include "subvol/points_io.h"
#include "subvol/vdb_contents.h"
#include "surface_output.h"
#include "text.h"
#include "vdb_functions.h"
#include "vdb_output.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class JoinVerb : public Verb {
public:
    explicit JoinVerb(CLI::App& program)
        : Verb(program, "join", "Merge the part files written with --part.",
               "  subvol join part1.vdb part2.vdb part3.vdb -o big.vdb\n"
               "  subvol join part*.ply -o big.ply\n"
               "  subvol join part*.svshare -o iso.stl\n"
               "\n"
               "The result is that of one process without --part: the same points, the same leaves. The list of files that "
               "`vdb --memory` and `vdb` of bricks write is one PART.",
               Reads::NoMesh) {
        add_input(app(), "PART", parts_,
                  "the parts, in any order: .vdb of `vdb`, .ply or .vtp of `points`, .exr of `render`, .svshare of "
                  "`surface`, JSON of `info`; or the list (.json) of a grid in several files")
            ->required()
            ->expected(1, -1);
        add_option(app(), Option("output", output_).also("o").help("FILE", "the file to write"))->required();
    }

    int run(Report& report) override {
        report["parts"] = parts_.size();
        const std::string extension = std::filesystem::path(parts_.front()).extension().string();
        for (const std::string& part : parts_) {
            if (!std::filesystem::exists(part)) throw Error(ErrorCode::Io, "cannot be read: no such file", part);
        }
        if (extension == ".vdb") {
            join_grids_of_parts(report);
        } else if (is_points_file(parts_.front())) {
            join_points(report);
        } else if (extension == ".exr") {
            join_pictures(report);
        } else if (extension == detail::kSurfaceShareExtension) {
            join_surfaces(report);
        } else if (extension == ".json" && output_.ends_with(".vdb")) {
            join_listed_grids(report);
        } else if (extension == ".json") {
            join_figures(report);
        } else {
            throw Error(ErrorCode::InvalidInput, "is not a part that can be joined", parts_.front(),
                        ".vdb, .ply, .vtp, .exr, .svshare or .json");
        }
        return 0;
    }

private:
    /// Joins all parts, and keeps what they say of how the whole is to be written.
    template <class Kind>
    [[nodiscard]] typename Kind::Whole joined(const Kind& kind, Report& report) {
        auto files = report.unpack(join_files(kind, parts_, report.progress()));
        how_ = std::move(files.how);
        return std::move(files.whole);
    }

    void join_grids_of_parts(Report& report) {
        check_output(output_, {".vdb"});
        std::vector<VdbGrid> grids = joined(GridParts{}, report);
        for (VdbGrid& grid : grids) vdb().store_in_half(grid, how("half", false));
        const auto compression = named<VdbCompression>(how("compression", std::string("blosc")), "compression");
        report.merge(write_reported(grids, {.path = output_, .compression = compression}, report.progress()));
    }

    /// The grids of the files that a list of `vdb` names, which lie beside it.
    void join_listed_grids(Report& report) {
        const std::string& list = parts_.front();
        if (parts_.size() > 1) throw Error(ErrorCode::InvalidInput, "is one part too many: a list names all files", parts_[1]);
        const Json json = Json::parse(detail::of_limited_depth(detail::read_text(list), list), nullptr, false);
        const Json files = json.is_object() && json.contains("parts") ? json["parts"] : Json();
        std::vector<std::string> names;
        std::set<std::string> listed;
        for (const Json& entry : files.is_array() ? files : Json::array()) {
            if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) break;
            const std::filesystem::path name = std::filesystem::path(entry["file"].get<std::string>()).filename();
            names.push_back((std::filesystem::path(list).parent_path() / name).string());
            if (!detail::not_regular(names.back()).empty()) {
                throw Error(ErrorCode::InvalidInput, "is not a regular file", names.back());
            }
            if (!listed.insert(names.back()).second) throw Error(ErrorCode::InvalidInput, "is listed twice", names.back());
        }
        if (names.empty() || names.size() != files.size()) {
            throw Error(ErrorCode::InvalidInput, "is not a list of grids in several files", list,
                        "the one that `vdb` writes beside them");
        }
        report["parts"] = names.size();
        std::vector<std::vector<VdbGrid>> read;
        report.timed("read", [&] {
            for (const std::string& name : names) read.push_back(vdb().read_vdb_contents(name).grids);
        });
        if (read.front().empty()) throw Error(ErrorCode::InvalidInput, "has no grids", names.front());
        const std::vector<VdbGrid> grids = report.timed("join", [&] { return GridParts::join(std::move(read), names); });
        report.merge(write_reported(grids, {.path = output_}, report.progress()));
    }

    void join_points(Report& report) {
        check_output(output_, {".ply", ".vtp", ".svk", ".vdb", ".npz", ".glb"});
        const std::optional<std::string> note = read_points_note(parts_.front());
        if (note) {
            PartNote first = note_from(*note, parts_.front());
            if (first.how.contains("points")) return join_points_of_bricks(std::move(first), report);
        }
        const RbfVolume volume = joined(KernelParts{}, report);
        const std::optional<UpAxis> up = find_named<UpAxis>(how("up", std::string("z")));
        if (!up) fail_note(parts_.front());
        const PointsWriteOptions options{.ascii = how("ascii", false), .splats = how("splats", false), .up = *up};
        report.merge(write_kernels(output_, volume, options, report.progress()));
        report["points"] = volume.size();
        report.merge(files_of_kernels(output_, volume, options));
    }

    /// One part at a time: the whole may not fit into memory.
    void join_points_of_bricks(PartNote first, Report& report) {
        check_output(output_, {".ply", ".svk"});
        how_ = std::move(first.how);
        const BrickPointsReport written =
            joined(StoredKernelParts{output_, how("points", std::uint64_t{0}), report.progress()}, report);
        report["output"] = output_;
        report["points"] = written.points;
    }

    void join_pictures(Report& report) {
        check_output(output_, {".exr", ".png"});
        const Picture picture = joined(PictureParts{}, report);
        const auto background = how("background", std::vector<double>(3));
        if (background.size() != 3) throw Error(ErrorCode::InvalidInput, "its note has no background", parts_.front());
        report.timed("write", [&] {
            write_image(output_, picture.image, Vec3(background[0], background[1], background[2]), picture.depth,
                        how("camera", std::string()));
        });
        report["output"] = output_;
    }

    void join_surfaces(Report& report) {
        check_output(output_, {".ply", ".stl", ".vtp", ".obj", ".glb", ".vtkhdf"});
        const LimitSurface surface = joined(SurfaceParts{.progress = report.progress()}, report);
        const SurfaceOutput output = surface_output_from(how_, parts_.front());
        if (output.file.color && output_.ends_with(".stl")) {
            throw Error(ErrorCode::InvalidInput, ".stl has no colours", output_, ".ply, .vtp, .obj, .glb");
        }
        check_not_empty(surface, output);
        if (output.file.color && *output.file.color >= surface.fields.size()) fail_note(parts_.front());
        report.merge(write_reported(output_, surface, output, report.progress()));
    }

    /// The figures that `info` finds in one process, in a file and as the report.
    void join_figures(Report& report) {
        check_output(output_, {".json"});
        const detail::MeshShare whole = joined(FigureParts{}, report);
        Json json = object_in(parts_.front());  // what does not depend on the share
        for (const char* key : {"part", "part_note", "part_figures", "peak_bytes", "seconds"}) json.erase(key);
        report.take(std::move(json));
        report.merge(facts_of(whole.counts));
        report["verdict"] = verdict(whole.counts, whole.inverted);
        detail::write_text_file(output_, report.json().dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
        report["parts"] = parts_.size();
        report["output"] = output_;
    }

    /// What the first part says of how the whole is written.
    template <class Value>
    [[nodiscard]] Value how(const char* key, Value otherwise) const {
        return how_of(how_, key, std::move(otherwise), parts_.front());
    }

    std::vector<std::string> parts_;
    std::string output_;
    Json how_;  // of the first part
};

}  // namespace

std::unique_ptr<Verb> make_join_verb(CLI::App& program) {
    return std::make_unique<JoinVerb>(program);
}

}  // namespace subvol::cli
