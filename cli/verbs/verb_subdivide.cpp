// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "grid_fields.h"
#include "input.h"
#include "mesh_output.h"
#include "options.h"
#include "outputs.h"
#include "refine_arguments.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit_shells.h"
#include "subvol/mesh_report.h"
#include "subvol/mixed_file.h"
#include "subvol/option.h"
#include "subvol/region.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class SubdivideVerb : public Verb {
public:
    explicit SubdivideVerb(CLI::App& program)
        : Verb(program, "subdivide", "Refine a mesh; every level splits a cell into eight.",
               "  subvol subdivide model:ball -o fine.vtu --levels 2\n"
               "  subvol subdivide part.mesh -o fine.vtu --density \"exp(-(x^2+y^2+z^2))\"") {
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(
            app(),
            Option("output", output_)
                .also("o")
                .help("FILE", "the mesh to write (.vtu, .vtkhdf, .msh, .e or .foam with its fields, .inp or .mesh without)"))
            ->required();
        refine_.add_to(app(), "number of refinements (default 1)");
        add_option(
            app(),
            Option("on-limit", on_limit_).help("move the refined points to the limit (those of mcq and linear lie on it)"));
        add_option(app(), Option("clamp", clamp_)
                              .help("keep values within the ranges of the fields at the mesh's points: interpolating schemes "
                                    "overshoot between them"));
    }

    int run(Report& report) override {
        const TetRefinement tets(refine_);
        if (tets.asked()) {
            write_tets(tets, report);
            return 0;
        }
        const RefineOptions options = refine_.options(1, report.progress());
        check_output(output_, writable_mesh_extensions());
        report.if_long("fewer --levels");
        Shells shells;
        report["input"] = input_;
        CommonOptions reading = common();
        reading.parts_in_whole = true;
        Reshaped reshaped;
        ReadResult read = report.unpack(read_input(input_, reading, report.progress(), ShellsAlone::Refuse, &reshaped));
        const std::vector<std::uint8_t>& part = reshaped.in_part;
        MeshSets sets = part.empty() ? std::move(read.sets) : sets_of_cells(std::move(read.sets), part);
        const HexMesh mesh = with_written_field(report.unpack(mesh_of(std::move(read), reading, &shells)), common());
        if (common().field && !shells.empty()) {
            HexMesh of_shells;
            of_shells.points = shells.points;
            of_shells.attributes = std::move(shells.attributes);
            shells.attributes = with_written_field(std::move(of_shells), common()).attributes;
        }
        HexMesh fine =
            report.unpack(refine_reported(mesh, options, on_limit_ ? Vertices::OnTheLimit : Vertices::OfTheLevel, part));
        keep_in_range(mesh, fine, report);
        say_cells(fine, report);
        if (!shells.empty() && !output_.ends_with(".vtu")) {
            report.warn("shells and beams are written to .vtu only");
            shells = {};
        }
        shells = report.timed("sheets", [&] { return refined(mesh, shells, options, report); });
        report.merge(
            write_reported(output_, fine, shells, sets_of_children(std::move(sets), options.levels), report.progress()));
        put_shape(part.empty() ? mesh : only_cells(mesh, part), fine, report);
        report["output"] = output_;
        report["points"] = fine.points.size();
        report["peak_bytes_per_point"] = static_cast<double>(peak_memory_bytes()) / static_cast<double>(fine.points.size());
        return 0;
    }

private:
    void write_tets(const TetRefinement& tets, Report& report) const {
        if (clamp_) throw Error(ErrorCode::InvalidInput, "the schemes of tetrahedra do not overshoot as others do", "--clamp");
        check_output(output_, {".vtu"});
        report.if_long("fewer --levels");
        report["input"] = input_;
        MeshSets sets;
        const HexMesh mesh = with_written_field(report.unpack(load_mesh(input_, common(), report.progress(), sets)), common());
        if (!sets.empty()) report.warn(list_of(sets) + " not written: refined tetrahedra do not have them");
        const Vertices vertices = on_limit_ ? Vertices::OnTheLimit : Vertices::OfTheLevel;
        const MixedMesh fine = report.unpack(tets.refined(mesh, 1, vertices, report.progress()));
        report.timed("write", [&] { write_mixed_mesh(output_, fine); });
        report["output"] = output_;
        report["points"] = fine.points.size();
        report["cells"] = fine.cells();
    }

    [[nodiscard]] Shells refined(const HexMesh& mesh, const Shells& shells, const RefineOptions& options,
                                 Report& report) const {
        if (shells.empty()) return {};
        Shells fine = on_limit_ ? limit_shells(mesh, shells, options) : refine_shells(mesh, shells, options);
        for (std::size_t f = 0; clamp_ && f < fine.attributes.size(); ++f) {
            clamp_to(fine.attributes[f], range_of(mesh.attributes[f]));
        }
        report["quads"] = fine.quads.size();
        report["lines"] = fine.lines.size();
        return fine;
    }

    /// What is at cells stays there.
    static void say_cells(const HexMesh& fine, Report& report) {
        std::vector<std::string> at_cells;
        for (const Attribute& field : fine.attributes) {
            if (!field.cells.empty()) at_cells.push_back(field.name);
        }
        if (at_cells.empty()) return;
        report.note(text(join(at_cells), at_cells.size() == 1 ? " is" : " are",
                         " at cells: a refined cell has the value of the cell that it is a part of"));
    }

    void keep_in_range(const HexMesh& control, HexMesh& fine, Report& report) const {
        for (std::size_t f = 0; f < fine.attributes.size(); ++f) {
            if (!fine.attributes[f].cells.empty()) continue;
            const FieldRange given = range_of(control.attributes[f]);
            if (clamp_) {
                clamp_to(fine.attributes[f], given);
            } else if (const auto bounds = bounds_of(control.attributes[f])) {
                clamp_to(fine.attributes[f], *bounds);
            } else {
                const FieldRange found = range_of(fine.attributes[f]);
                for (std::size_t c = 0; c < given.min.size(); ++c) {
                    const std::string name = control.attributes[f].name + (given.min.size() > 1 ? text(".", c) : "");
                    report.note(beyond(name, {given.min[c], given.max[c]}, {found.min[c], found.max[c]}));
                }
            }
        }
    }

    /// A scheme that interpolates its control points can fold badly shaped cells.
    static void put_shape(const HexMesh& control, const HexMesh& fine, Report& report) {
        const ShapeReport before = measure_cells(control), after = measure_cells(fine);
        report["inverted_cells"] = after.inverted_cells;
        report["min_scaled_jacobian"] = after.min_scaled_jacobian;
        if (after.inverted_cells == 0) return;
        report.warn(text(after.inverted_cells, " of ", fine.cells.size(), " refined cells are inverted (worst scaled Jacobian ",
                         after.min_scaled_jacobian, "); of the control cells ", before.inverted_cells, " (",
                         before.min_scaled_jacobian, "); a lower --tension or --scheme cc is gentler"));
    }

    std::string input_;
    std::string output_;
    bool on_limit_ = false, clamp_ = false;
    RefineArguments refine_;
};

}  // namespace

std::unique_ptr<Verb> make_subdivide_verb(CLI::App& program) {
    return std::make_unique<SubdivideVerb>(program);
}

}  // namespace subvol::cli
