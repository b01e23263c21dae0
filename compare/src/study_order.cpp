#include <cmath>

#include "studies.h"
#include "subvol/field_places.h"
#include "subvol/sample.h"

namespace subvol::detail {

namespace {

constexpr std::array<std::pair<const char*, PlaceKind>, 3> kKinds{
    {{"anywhere", PlaceKind::Anywhere}, {"extraordinary", PlaceKind::Extraordinary}, {"boundary", PlaceKind::Boundary}}};
constexpr std::array<std::pair<const char*, Correction>, 4> kCorrections{{{"none", Correction::None},
                                                                          {"gradient", Correction::Gradient},
                                                                          {"second", Correction::Second},
                                                                          {"full", Correction::Full}}};
constexpr std::size_t kPlaces = 30000;
constexpr int kHalvings = 3;

/// What halves the spacing: samples within the cells of one control mesh, or the control mesh itself.
enum class Halving { Samples, ControlMesh };

using Errors = std::array<std::array<std::array<double, kHalvings>, 4>, 3>;  // by kind, correction, halving

Errors measure(const HexMesh& control, Halving halving, const StudyOptions& options) {
    Errors rmse{};
    for (int h = 0; h < kHalvings; ++h) {
        const auto n = static_cast<std::size_t>(h);
        HexMesh mesh = control;
        if (halving == Halving::ControlMesh) {
            mesh = refine(control, {.levels = h});
            put_smooth_density(mesh);
        }
        const int per_edge = halving == Halving::Samples ? 1 << h : 1;
        std::array<FieldSamples, 3> places;
        for (std::size_t k = 0; k < kKinds.size(); ++k) {
            places[k] = random_places(mesh, "density", kKinds[k].second, 1. / per_edge, kPlaces, options.seed + k);
        }
        for (std::size_t c = 0; c < kCorrections.size(); ++c) {
            const auto volume = sample_rbf_points(mesh, {.per_edge = per_edge, .correction = kCorrections[c].second}).volume;
            for (std::size_t k = 0; k < kKinds.size(); ++k) {
                rmse[k][c][n] = places[k].size() == 0 ? std::nan("") : field_error(volume, places[k]).rmse;
            }
        }
    }
    return rmse;
}

void add_rows(StudyTable& table, const std::string& mesh, const Errors& rmse) {
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
        if (std::isnan(rmse[k][0][0])) continue;
        for (std::size_t c = 0; c < kCorrections.size(); ++c) {
            const auto& e = rmse[k][c];
            table.rows.push_back(
                {mesh, kKinds[k].first, kCorrections[c].first, e[0], e[1], e[2], order_of(e[0], e[1]), order_of(e[1], e[2])});
        }
    }
}

}  // namespace

std::vector<StudyTable> study_order(const StudyOptions& options) {
    const std::vector<std::string> columns{"mesh", "places", "correction", "1", "1/2", "1/4", "order 1-1/2", "order 1/2-1/4"};
    StudyTable samples{
        "order_samples",
        "RMSE of the field against the limit of one control mesh at 1, 2 and 4 sample intervals a cell edge, by "
        "spacing in cells, and the orders between; density ½(sin 3x cos 2y + z) on a box of about [-1,1]³; places "
        "within one sample interval of irregular edges and of the boundary",
        columns,
        {}};
    StudyTable control{"order_control",
                       "The same at one kernel a control point, the control mesh refined and its density taken anew",
                       columns,
                       {}};
    const auto meshes = smooth_meshes(32, 16, options);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        report_progress(options.progress, "order", static_cast<double>(m) / static_cast<double>(meshes.size()));
        add_rows(samples, meshes[m].name, measure(meshes[m].mesh, Halving::Samples, options));
        add_rows(control, meshes[m].name, measure(meshes[m].mesh, Halving::ControlMesh, options));
    }
    report_progress(options.progress, "order", 1);
    return {samples, control};
}

}  // namespace subvol::detail
