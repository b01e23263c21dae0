#include <cmath>

#include "studies.h"
#include "subvol/empty_space.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"

namespace subvol::detail {

namespace {

/// Table 2 of [mnmq2007]; the nozzle is a simulation and has no error there.
struct PaperRow {
    const char* model;
    const char* title;
    double rmse, data_points, rendered;
};

constexpr std::array<PaperRow, 7> kPaper{{{"pawn", "deformed pawn", .0037, 543599, 90497},
                                          {"alien", "alien", .0030, 487071, 31573},
                                          {"train1", "train #1", .0045, 1898312, 228018},
                                          {"car", "toy car", .0107, 1406847, 176802},
                                          {"fan", "CSG fan", .0042, 517153, 35832},
                                          {"nozzle", "nozzle", NAN, 155808, 155808},
                                          {"train2", "train #2", .0044, 1636349, 216476}}};

double rmse_between(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

std::vector<StudyTable> study_table2(const StudyOptions& options) {
    StudyTable table{"table2",
                     "Look-alikes of the models of the paper's table 2: points after one level of subdivision, those left when "
                     "negative densities are invisible, and the RMSE of value rules at the new points against the scheme "
                     "(densities in [-1,1])",
                     {"model", "points", "paper's", "rendered", "paper's", "paper's RMSE", "paper (BC r=2)",
                      "paper (BC mended)", "two Gaussians", "cubic", "scheme"},
                     {}};
    for (std::size_t m = 0; m < kPaper.size(); ++m) {
        report_progress(options.progress, "table2", static_cast<double>(m) / kPaper.size());
        const PaperRow& paper = kPaper[m];
        const HexMesh mesh = make_model(paper.model);
        const Attribute& density = mesh.attributes.front();
        const RbfVolume points = sample_rbf_points(mesh, {.per_edge = 2}).volume;
        const std::size_t rendered = drop_invisible(points, 0, above(0)).volume.size();

        const auto exact = values_at_new_points(mesh, density, ValueRule::Scheme, Kernel{});
        const auto by_rule = [&](ValueRule rule, const char* kernel) {
            return rmse_between(values_at_new_points(mesh, density, rule, named_kernel(kernel)), exact);
        };
        const auto& values = points.channels.front().values;
        const std::vector<double> converted(values.begin() + static_cast<std::ptrdiff_t>(mesh.points.size()), values.end());
        table.rows.push_back({paper.title, static_cast<double>(points.size()), paper.data_points, static_cast<double>(rendered),
                              paper.rendered, paper.rmse, by_rule(ValueRule::Paper, "paper_bc"),
                              by_rule(ValueRule::Paper, "bc"), by_rule(ValueRule::Paper, "two_gaussians"),
                              by_rule(ValueRule::Cubic, "cubic"), rmse_between(converted, exact)});
    }
    report_progress(options.progress, "table2", 1);
    return {table};
}

}  // namespace subvol::detail
