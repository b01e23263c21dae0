// SPDX-License-Identifier: Apache-2.0
#include "cell_quality.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "subvol/mesh_report.h"

namespace subvol::detail {
namespace {

struct CellMeasure {
    std::string_view name;
    double (*value)(const std::array<Vec3, 8>& corners);
};

constexpr std::array<CellMeasure, 4> kMeasures{{{"quality", min_scaled_jacobian},
                                                {"scaled_jacobian", min_scaled_jacobian},
                                                {"aspect", aspect_ratio},
                                                {"aspect_ratio", aspect_ratio}}};

}  // namespace

std::optional<Attribute> cell_quality(const HexMesh& mesh, std::string_view name) {
    const auto* const measure = std::ranges::find(kMeasures, name, &CellMeasure::name);
    if (measure == kMeasures.end() || mesh.cells.empty()) return std::nullopt;
    Attribute field{.name = std::string(name), .channels = 1, .values = std::vector<double>(mesh.points.size(), 0.0)};
    field.constant = true;
    field.cells.resize(mesh.cells.size());
    tbb::parallel_for(std::size_t{0}, mesh.cells.size(), [&](std::size_t c) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[c][k]];
        field.cells[c] = measure->value(corners);
    });
    std::vector<double> around(mesh.points.size(), 0.0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            field.values[p] += field.cells[c];
            ++around[p];
        }
    }
    for (std::size_t p = 0; p < around.size(); ++p) field.values[p] /= std::max(around[p], 1.0);
    return field;
}

}  // namespace subvol::detail
