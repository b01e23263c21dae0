// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_metrics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "closed_surface.h"
#include "sample_grid.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/triangle_distance.h"
#include "subvol/error.h"

namespace subvol {

namespace {

constexpr std::size_t kBatch = 1 << 16;
constexpr std::size_t kTriesASample = 1000;
constexpr double kStep = 1e-3;  // relative to the box's diagonal

struct FieldSample {
    Vec3 x{0.0};
    std::optional<double> reference{}, test{};
};

std::vector<FieldSample> random_batch(const FieldView& test, const FieldView& reference, std::mt19937_64& random) {
    std::vector<FieldSample> batch(kBatch);
    for (FieldSample& place : batch) {
        for (int k = 0; k < 3; ++k) place.x[k] = detail::random_unit(random);
        place.x = reference.box.lower + place.x * reference.box.size();
    }
    tbb::parallel_for(std::size_t{0}, batch.size(), [&](std::size_t i) {
        FieldSample& place = batch[i];
        place.reference = reference.value(place.x);
        if (place.reference) place.test = test.value(place.x);
    });
    return batch;
}

std::vector<FieldSample> random_places_of(const FieldView& test, const FieldView& reference,
                                          const FieldDifferenceOptions& options) {
    if (reference.box.empty()) throw Error(ErrorCode::InvalidInput, "the reference field has an empty box");
    std::mt19937_64 random(options.seed);
    std::vector<FieldSample> places;
    for (std::size_t tries = 0; places.size() < options.samples && tries < options.samples * kTriesASample; tries += kBatch) {
        report_progress(options.progress, "sample fields",
                        static_cast<double>(places.size()) / static_cast<double>(options.samples));
        for (const FieldSample& place : random_batch(test, reference, random)) {
            if (place.reference && places.size() < options.samples) places.push_back(place);
        }
    }
    if (places.empty()) throw Error(ErrorCode::InvalidInput, "the reference field has no value at any place of its box");
    return places;
}

/// Weighted sums, in the order of the calls.
struct Errors {
    double weights = 0, absolutes = 0, squares = 0, largest = -1;
    Vec3 largest_at{0.0};

    void add(double difference, double weight, const Vec3& at) {
        weights += weight;
        absolutes += weight * std::abs(difference);
        squares += weight * difference * difference;
        // NaN stays, as in the sums.
        if (std::isnan(largest) || std::abs(difference) <= largest) return;
        largest = std::abs(difference);
        largest_at = at;
    }
    void put_into(FieldDifference& errors) const {
        if (!(weights > 0)) return;
        errors.l1 = absolutes / weights;
        errors.l2 = std::sqrt(squares / weights);
        errors.linf = largest;
        errors.linf_at = largest_at;
    }
};

void put_gradients(const FieldView& test, const FieldView& reference, std::span<const FieldSample> places,
                   FieldDifference& errors) {
    std::vector<double> squares(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
        squares[i] = -1;  // none
        if (!places[i].test) return;
        const auto expected = gradient_at(reference, places[i].x);
        const auto found = expected ? gradient_at(test, places[i].x) : std::nullopt;
        if (found) squares[i] = glm::dot(*found - *expected, *found - *expected);
    });
    double sum = 0;
    for (const double square : squares) {
        if (square < 0) continue;
        sum += square;
        ++errors.gradients;
    }
    if (errors.gradients > 0) errors.gradient_rmse = std::sqrt(sum / static_cast<double>(errors.gradients));
}

}  // namespace

std::optional<Vec3> gradient_at(const FieldView& field, const Vec3& x) {
    if (field.gradient) return field.gradient(x);
    const auto middle = field.value(x);
    if (!middle) return std::nullopt;
    const double step = field.step > 0 ? field.step : kStep * field.box.diagonal();
    Vec3 gradient(0.0);
    for (int k = 0; k < 3; ++k) {
        Vec3 d(0.0);
        d[k] = step;
        const auto before = field.value(x - d), after = field.value(x + d);
        if (!before && !after) return std::nullopt;
        gradient[k] = (after.value_or(*middle) - before.value_or(*middle)) / (before && after ? 2 * step : step);
    }
    return gradient;
}

FieldDifference compare_fields(const FieldView& test, const FieldView& reference, const FieldDifferenceOptions& options) {
    const auto places = random_places_of(test, reference, options);
    FieldDifference errors;
    Errors sums;
    for (const FieldSample& place : places) {
        if (place.test) {
            sums.add(*place.test - *place.reference, 1, place.x);
            ++errors.samples;
        } else {
            ++errors.uncovered;
        }
    }
    sums.put_into(errors);
    if (options.gradients) put_gradients(test, reference, places, errors);
    return errors;
}

FieldDifference compare_field(const FieldView& test, const FieldSamples& places) {
    if (places.size() == 0) throw Error(ErrorCode::InvalidInput, "there are no places to compare a field at");
    std::vector<std::optional<double>> values(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) { values[i] = test.value(places.points[i]); });
    FieldDifference errors;
    Errors sums;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i]) {
            sums.add(*values[i] - places.values[i], places.weights[i], places.points[i]);
            ++errors.samples;
        } else {
            ++errors.uncovered;
        }
    }
    sums.put_into(errors);
    return errors;
}

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

namespace {

MassError mass_error_at(const FieldView& test, const FieldView& reference, int resolution, Progress* progress) {
    const Box box = detail::box_about(test.box, reference.box);
    MassError mass{integrate_field(test, box, resolution, progress), integrate_field(reference, box, resolution, progress)};
    const double difference = std::abs(mass.test - mass.reference);
    mass.relative = difference == 0 ? 0 : difference / std::abs(mass.reference);
    mass.resolution = resolution;
    return mass;
}

}  // namespace

MassError mass_error(const FieldView& test, const FieldView& reference, std::optional<int> resolution, Progress* progress) {
    constexpr int kFirst = 32, kMost = 128;
    constexpr double kSteady = 1e-4, kSteadyShare = .05;
    if (resolution) return mass_error_at(test, reference, *resolution, progress);
    MassError mass = mass_error_at(test, reference, kFirst, progress);
    while (mass.resolution < kMost) {
        const double before = mass.relative;
        mass = mass_error_at(test, reference, 2 * mass.resolution, progress);
        if (std::abs(mass.relative - before) <= std::max(kSteady, kSteadyShare * mass.relative)) break;
    }
    return mass;
}

namespace {

double one_sided(const Surface& from, const Surface& to) {
    const detail::BoxTree tree(detail::triangle_boxes(to));
    std::vector<double> distances(from.points.size());
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
        const Vec3& x = from.points[i];
        distances[i] = tree.nearest(x, [&](Index triangle) {
            const auto& t = to.triangles[triangle];
            return detail::squared_distance(x, to.points[t[0]], to.points[t[1]], to.points[t[2]]);
        });
    });
    return std::sqrt(*std::max_element(distances.begin(), distances.end()));
}

}  // namespace

double hausdorff_distance(const Surface& a, const Surface& b) {
    if (a.triangles.empty() && b.triangles.empty()) return 0;
    if (a.triangles.empty() || b.triangles.empty()) return std::numeric_limits<double>::infinity();
    return std::max(one_sided(a, b), one_sided(b, a));
}

IsosurfaceDistance isosurface_distance(const FieldView& test, const FieldView& reference, double iso, int resolution,
                                       Progress* progress) {
    const Box box = detail::box_about(test.box, reference.box);
    const Surface a = isosurface(test, iso, box, resolution, progress);
    const Surface b = isosurface(reference, iso, box, resolution, progress);
    if (a.triangles.empty() && b.triangles.empty()) {
        throw Error(ErrorCode::InvalidInput, "neither field takes the value " + detail::number_text(iso) + " in its domain");
    }
    return {hausdorff_distance(a, b), detail::SampleGrid(box, resolution).spacing(), a.triangles.size(), b.triangles.size()};
}

}  // namespace subvol
