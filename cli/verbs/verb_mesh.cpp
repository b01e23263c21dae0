// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iterator>

#include "grid_input.h"
#include "input.h"
#include "mesh_figures.h"
#include "mesh_output.h"
#include "options.h"
#include "outputs.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "subvol/control_mesh.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/read_labels.h"
#include "subvol/read_surface.h"
#include "text.h"
#include "vdb_functions.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class MeshVerb : public Verb {
public:
    explicit MeshVerb(CLI::App& program)
        : Verb(
              program, "mesh", "Make a control mesh whose limit fills closed surfaces, or a part of a grid.",
              "  subvol mesh part.stl -o part.vtu\n"
              "  subvol mesh statue.obj -o statue.vtu --cells 48\n"
              "  subvol mesh statue.obj -o statue.vtu --cells 16 --refine 1 --tolerance .15\n"
              "  subvol mesh smoke.vdb -o smoke.vtu --iso .01\n"
              "  subvol mesh bone.stl skin.stl -o leg.vtu\n"
              "  subvol mesh scan.vdb -o head.vtu --label 1=skin --label 2=bone\n"
              "\n"
              "Sharp edges become creases. A part of the surface within another is the wall of a cavity; parts that cross are "
              "united; holes are spanned by the patch lid. Of several files each is a material, whose cells are a set of the "
              "file's "
              "name; what several enclose is of the one that encloses least. Of voxels with integers each label is a material, "
              "0 is outside. The exit code is 1 if the limit folds or control "
              "cells are inverted; the mesh is "
              "written "
              "all the same.\n"
              "JSON: triangles, points, cells, before and after {rms, max, max_at: of the boundary from the surface; "
              "covered_rms, covered_max: the same but over holes; hole_part: of the boundary's area over holes; reached_part: "
              "of the surface's area, nearer to the boundary than half a cell; missed_rms, "
              "missed_max, missed_at: of the surface from the boundary}, rounds, moved_world, volume_world (that the limit "
              "encloses), enclosed_world (by the surface, where it has no holes and no parts cross), folds (as of check), "
              "mended, "
              "sharp {corners, missed_corners: where chains of sharp edges meet, end or turn, and those without creases; "
              "curves, "
              "missed: chains, and those without creases; length_world, missed_length_world, "
              "creases, rms, max: of the creases from the chains}, features {points, curves, surfaces: the parts of corners, "
              "of chains' length and of "
              "the surface's area that the mesh has}, thin {part, thickness_world, at: of the surface about "
              "parts thinner "
              "than 1.5 cells, looked for if the mesh is not as it should be}, parts, added, refined, divided, side_world, "
              "lid_sides (of cells, over holes), materials (of several "
              "files or labels: name, cells, volume_world, enclosed_world), labels (of voxels: name, label, voxels, "
              "voxels_world: "
              "their volume, enclosed_world: by the smooth surface), "
              "min_scaled_jacobian, folded_cells, inverted_cells, open_edges, open_length (of edges of one triangle), surface "
              "{walls, "
              "united, cavities, cavities_alike, copies, sheets, turned, one_sided, many_edges}.") {
        add_input(app(), "FILE", inputs_,
                  "closed surfaces (.stl, .obj, .ply, .glb), each of a material; a .vdb grid of floats; or voxels with labels "
                  "(.vdb of integers, .vti, .nrrd), each of a material")
            ->required();
        add_option(
            app(),
            Option("output", output_).also("o").help("FILE", "the control mesh (.vtu, .vtkhdf, .msh, .e, .foam, .inp, .mesh)"))
            ->required();
        add_option(app(),
                   Option("iso", iso_)
                       .help("V", "of a grid: the surface where it has this value (fog: half of its greatest; level sets: 0)"));
        scheme_.add_scheme_to(app());
        add_options(app(), options_of(options_));
        add_options(app(), options_of(labels_));
        set_essentials({"--cells", "--refine", "--tolerance", "--sharp-angle", "--iso", "--label", "--scheme", "--keep-folds",
                        "--output", "--json"});
    }

    int run(Report& report) override {
        check_output(output_, writable_mesh_extensions());
        ControlMeshOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.names = OptionNames::Flags;
        options.progress = report.progress();
        report.if_long("fewer --cells");
        if (inputs_.size() == 1) report["input"] = inputs_.front();
        if (inputs_.size() > 1) report["inputs"] = inputs_;
        std::vector<MaterialSurface> materials;
        std::size_t triangles = 0;
        for (const std::string& input : inputs_) std::ranges::move(read(input, report), std::back_inserter(materials));
        for (const MaterialSurface& material : materials) triangles += material.surface.triangles.size();
        report["triangles"] = triangles;
        const ControlMesh made = report.timed("shape", [&] { return control_mesh_of(materials, options); });
        report.merge(write_reported(output_, made.mesh, {}, made.sets, report.progress()));
        put(made, report);
        return made.report.shape.is_sound() ? 0 : 1;
    }

private:
    [[nodiscard]] std::vector<MaterialSurface> read(const std::string& input, Report& report) {
        const std::string name = std::filesystem::path(input).stem().string();
        if (inputs_.size() > 1 && (is_vdb_file(input) || is_label_file(input))) {
            throw Error(ErrorCode::InvalidInput, "is a grid, which has to be the only file", input,
                        "an .stl, .obj, .ply or .glb file beside others");
        }
        if (is_label_file(input)) {
            refuse_options(app(), {"--iso"}, "has no effect on labels");
            return surfaces_of(report.timed("read", [&] { return read_labels(input, common().field); }), report);
        }
        if (is_vdb_file(input)) {
            const bool asked = app().count("--label") + app().count("--smooth") > 0;
            const VdbGrid grid = report.unpack(load_grid_or_labels(input, common(), asked, report.progress()));
            if (grid.report().kind == "integer" && !iso_) {
                return surfaces_of(report.timed("read", [&] { return vdb().labels_of_grid(grid); }), report);
            }
            refuse_options(app(), {"--label", "--smooth"}, "has no effect with --iso");
            const VdbGrid floats = vdb().scalar_of(grid, std::nullopt, grid.report().name);
            std::vector<MaterialSurface> made;
            made.push_back({name, report.timed("surface", [&] { return vdb().grid_surface(floats, iso_); })});
            return made;
        }
        if (!is_surface_file(input)) {
            if (!is_model(input)) detail::refuse_missing(input);
            if (detail::names_foreign_surface(input)) detail::refuse_surface(input);
            throw Error(ErrorCode::InvalidInput, "is not a surface", input,
                        "an .stl, .obj, .ply or .glb file of triangles, a .vdb grid, or labels (.vti, .nrrd)");
        }
        refuse_mesh_options(app(), "needs a grid; this is a surface");
        refuse_options(app(), {"--field", "--iso", "--label", "--smooth"}, "needs a grid; this is a surface");
        std::vector<MaterialSurface> made;
        made.push_back({name, report.timed("read", [&] { return read_surface(input); })});
        return made;
    }

    [[nodiscard]] std::vector<MaterialSurface> surfaces_of(const LabelGrid& grid, Report& report) {
        refuse_mesh_options(app(), "needs a mesh; this is a grid of labels");
        LabelOptions options = labels_;
        options.names = OptionNames::Flags;
        options.progress = report.progress();
        LabelSurfaces made = report.timed("labels", [&] { return label_surfaces(grid, options); });
        report.merge(facts_of(made.report));
        for (const LabelReport& label : made.report) {
            report.say(text("label         ", label.label, " (", label.name, "): ", counted(label.voxels, "voxel"), ", volume ",
                            label.voxels_world, "; its surface encloses ", label.enclosed_world));
            constexpr double kMuch = 0.02;
            if (std::abs(label.enclosed_world / label.voxels_world - 1) < kMuch) continue;
            report.warn(text("label ", label.label, " (", label.name, ") has the volume ", label.voxels_world,
                             ", and its smooth surface encloses ", label.enclosed_world, ": it is as thin as its voxels"));
        }
        return std::move(made.materials);
    }

    void put(const ControlMesh& made, Report& report) const {
        const ControlMeshReport& found = made.report;
        report.merge(facts_of(found));
        report["points"] = made.mesh.points.size();
        report["cells"] = made.mesh.cells.size();
        report["output"] = output_;
        const ShapeError& error = found.shape.after;
        const auto sides = [&](double world) { return text(world / found.side_world); };
        report.say(text("mesh          ", counted(made.mesh.cells.size(), "cell"), " of ", found.side_world,
                        found.divided > 0 ? text(" and ", counted(found.divided, "such cube"), " divided") : "", " with ",
                        counted(made.mesh.points.size(), "point"),
                        found.parts > 1 ? text(", in ", found.parts, " parts that are not joined") : ""));
        report.say(text("boundary      ", error.rms, " RMS from the surface (", sides(error.rms), " cells), at most ",
                        error.max, " at ", error.max_at.x, ", ", error.max_at.y, ", ", error.max_at.z));
        if (error.hole_part > 0) {
            report.say(text("holes         under ", text(std::setprecision(2), 100 * error.hole_part),
                            " % of the boundary's area; the rest ", error.covered_rms, " RMS from the surface, at most ",
                            error.covered_max,
                            found.lid_sides > 0 ? text("; patch lid: ", counted(found.lid_sides, "side")) : ""));
        }
        report.say(text("surface       ", error.missed_rms, " RMS from the boundary (", sides(error.missed_rms),
                        " cells), at most ", error.missed_max, " at ", error.missed_at.x, ", ", error.missed_at.y, ", ",
                        error.missed_at.z));
        for (const MaterialReport& material : found.materials) {
            report.say(text("material      ", material.name, ": ", counted(material.cells, "cell"), ", volume ",
                            material.volume_world,
                            material.enclosed_world ? text("; its surface encloses ", *material.enclosed_world) : ""));
        }
        if (const SharpEdgeReport& sharp = found.sharp; sharp.curves > 0) {
            report.say(text("sharp edges   ", counted(sharp.curves - sharp.missed, "chain"), " of ", sharp.curves, " as ",
                            counted(sharp.creases, "crease"), ", ", sharp.rms, " RMS from them, at most ", sharp.max));
        }
        if (found.enclosed_world) {
            report.say(text("volume        ", found.shape.volume_world, "; the surface encloses ", *found.enclosed_world));
        }
        report.say(text("folds         ", fold_text(found.shape.folds, made.mesh.cells.size())));
        if (error.missed_max > found.side_world) {
            report.warn(text("a part of the surface is ", sides(error.missed_max),
                             " cells away from the mesh: more --cells or --refine reach into thinner parts"));
        }
        if (found.sharp.missed > 0) {
            report.warn(text("sharp edges of the length ", found.sharp.missed_length_world, " of ", found.sharp.length_world,
                             " become round, as no edges of the mesh can follow them: more --cells or --refine may"));
        }
        const std::string ending = std::filesystem::path(output_).extension().string();
        const bool for_us = ending == ".vtu" || ending == ".vtkhdf" || ending == ".hdf" || ending == ".mesh";
        if (!for_us && !interpolates(scheme_.options(0, nullptr).scheme.kind)) {
            report.warn(text("the points of ", output_,
                             " are not on the limit of the scheme, and solvers take straight cells "
                             "between them: those of --scheme mcq are on it"));
        }
        if (!found.shape.is_sound()) report.warn(text(output_, " is written all the same; the exit code is 1"));
        report.all_said();
    }

    std::vector<std::string> inputs_;
    std::string output_;
    std::optional<double> iso_;
    RefineArguments scheme_;
    ControlMeshOptions options_;
    LabelOptions labels_;
};

}  // namespace

std::unique_ptr<Verb> make_mesh_verb(CLI::App& program) {
    return std::make_unique<MeshVerb>(program);
}

}  // namespace subvol::cli
