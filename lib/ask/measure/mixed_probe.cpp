// SPDX-License-Identifier: Apache-2.0
#include "subvol/mixed_probe.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/point_quadratics.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// The mesh with the gradients of all channels as one attribute behind the others.
MixedMesh with_gradients(MixedMesh mesh) {
    std::size_t channels = 0;
    for (const Attribute& attribute : mesh.attributes) channels += static_cast<std::size_t>(attribute.channels);
    if (channels == 0) return mesh;
    std::vector<double> gradients(mesh.points.size() * 3 * channels);
    const detail::PointNeighbors neighbors(mesh);
    detail::parallel_each(mesh.points.size(), [&](std::size_t p) {
        std::vector<detail::PointQuadratic> found;
        detail::fit_quadratics(mesh, neighbors, static_cast<Index>(p), found);
        double* to = gradients.data() + p * 3 * channels;
        for (const detail::PointQuadratic& quadratic : found) {
            for (int k = 0; k < 3; ++k) *to++ = quadratic.gradient[k];
        }
    });
    mesh.attributes.push_back({"gradients", static_cast<int>(3 * channels), std::move(gradients)});
    return mesh;
}

void check_numbers(const MixedMesh& mesh, std::span<const Index> numbers) {
    validate(mesh);
    if (numbers.empty() || numbers.size() == mesh.cells()) return;
    throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(numbers.size()) + " numbers", "probe",
                "one for each of the " + std::to_string(mesh.cells()) + " cells");
}

}  // namespace

struct MixedProbe::State {
    LimitProbe probe;
    std::vector<Index> numbers;  // of the cells that the probe finds
};

MixedProbe::MixedProbe(const MixedMesh& mesh, std::vector<Index> numbers, double reach_world, Progress* progress) {
    check_numbers(mesh, numbers);
    report_progress(progress, "gradients", 0);
    detail::HexesOfMixed hexes = detail::hexahedra_of(with_gradients(mesh));
    if (!numbers.empty()) {
        for (Index& cell : hexes.cells) cell = numbers[cell];
    }
    const ProbeOptions options{.limit = {.scheme = {.kind = Scheme::Linear}, .progress = progress}, .reach_world = reach_world};
    state_.reset(new State{LimitProbe(std::move(hexes.mesh), options), std::move(hexes.cells)});
}
MixedProbe::~MixedProbe() = default;
MixedProbe::MixedProbe(MixedProbe&&) noexcept = default;
MixedProbe& MixedProbe::operator=(MixedProbe&&) noexcept = default;

ProbeResult MixedProbe::at(std::span<const Vec3> places, Progress* progress) const {
    ProbeResult result = state_->probe.at(places, progress);
    result.parameters.clear();
    for (Index& cell : result.cells) {
        if (cell != kNone) cell = state_->numbers[cell];
    }
    if (result.fields.empty()) return result;
    const ProbedField gradients = std::move(result.fields.back());
    result.fields.pop_back();
    std::size_t first = 0;
    for (ProbedField& field : result.fields) {
        for (std::size_t p = 0; p < places.size(); ++p) {
            for (std::size_t c = 0; c < field.channels; ++c) {
                const double* from = gradients.values.data() + p * gradients.channels + 3 * (first + c);
                field.gradients[p * field.channels + c] = {from[0], from[1], from[2]};
            }
        }
        first += field.channels;
    }
    return result;
}

LimitMeasure measure_limit(const MixedMesh& mesh, const std::vector<Index>& numbers, const MeasureOptions& options) {
    check_numbers(mesh, numbers);
    const detail::HexesOfMixed hexes = detail::hexahedra_of(mesh);
    MeasureOptions linear = options;
    linear.scheme = {.kind = Scheme::Linear};
    LimitMeasure found = measure_limit(hexes.mesh, linear);
    const auto name = [&](Index& cell) {
        cell = hexes.cells[cell];
        if (!numbers.empty()) cell = numbers[cell];
    };
    found.whole.cells = numbers.empty() ? mesh.cells() : std::size_t{*std::ranges::max_element(numbers)} + 1;
    for (FieldMeasure& field : found.whole.fields) {
        for (LimitExtreme* extreme : {&field.min, &field.max, &field.given.min, &field.given.max}) {
            if (extreme->cell != kNone) name(extreme->cell);
            extreme->uvw = Vec3(0.0);
        }
    }
    return found;
}

}  // namespace subvol
