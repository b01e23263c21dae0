// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <charconv>
#include <tuple>

#include "input.h"
#include "options.h"
#include "quantities.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/expression.h"
#include "subvol/option.h"
#include "subvol/split.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

const std::string kTwist = "model:twist:";

class SplitVerb : public Verb {
public:
    explicit SplitVerb(CLI::App& program)
        : Verb(program, "split", "Cut a mesh into a folder of bricks, for meshes that do not fit into memory.",
               "  subvol split big.vtu -o big.bricks --memory 2G\n"
               "  subvol split run.pvtu -o run.bricks             piece by piece\n"
               "  subvol split model:twist:464 -o twist.bricks    10^8 cells, never in memory\n"
               "  subvol points big.bricks -o big.ply\n"
               "  subvol vdb big.bricks -o big.vdb --resolution 4000 --memory 4G\n"
               "\n"
               "Each brick is a .vtu with a halo of cells about its own; ParaView and subvol open it alone. A split that was "
               "interrupted goes on where it ended when the same command runs again.") {
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(app(), Option("output", output_).also("o").help("DIR", "the folder to write, for example big.bricks"))
            ->required();
        add_options(app(), options_of(options_));
        add_crease_angle();
    }

    int run(Report& report) override {
        options_.seed = common().seed;
        options_.progress = report.progress();
        const SplitResult result = cut(report);
        std::uint64_t stored = 0;
        for (const Brick& brick : result.bricks.bricks) stored += brick.stored_cells;
        report["input"] = input_;
        report["output"] = output_;
        report["points"] = result.bricks.points;
        report["cells"] = result.bricks.cells;
        report["bricks"] = result.bricks.bricks.size();
        report["kept"] = result.kept;
        report["halo_layers"] = result.bricks.halo_layers;
        report["halo_share"] = static_cast<double>(stored) / static_cast<double>(result.bricks.cells) - 1;
        report["bytes"] = result.bytes;
        if (result.kept > 0) report.note(text(counted(result.kept, "brick"), " kept of a split that was interrupted"));
        return 0;
    }

private:
    SplitResult cut(Report& report) {
        if (input_.starts_with(kTwist) && options_.shape != BrickShape::Random && !common().density && !common().field) {
            int resolution = 0;
            const char *begin = input_.data() + kTwist.size(), *end = input_.data() + input_.size();
            const auto [stop, error] = std::from_chars(begin, end, resolution);
            if (error != std::errc() || stop != end) {
                throw Error(ErrorCode::InvalidInput, "'" + input_.substr(kTwist.size()) + "' is not a resolution",
                            "model:twist", "2..4096");
            }
            return report.timed("split", [&] { return split_twist(output_, resolution, options_); });
        }
        if (!is_model(input_) && kind_of(input_) != InputKind::Bricks && common().only.empty()) {
            report["input"] = input_;  // for errors
            if (common().density) std::ignore = evaluate_expression(*common().density, {});
            const ReadOptions read = read_options(input_, common());
            PiecesOptions pieces{.read = read, .change = {}, .about_change = common().density.value_or("")};
            if (common().density) pieces.change = [&](HexMesh mesh) { return used_mesh(std::move(mesh), common()); };
            if (common().field) {  // never together with --density
                pieces.change = [&](HexMesh mesh) {
                    mesh = with_written_field(std::move(mesh), common());
                    mesh.attributes = detail::without_functions(std::move(mesh.attributes));
                    return mesh;
                };
                pieces.about_change = "field " + *common().field;
            }
            PiecesSplit split = report.timed("split", [&] { return split_pieces(output_, input_, pieces, options_); });
            for (const std::string& warning : split.warnings) report.warn(warning);
            if (split.result) return std::move(*split.result);
            if (!split.held_whole.empty()) report.note(text("all pieces are held in memory: ", split.held_whole));
        }
        report["input"] = input_;
        HexMesh mesh = with_written_field(report.unpack(load_mesh(input_, common(), report.progress())), common());
        for (const Attribute& field : mesh.attributes) {
            if (field.constant)
                report.warn(text(field.name, " becomes means of the cells at each point: bricks hold no values at cells"));
        }
        return report.timed("split", [&] { return split_mesh(output_, std::move(mesh), options_); });
    }

    std::string input_, output_;
    SplitOptions options_;
};

}  // namespace

std::unique_ptr<Verb> make_split_verb(CLI::App& program) {
    return std::make_unique<SplitVerb>(program);
}

}  // namespace subvol::cli
