// SPDX-License-Identifier: Apache-2.0
// A mesh: counts, volume, quality, fields, blocks, patches, sets and steps, and a verdict; also folds of its limit, the volume
// of the limit, or the figures of refined tetrahedra, if these are asked for.
#include <algorithm>
#include <optional>

#include "file_info.h"
#include "input.h"
#include "joined_figures.h"
#include "limit_warning.h"
#include "mesh_figures.h"
#include "steps.h"
#include "subvol/certificate.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/mesh_report.h"
#include "text.h"

namespace subvol::cli {
namespace {

class MeshInfo : public FileInfo {
public:
    using FileInfo::FileInfo;

    [[nodiscard]] std::vector<std::string> field_names(Report& report) override {
        report["input"] = request().input;
        const ReadResult read = report.unpack(read_input(request().input, request().common, report.progress()));
        std::vector<std::string> names;
        for (const FieldInfo& field : chosen_fields(read, request().common)) names.push_back(field.name);
        return names;
    }

    void describe(Report& report) override {
        const ShellsAlone alone = request().share ? ShellsAlone::Refuse : ShellsAlone::Take;
        report["input"] = request().input;
        ReadResult read = report.unpack(read_input(request().input, request().common, report.progress(), alone));
        put_ignored(read.ignored, report);
        if (request().ignored) return list_ignored(read.ignored, report);
        read.fields = chosen_fields(read, request().common);
        if (!is_model(request().input)) put_steps(read, report);
        detail::MeshShare about;
        if (request().share) {
            about = joined_figures(request(), report,
                                   [&](const Share& share) { return detail::inspect_share(read.mesh, share, kCellsNamed); });
            if (is_silent(request())) return;
        } else {
            about.counts = report.timed("inspect", [&] { return figures_of(read, report.progress()); });
            if (about.counts.inverted_cells > 0) about.inverted = inverted_cells(read.mesh, kCellsNamed);
        }
        report.merge(facts_of(about.counts));
        put_shape(read, report);
        put_fields(read, report);
        std::optional<FoldReport> folds;
        if (request().folds) {
            folds = report.timed("folds", [&] { return check_folds(read.mesh, {.progress = report.progress()}).report; });
            Facts found;
            found["folds"] = facts_of(*folds);
            report.merge(found);
        }
        std::optional<LimitBody> limit;
        if (request().limit) {
            limit = report.timed("limit", [&] { return limit_body(read.mesh, {}, 2, report.progress()); });
            report["limit_volume"] = limit->volume;
            report["limit_bounds"] = json_of(limit->bounds);
            if (!is_model(request().input)) report.warn(limit_warning(*limit));
        }
        if (request().tets.asked()) {
            report["refined"] = json_of(report.unpack(request().tets.figures(used_mesh(read.mesh, {}), 2, report.progress())));
        }
        if (!request().is_part) report["verdict"] = verdict(about.counts, about.inverted);
        if (request().devices) return;  // the table has all
        std::string lines = mesh_lines(read, about, report.json().at("seconds"), steps_text(report.json()));
        lines.pop_back();
        report.say(lines);
        if (limit) report.say(limit_lines(*limit));
        if (folds) report.say(text("folds        ", fold_text(*folds, read.mesh.cells.size()), "; of the limit of MCQ"));
        if (request().tets.asked()) report.say(refined_lines(report.json().at("refined")));
        report.all_said();
    }

private:
    /// What the mesh has besides cells: sharp edges, shells, creases.
    static void put_shape(const ReadResult& read, Report& report) {
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
    }

    static void put_ignored(const std::vector<IgnoredPart>& parts, Report& report) {
        report["ignored"] = Json::array();
        for (const IgnoredPart& part : parts) {
            Json one{{"kind", part.kind}, {"name", detail::printable(part.name)}, {"count", part.count}};
            if (!part.reason.empty()) one["reason"] = part.reason;
            report["ignored"].push_back(std::move(one));
        }
    }

    static void list_ignored(const std::vector<IgnoredPart>& parts, Report& report) {
        for (const IgnoredPart& part : parts)
            report.answer(text(part.kind, "  ", detail::printable(part.name), "  ", part.count, part.reason.empty() ? "" : "  ",
                               part.reason));
        if (parts.empty()) report.note("the reader knows of no part of the file that is not taken");
        report.all_said();
    }

    static void put_fields(const ReadResult& read, Report& report) {
        report["fields"] = Json::array();
        for (const FieldInfo& field : read.fields) {
            report["fields"].push_back({{"name", field.name},
                                        {"location", field.location},
                                        {"components", field.components},
                                        {"min", field.min},
                                        {"max", field.max}});
            if (!field.unit.empty()) report["fields"].back()["unit"] = field.unit;
            if (field.missing > 0) report["fields"].back()["missing"] = field.missing;
        }
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

    void put_steps(const ReadResult& read, Report& report) const {
        const MeshSeries series = open_series(request().input);
        const std::size_t step = one_step(request().input, request().common).value_or(series.size() - 1);
        report["steps"] = series.size();
        report["times"] = series.size() == 1 && read.mesh.time ? std::vector<double>{*read.mesh.time} : series.times;
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
        report["node_sets"] = Json::array();
        for (const NodeSet& set : read.sets.nodes)
            report["node_sets"].push_back({{"name", set.name}, {"nodes", points_of(read.mesh, set).size()}});
    }

    /// "0 to 4, times 0 … 0.4; this is step 4"; empty if there is one step.
    [[nodiscard]] static std::string steps_text(const Json& json) {
        if (json.value("steps", 1) < 2) return {};
        const Json& times = json.at("times");
        const auto time = [](const Json& t) { return t.is_number() ? text(t.get<double>()) : std::string("unknown"); };
        return text("0 to ", times.size() - 1, ", times ", time(times.front()), " … ", time(times.back()), "; this is step ",
                    json.at("step").get<std::size_t>());
    }
};

}  // namespace

std::unique_ptr<FileInfo> make_mesh_info(const InfoRequest& request) {
    return std::make_unique<MeshInfo>(request);
}

}  // namespace subvol::cli
