// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "mesh_figures.h"
#include "mesh_lines.h"
#include "outputs.h"
#include "part_note.h"
#include "subvol/brick_points.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/picture_part.h"
#include "subvol/detail/points_range.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/surface_share.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/join_grids.h"
#include "subvol/kernel_file.h"
#include "subvol/points_io.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_points.h"
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
        app()
            .add_option("PART", parts_,
                        "the parts, in any order: .vdb of `vdb`, .ply or .vtp of `points`, .exr of `render`, .svshare of "
                        "`surface`, JSON of `info`; or the list (.json) of a grid in several files")
            ->required()
            ->expected(1, -1);
        app().add_option("-o,--output", output_, "the file to write")->type_name("FILE")->required();
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
    /// note: of a file, nothing if it has none
    template <class Note>
    [[nodiscard]] std::vector<std::size_t> ordered(const Note& note) {
        std::vector<FoundPart> found;
        for (const std::string& part : parts_) {
            const std::optional<std::string> text = note(part);
            if (!text) refuse_whole(part);
            found.push_back({part, note_from(*text, part)});
        }
        how_ = found.front().note.how;
        return order_of(found);
    }

    void join_grids_of_parts(Report& report) {
        check_output(output_, {".vdb"});
        std::vector<std::vector<VdbGrid>> read;
        report.timed("read", [&] {
            for (const std::string& part : parts_) {
                VdbContents contents = vdb().read_vdb_contents(part);
                if (contents.grids.empty()) refuse_whole(part);
                read.push_back(std::move(contents.grids));
            }
        });
        std::size_t at = 0;
        const std::vector<std::size_t> order =
            ordered([&](const std::string&) { return vdb().text_of_grid(read[at++].front(), kPartNote); });
        std::vector<VdbGrid> grids = joined(std::move(read), order, parts_, report);
        for (VdbGrid& grid : grids) {
            vdb().set_text_of_grid(grid, kPartNote, {});
            vdb().store_in_half(grid, how("half", false));
        }
        const auto compression = named<VdbCompression>(how("compression", std::string("blosc")), "compression");
        report.merge(write_reported(grids, {.path = output_, .compression = compression}, report.progress()));
    }

    /// of_files: the grids of each file; order: of the files; names: theirs
    [[nodiscard]] static std::vector<VdbGrid> joined(std::vector<std::vector<VdbGrid>> of_files,
                                                     const std::vector<std::size_t>& order,
                                                     const std::vector<std::string>& names, Report& report) {
        return report.timed("join", [&] {
            std::vector<VdbGrid> grids;
            const std::size_t count = of_files.front().size();
            for (std::size_t g = 0; g < count; ++g) {
                std::vector<VdbGrid> of_parts;
                for (const std::size_t p : order) {
                    if (of_files[p].size() != count)
                        throw Error(ErrorCode::InvalidInput, "has other grids than other parts", names[p]);
                    of_parts.push_back(std::move(of_files[p][g]));
                }
                grids.push_back(vdb().join_grids(std::move(of_parts)));
            }
            return grids;
        });
    }

    /// The grids of the files that a list of `vdb` names, which lie beside it.
    void join_listed_grids(Report& report) {
        const std::string& list = parts_.front();
        if (parts_.size() > 1) throw Error(ErrorCode::InvalidInput, "is one part too many: a list names all files", parts_[1]);
        const Json json = Json::parse(detail::of_limited_depth(detail::read_text(list), list), nullptr, false);
        const Json files = json.is_object() && json.contains("parts") ? json["parts"] : Json();
        std::vector<std::string> names;
        std::vector<std::size_t> order;
        std::set<std::string> listed;
        for (const Json& entry : files.is_array() ? files : Json::array()) {
            if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) break;
            const std::filesystem::path name = std::filesystem::path(entry["file"].get<std::string>()).filename();
            order.push_back(names.size());
            names.push_back((std::filesystem::path(list).parent_path() / name).string());
            if (!detail::not_regular(names.back()).empty()) {
                throw Error(ErrorCode::InvalidInput, "is not a regular file", names.back());
            }
            if (!listed.insert(names.back()).second) throw Error(ErrorCode::InvalidInput, "is listed twice", names.back());
        }
        if (names.empty() || names.size() != files.size()) {
            throw Error(ErrorCode::InvalidInput, "is no list of grids in several files", list,
                        "the one that `vdb` writes beside them");
        }
        report["parts"] = names.size();
        std::vector<std::vector<VdbGrid>> read;
        report.timed("read", [&] {
            for (const std::string& name : names) read.push_back(vdb().read_vdb_contents(name).grids);
        });
        if (read.front().empty()) throw Error(ErrorCode::InvalidInput, "has no grids", names.front());
        report.merge(write_reported(joined(std::move(read), order, names, report), {.path = output_}, report.progress()));
    }

    void join_points(Report& report) {
        check_output(output_, {".ply", ".vtp", ".svk", ".vdb"});
        const std::vector<std::size_t> order =
            ordered([](const std::string& part) { return is_points_file(part) ? read_points_note(part) : std::nullopt; });
        if (how_.contains("points")) return join_points_of_bricks(order, report);
        RbfVolume volume;
        report.timed("read", [&] {
            for (const std::size_t p : order) {
                RbfVolume part = read_points(parts_[p]);
                if (p == order.front()) {
                    volume = std::move(part);
                } else {
                    detail::append_kernels(volume, part);
                }
            }
        });
        const std::optional<UpAxis> up = find_named<UpAxis>(how("up", std::string("z")));
        if (!up) fail_note(parts_.front());
        const PointsWriteOptions options{.ascii = how("ascii", false), .splats = how("splats", false), .up = *up};
        report.timed("write", [&] {
            if (output_.ends_with(".vdb")) {
                vdb().write_vdb_points(output_, volume, {});
            } else if (output_.ends_with(".svk")) {
                static_cast<void>(write_kernel_file(output_, volume, report.progress()));
            } else {
                write_points(output_, volume, options);
            }
        });
        report["output"] = output_;
        report["points"] = volume.size();
        const bool inside = output_.ends_with(".svk") || (output_.ends_with(".ply") && !options.splats);
        if (!inside && !volume.boundary.triangles.empty()) report["boundary"] = detail::boundary_path(output_).string();
    }

    /// One part at a time: the whole may not fit into memory.
    void join_points_of_bricks(const std::vector<std::size_t>& order, Report& report) {
        check_output(output_, {".ply", ".svk"});
        const auto points = how("points", std::uint64_t{0});
        std::vector<std::filesystem::path> files;
        for (const std::size_t p : order) files.emplace_back(parts_[p]);
        const BrickPointsReport written =
            report.timed("write", [&] { return subvol::join_points_of_bricks(output_, files, points, report.progress()); });
        report["output"] = output_;
        report["points"] = written.points;
    }

    void join_pictures(Report& report) {
        check_output(output_, {".exr", ".png"});
        std::vector<detail::PicturePart> read;
        std::vector<Json> how;
        report.timed("read", [&] {
            for (const std::string& part : parts_) read.push_back(detail::read_picture_part(part));
        });
        std::size_t at = 0;
        const std::vector<std::size_t> order = ordered([&](const std::string& part) -> std::optional<std::string> {
            const std::string& note = read[at++].note;
            if (note.empty()) return std::nullopt;
            how.push_back(note_from(note, part).how);
            return note;
        });
        const detail::PicturePart& first = read[order.front()];
        Image image(first.rows.width, first.whole_height);
        std::vector<float> depth(first.depth.empty() ? 0 : image.rgba.size() / 4);
        int next = 0;
        for (const std::size_t p : order) {
            const detail::PicturePart& part = read[p];
            const int begin = how_of(how[p], "first_row", -1, parts_[p]), end = how_of(how[p], "end_row", -1, parts_[p]);
            const bool fits = begin == next && end >= begin && end <= image.height && part.rows.width == image.width &&
                              part.depth.empty() == depth.empty() &&
                              (begin == end || (part.first_row == begin && part.rows.height == end - begin));
            if (!fits) throw Error(ErrorCode::InvalidInput, "its rows do not fit to those of the other parts", parts_[p]);
            next = end;
            if (begin == end) continue;
            const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(begin) * image.width;
            std::ranges::copy(part.rows.rgba, image.rgba.begin() + 4 * offset);
            if (!depth.empty()) std::ranges::copy(part.depth, depth.begin() + offset);
        }
        if (next != image.height) throw Error(ErrorCode::InvalidInput, "the parts do not fill the picture", "join");
        const std::vector<double> background =
            how_of(how[order.front()], "background", std::vector<double>(3), parts_[order.front()]);
        if (background.size() != 3) throw Error(ErrorCode::InvalidInput, "its note has no background", parts_[order.front()]);
        report.timed("write", [&] { write_image(output_, image, {background[0], background[1], background[2]}, depth); });
        report["output"] = output_;
    }

    void join_surfaces(Report& report) {
        check_output(output_, {".ply", ".stl", ".vtp", ".obj", ".glb"});
        std::vector<detail::SurfaceShareFile> read;
        report.timed("read", [&] {
            for (const std::string& part : parts_) read.push_back(detail::read_surface_share(part));
        });
        std::size_t at = 0;
        const std::vector<std::size_t> order =
            ordered([&](const std::string&) { return std::optional<std::string>(read[at++].note); });
        const SurfaceOutput output = surface_output_from(how_, parts_.front());
        if (output.file.color && output_.ends_with(".stl")) {
            throw Error(ErrorCode::InvalidInput, ".stl has no colours", output_, ".ply, .vtp, .obj, .glb");
        }
        std::vector<std::string> shares, names;
        for (const std::size_t p : order) {
            shares.push_back(std::move(read[p].bytes));
            names.push_back(parts_[p]);
        }
        const LimitSurface surface =
            report.timed("join", [&] { return detail::join_surface(std::move(shares), names, report.progress()); });
        check_not_empty(surface, output);
        if (output.file.color && *output.file.color >= surface.fields.size()) fail_note(parts_.front());
        report.merge(write_reported(output_, surface, output, report.progress()));
    }

    /// The figures that `info` finds in one process, in a file and as the report.
    void join_figures(Report& report) {
        check_output(output_, {".json"});
        std::vector<Json> read;
        for (const std::string& part : parts_) {
            read.push_back(Json::parse(detail::of_limited_depth(detail::read_text(part), part), nullptr, false));
            if (!read.back().is_object()) throw Error(ErrorCode::InvalidInput, "is not one object of JSON", part);
        }
        std::size_t at = 0;
        const std::vector<std::size_t> order = ordered([&](const std::string&) -> std::optional<std::string> {
            const Json& json = read[at++];
            if (!json.contains("part_note") || !json["part_note"].is_string()) return std::nullopt;
            return json["part_note"].get<std::string>();
        });
        std::vector<detail::MeshShare> shares;
        for (const std::size_t p : order) {
            shares.push_back(mesh_share_from(read[p].value("part_figures", Json::object()), parts_[p]));
        }
        const detail::MeshShare whole = detail::join_shares(shares, kCellsNamed);
        Json json = read[order.front()];  // what does not depend on the share
        for (const char* key : {"part", "part_note", "part_figures", "peak_bytes", "seconds"}) json.erase(key);
        report.take(std::move(json));
        put_mesh_report(report, whole.counts);
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
