#include <cmath>

#include "studies.h"
#include "subvol/field_error.h"
#include "subvol/sample.h"

namespace subvol::detail {

namespace {

constexpr std::array<std::pair<const char*, PlaceKind>, 3> kKinds{
    {{"anywhere", PlaceKind::Anywhere}, {"extraordinary", PlaceKind::Extraordinary}, {"boundary", PlaceKind::Boundary}}};
constexpr std::array<std::pair<const char*, Correction>, 4> kCorrections{{{"none", Correction::None},
                                                                          {"gradient", Correction::Gradient},
                                                                          {"second", Correction::Second},
                                                                          {"full", Correction::Full}}};
constexpr std::array<int, 3> kIntervals{1, 2, 4};
constexpr std::size_t kPlaces = 30000;

}  // namespace

std::vector<StudyTable> study_order(const StudyOptions& options) {
    StudyTable table{"order",
                     "RMSE of the field against the limit at 1, 2 and 4 sample intervals a cell edge, and the orders between; "
                     "density ½(sin 3x cos 2y + z) on a box of about [-1,1]³; places within one sample interval of irregular "
                     "edges and of the boundary",
                     {"mesh", "places", "correction", "1", "2", "4", "order 1-2", "order 2-4"},
                     {}};
    const auto meshes = smooth_meshes(32, 16, options);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        report_progress(options.progress, "order", static_cast<double>(m) / static_cast<double>(meshes.size()));
        const auto& [name, mesh] = meshes[m];
        std::array<std::array<std::array<double, 3>, 4>, 3> rmse;  // kind, correction, intervals
        for (std::size_t n = 0; n < kIntervals.size(); ++n) {
            std::array<FieldPlaces, 3> places;
            for (std::size_t k = 0; k < kKinds.size(); ++k) {
                places[k] = random_places(mesh, "density", kKinds[k].second, 1. / kIntervals[n], kPlaces, options.seed + k);
            }
            for (std::size_t c = 0; c < kCorrections.size(); ++c) {
                const auto sampled = sample_rbf_points(mesh, {.per_edge = kIntervals[n], .correction = kCorrections[c].second});
                const RbfField field(sampled.volume);
                for (std::size_t k = 0; k < kKinds.size(); ++k) {
                    rmse[k][c][n] = places[k].positions.empty() ? std::nan("") : field_error(field, places[k]).rmse;
                }
            }
        }
        for (std::size_t k = 0; k < kKinds.size(); ++k) {
            if (std::isnan(rmse[k][0][0])) continue;
            for (std::size_t c = 0; c < kCorrections.size(); ++c) {
                const auto& e = rmse[k][c];
                table.rows.push_back({name, kKinds[k].first, kCorrections[c].first, e[0], e[1], e[2], order_of(e[0], e[1]),
                                      order_of(e[1], e[2])});
            }
        }
    }
    report_progress(options.progress, "order", 1);
    return {table};
}

}  // namespace subvol::detail
