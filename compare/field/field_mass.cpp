// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sample_grid.h"
#include "subvol/field_metrics.h"

namespace subvol {

double integrate_field(const FieldView& field, const Box& box, int resolution, Progress* progress) {
    const detail::SampleGrid grid(box, resolution);
    double sum = 0;
    for (int k = 0; k < grid.count[2]; ++k) {
        report_progress(progress, "integrate", static_cast<double>(k) / grid.count[2]);
        std::vector<double> rows(static_cast<std::size_t>(grid.count[1]));
        tbb::parallel_for(0, grid.count[1], [&](int j) {
            double row = 0;
            for (int i = 0; i < grid.count[0]; ++i) row += field.value(grid.place(i + .5, j + .5, k + .5)).value_or(0);
            rows[static_cast<std::size_t>(j)] = row;
        });
        double layer = 0;
        for (const double row : rows) layer += row;
        sum += layer;
    }
    return sum * grid.cell.x * grid.cell.y * grid.cell.z;
}

MassError mass_error(const FieldView& test, const FieldView& reference, int resolution, Progress* progress) {
    const Box box = detail::box_about(test.box, reference.box);
    MassError mass{integrate_field(test, box, resolution, progress), integrate_field(reference, box, resolution, progress)};
    const double difference = std::abs(mass.test - mass.reference);
    mass.relative = difference == 0 ? 0 : difference / std::abs(mass.reference);
    return mass;
}

}  // namespace subvol
