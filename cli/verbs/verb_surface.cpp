// SPDX-License-Identifier: Apache-2.0
// `surface`: triangles of a mesh, a grid or points. The kind of surface is an isosurface, with or without its cap, or the
// boundary; what is cut is the limit, the cells, or bricks; the output is one file or one share of it. Figures of a report are
// those of the whole surface, and fields are evaluated only for formats that hold them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>

#include "body_input.h"
#include "input.h"
#include "limit_warning.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "part_kinds.h"
#include "picture_arguments.h"
#include "quantities.h"
#include "refine_arguments.h"
#include "stream_arguments.h"
#include "subvol/detail/surface_share.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit_shells.h"
#include "subvol/limit_surface.h"
#include "subvol/option.h"
#include "subvol/quantity.h"
#include "surface_output.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class SurfaceVerb : public Verb {
public:
    explicit SurfaceVerb(CLI::App& program)
        : Verb(program, "surface", "Extract isosurfaces or the boundary surface as triangles.",
               "  subvol surface part.vtu -o part.stl --boundary\n"
               "  subvol surface part.vtu -o iso.ply --iso 300 --iso 350 --field Temp\n"
               "  subvol surface part.vtu -o hot.stl --iso 350 --cap --tolerance 3e-4\n"
               "  subvol surface case -o inlet.vtp --patch inlet\n"
               "  subvol surface part.vtu -o skin.glb --boundary --color-field Temp --tf viridis\n"
               "  subvol surface run.vtu -o flow.vtp --streamlines U --seeds line:0,0,0,0,0,1\n"
               "  subvol surface big.bricks -o iso.ply --iso 300\n"
               "  subvol surface big.vtu -o part2.svshare --part 2/4     a share, for join\n"
               "\n"
               "The points lie on the limit, with normals from its exact gradients. Cells are refined where the surface is, "
               "until the triangles are within the tolerance. JSON: points, triangles, area, volume (of what a watertight "
               "surface encloses), watertight, euler, components, min_angle (degrees), deviation (world), level. streamlines: "
               "count, points, length, outside (seeds), ends (how many for which reason).") {
        show_limit_of_parts();
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(
            app(),
            Option("output", output_)
                .also("o")
                .help("FILE",
                      "the surface to write (.ply, .stl, .vtp, .obj, .glb, .vtkhdf; .svshare with --part), or streamlines "
                      "(.vtp, .csv)"))
            ->required();
        add_option(app(),
                   Option("iso", isos_)
                       .help("V", "the value of an isosurface, or a per cent of the field's range such as 20% (repeatable)"))
            ->transform(number_or_percent());
        add_options(app(), options_of(options_));
        add_option(app(), Option("patch", patches_)
                              .instead_of({"iso", "cap"})
                              .help("NAME", "this patch of the boundary alone, as info lists them (repeatable)"));
        add_option(app(), Option("keep-slivers", keep_slivers_).help("leave triangles with small angles as they are"));
        add_option(app(), Option("color-field", color_field_)
                              .help("NAME", "colour the points by this field (default in .ply, .obj, .glb: none)"));
        add_option(app(), Option("tf", function_)
                              .help("FILE|NAME", "the colours: a preset, or a colour map of ParaView")
                              .only_with("color-field"));
        add_option(app(),
                   Option("origin", origin_)
                       .help("X,Y,Z", "write points relative to this place: .stl rounds to 32-bit floats (default 0,0,0)"))
            ->transform(number_list(3, "5e6,4e6,0: a place near the body"));
        streams_.add_lines_to(app());
        for (const char* other : {"--iso", "--boundary", "--cap", "--patch", "--tolerance", "--max-level", "--keep-slivers",
                                  "--origin", "--tf", "--color-field"})
            app().get_option("--streamlines")->excludes(other);
        scheme_.add_scheme_to(app());
        share_.add_to(app(), "a range of the cells that the surface passes");
        set_essentials({"--output", "--iso", "--boundary", "--cap", "--tolerance", "--color-field", "--field", "--json"});
    }

    [[nodiscard]] bool works_in_ranks() const override { return true; }

    int run(Report& report) override {
        if (!streams_.chosen.streamlines.empty()) return run_streams(report);
        if (share_.given()) {
            (void)share_of(share_);
            check_output(output_, {".svshare"});
        } else {
            check_output(output_, {".ply", ".stl", ".vtp", ".obj", ".glb", ".vtkhdf"});
        }
        if (output_.ends_with(".stl") && !color_field_.empty()) {
            throw Error(ErrorCode::InvalidInput, ".stl has no colours", "--color-field", ".ply, .vtp, .obj, .glb");
        }
        report.if_long("a larger --tolerance");
        const TetRefinement tets(scheme_);
        SurfaceOptions options = options_;
        options.scheme = scheme_.options(0, report.progress()).scheme;
        options.boundary = options.boundary || isos_.empty();
        options.improve = !keep_slivers_;
        options.progress = report.progress();
        report["input"] = input_;
        if (!patches_.empty() && (tets.asked() || shares(share_))) {
            throw Error(ErrorCode::InvalidInput, "is cut from a mesh of hexahedra by one process", "--patch",
                        "no --part, and no scheme of tetrahedra");
        }
        const bool with_shells = options.boundary && !tets.asked() && patches_.empty();
        CommonOptions reading = common();
        if (!color_field_.empty()) reading.at_rest.push_back(color_field_);
        // Shares cut the cells that are left as a mesh of their own, and so do isosurfaces.
        reading.parts_in_whole = !tets.asked() && !shares(share_) && isos_.empty();
        BodyInput body = report.unpack(open_body(input_, reading, app(), report.progress(), with_shells));
        report.merge(body.refine(tets, 2, report.progress()));
        const std::string field = report.unpack(body.select(common(), OtherFields::Keep));
        if (share_.given() && !body.shells.empty()) {
            throw Error(ErrorCode::InvalidInput, "shells are written with the whole surface", "--part",
                        "one process, or mpirun");
        }
        SurfaceOutput output{.field = field, .range = body.range(field), .isos = isos_.size()};
        for (const std::string& iso : isos_) options.isos.push_back(parse_value(iso, output.range, "--iso"));
        if (!origin_.empty()) output.file.origin = parse_vector("--origin", origin_);
        if (!color_field_.empty()) {
            const std::size_t number = body.add_scalar(color_field_);
            output.file.color = number;
            output.file.function = find_transfer_function(function_, body.range(color_field_));
        }
        const MeshSource source = body.source();
        if (!tets.asked()) report.warn(limit_warning(input_, source, options.scheme, report.progress()));
        std::vector<CellSide> sides;
        if (!patches_.empty()) {
            const HexMesh* mesh = source.mesh();
            if (mesh == nullptr) throw Error(ErrorCode::InvalidInput, "bricks have no patches", "--patch", "the mesh itself");
            for (const Patch& patch : patches_of_option(*mesh, body.sets, patches_)) {
                if (std::ranges::find(body.sets.patches, patch.name, &Patch::name) == body.sets.patches.end())
                    throw Error(ErrorCode::InvalidInput, "the boundary alone is written", "--patch set:" + patch.name,
                                "--only set:" + patch.name);
                sides.insert(sides.end(), patch.sides.begin(), patch.sides.end());
            }
        }
        options.sides = sides;
        options.cells = body.in_part;
        // These formats have no fields, except as colours.
        const std::string extension = extension_of(output_);
        const bool no_fields = extension == ".stl" || extension == ".obj" || extension == ".glb";
        options.fields = !no_fields || !color_field_.empty() || !body.shells.empty() || tets.asked();
        std::optional<LimitSurface> surface =
            made([&] { return limit_surface(source, field, options); },
                 [&](const auto& share) { return detail::share_of_surface(source, field, options, share); }, output, report);
        if (!surface) return 0;
        check_not_empty(*surface, output);
        if (!tets.asked() && !is_model(input_)) warn_of_ranges(*surface, source, {field, color_field_}, report);
        const std::size_t of_volume = surface->surface.triangles.size();
        if (!body.shells.empty()) {
            const HexMesh& mesh = *source.mesh();
            const Shells shells = with_fields_of(std::move(body.shells), mesh);
            report.timed("sheets", [&] {
                const int level = std::clamp(surface->report.level, 3, 4);  // a flat body may carry a bent shell
                add_shells(*surface, limit_shells(mesh, shells, {.scheme = options.scheme, .levels = level}));
            });
            report["sheet_triangles"] = surface->surface.triangles.size() - of_volume;
            if (!shells.lines.empty()) report.warn("beams have no surface and are not written");
        }
        report.merge(write_reported(output_, *surface, output, report.progress()));
        return 0;
    }

private:
    /// Says which of the fields leave their range in the file at the points of the surface.
    static void warn_of_ranges(const LimitSurface& surface, const MeshSource& source, const std::array<std::string, 2>& names,
                               Report& report) {
        for (const ProbedField& field : surface.fields) {
            if (std::ranges::find(names, field.name) == names.end()) continue;
            const Attribute* const given = source.mesh() != nullptr ? source.mesh()->find_attribute(field.name) : nullptr;
            if (given == nullptr || given->derived || given->channels != 1 || field.values.empty()) continue;
            const auto [low, high] = std::ranges::minmax(field.values);
            const FieldRange range = range_of(*given);
            report.warn(range_warning(field.name, {range.min[0], range.max[0]}, {low, high}, true));
        }
    }

    /// Streamlines instead of a surface.
    int run_streams(Report& report) {
        if (share_.given()) throw Error(ErrorCode::InvalidInput, "has no effect with --streamlines", "--part");
        check_output(output_, {".vtp", ".csv"});
        const TetRefinement tets(scheme_);
        if (tets.asked())
            throw Error(ErrorCode::InvalidInput, "follows the limit of hexahedra", "--streamlines", "another --scheme");
        report.if_long("fewer seeds, or a larger --stream-tolerance");
        report["input"] = input_;
        CommonOptions reading = common();
        reading.at_rest.push_back(streams_.chosen.streamlines);
        const BodyInput body = report.unpack(open_body(input_, reading, app(), report.progress()));
        if (body.source().mesh() == nullptr)
            throw Error(ErrorCode::InvalidInput, "needs a mesh in memory", "--streamlines", "the mesh itself");
        HexMesh mesh = *body.source().mesh();
        Attribute vectors =
            of_option("--streamlines", [&] { return vector_field_of(mesh, streams_.chosen.streamlines, report.progress()); });
        if (common().field) {
            const Attribute shown = select_field(mesh, common().field, report.progress()).scalar;
            mesh.attributes = {shown};
        }
        std::erase_if(mesh.attributes, [&](const Attribute& a) { return a.name == streams_.chosen.streamlines; });
        mesh.attributes.push_back(std::move(vectors));
        const LimitOptions limit{.scheme = scheme_.options(0, report.progress()).scheme, .progress = report.progress()};
        StreamlineOptions options = streams_.chosen.lines;
        options.limit = limit;
        options.progress = report.progress();
        const Streamlines lines = report.timed("streamlines", [&] {
            return trace_streamlines(mesh, streams_.chosen.streamlines, streams_.places(mesh, limit), options);
        });
        report.merge(facts_of(lines));
        if (lines.count() == 0)
            throw Error(ErrorCode::InvalidInput, "no seed lies in the volume", "--seeds",
                        "places in the body, whose box info shows");
        report.timed("write", [&] { write_streamlines(output_, lines); });
        report["output"] = output_;
        return 0;
    }

    /// The whole surface, of one process or of all ranks; nothing if this process has only a share of it, which is written or
    /// sent to rank 0.
    template <class Whole, class Part>
    [[nodiscard]] std::optional<LimitSurface> made(const Whole& whole, const Part& part, const SurfaceOutput& output,
                                                   Report& report) {
        if (!shares(share_)) return report.timed("surface", whole);
        const Share share = share_of(share_);
        detail::SurfaceShareBytes own = report.timed("surface", [&] { return part(share); });
        const Transport to = transport(share_, input_, own.cells, json_of(output), report);
        return report.unpack(deliver(SurfaceParts{output_, report.progress()}, std::move(own.bytes), to));
    }

    std::string input_, output_, color_field_, origin_, function_ = "viridis";
    std::vector<std::string> isos_, patches_;
    SurfaceOptions options_;
    bool keep_slivers_ = false;
    RefineArguments scheme_;
    ShareArgument share_;
    StreamArguments streams_;
};

}  // namespace

std::unique_ptr<Verb> make_surface_verb(CLI::App& program) {
    return std::make_unique<SurfaceVerb>(program);
}

}  // namespace subvol::cli
