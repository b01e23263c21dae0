#include <cmath>

#include "studies.h"
#include "subvol/field_places.h"
#include "subvol/sample.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 100000;

struct Row {
    const char* kernel;
    Correction correction;
    const char* correction_name;
};

constexpr std::array<Row, 14> kRows{{{"paper_bc", Correction::None, "none"},
                                     {"bc", Correction::None, "none"},
                                     {"cardinal", Correction::None, "none"},
                                     {"gaussian", Correction::None, "none"},
                                     {"two_gaussians", Correction::None, "none"},
                                     {"wendland_c2", Correction::None, "none"},
                                     {"wendland_c4", Correction::None, "none"},
                                     {"compact", Correction::None, "none"},
                                     {"gaussian", Correction::Second, "second"},
                                     {"wendland_c2", Correction::Second, "second"},
                                     {"compact", Correction::Gradient, "gradient"},
                                     {"compact", Correction::Second, "second"},
                                     {"gaussian", Correction::Full, "full"},
                                     {"compact", Correction::Full, "full"}}};

template <class T>
void keep_first(std::vector<T>& values, std::size_t count) {
    if (!values.empty()) values.resize(count);
}

/// The kernels of every second control point: those that the mesh before the last refinement has, which come first.
RbfVolume every_second(RbfVolume volume, std::size_t count) {
    keep_first(volume.centers, count);
    keep_first(volume.frames, count);
    for (auto& frame : volume.frames) {
        for (float& s : frame) s *= 4;
    }
    for (RbfChannel& channel : volume.channels) {
        keep_first(channel.values, count);
        keep_first(channel.gradients, count);
        keep_first(channel.moments, count);
        keep_first(channel.hessians, count);
        for (float& moment : channel.moments) moment *= 4;
    }
    return volume;
}

}  // namespace

std::vector<StudyTable> study_spacing(const StudyOptions& options) {
    std::vector<StudyTable> tables;
    const auto meshes = smooth_meshes(16, 8, options);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        const std::size_t coarse_points = meshes[m].mesh.points.size();
        HexMesh mesh = refine(meshes[m].mesh);
        put_smooth_density(mesh);
        StudyTable table{
            "spacing_" + meshes[m].name,
            meshes[m].name + ", " + std::to_string(mesh.cells.size()) +
                " cells: RMSE of the normalised sum at 100000 random places against the limit, by spacing in cells",
            {"kernel", "correction", "2", "1", "1/2", "1/4", "order 2-1", "order 1-1/2", "order 1/2-1/4"},
            {}};
        const FieldSamples places = random_places(mesh, "density", PlaceKind::Anywhere, 1, kPlaces, options.seed);
        for (std::size_t r = 0; r < kRows.size(); ++r) {
            report_progress(options.progress, "spacing",
                            static_cast<double>(m * kRows.size() + r) / static_cast<double>(meshes.size() * kRows.size()));
            const auto& [kernel, correction, correction_name] = kRows[r];
            std::array<double, 4> e{};
            for (std::size_t n = 0; n < 4; ++n) {
                const int per_edge = n == 0 ? 1 : 1 << (n - 1);
                RbfVolume volume =
                    sample_rbf_points(mesh, {.per_edge = per_edge, .correction = correction, .kernel = named_kernel(kernel)})
                        .volume;
                if (n == 0) volume = every_second(std::move(volume), coarse_points);
                e[n] = field_error(volume, places).rmse;
            }
            table.rows.push_back({kernel, correction_name, e[0], e[1], e[2], e[3], order_of(e[0], e[1]), order_of(e[1], e[2]),
                                  order_of(e[2], e[3])});
        }
        tables.push_back(std::move(table));
    }
    report_progress(options.progress, "spacing", 1);
    return tables;
}

}  // namespace subvol::detail
