// SPDX-License-Identifier: Apache-2.0
// Analysis in three steps, each of which is undone by the same sum with the opposite sign:
//   c′ = D⁻¹ (f_old − U f_new)    the control values, if the field is refined
//   d  = f_new − S_new c′         0 if it is
//   c  = c′ + A d                 control values that have the field's mean whatever d is
// Synthesis: c′ = c − A d, f_new = S_new c′ + d, f_old = D c′ + U f_new.
#include "subvol/wavelet.h"

#include <glm/geometric.hpp>

#include <cmath>

#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/vec.h"

namespace subvol {

using detail::parallel_each;

namespace {

[[noreturn]] void refuse(std::size_t given, std::size_t needed, const std::string& what) {
    throw Error(ErrorCode::InvalidInput, std::to_string(given) + " " + what, "wavelets", std::to_string(needed));
}

void check(const WaveletBasis& basis, const WaveletField& field) {
    if (field.channels == 0) throw Error(ErrorCode::InvalidInput, "the field has no channel", "wavelets", "at least one");
    if (field.coarse.size() != basis.control_points * field.channels) {
        refuse(field.coarse.size(), basis.control_points * field.channels, "control values");
    }
    if (field.details.size() > basis.steps.size()) refuse(field.details.size(), basis.steps.size(), "levels of details");
    for (std::size_t l = 0; l < field.details.size(); ++l) {
        const std::size_t needed = basis.steps[l].new_points() * field.channels;
        if (field.details[l].size() != needed) refuse(field.details[l].size(), needed, "details");
    }
}

/// c += sign × A d
void lift(const WaveletStep& step, std::span<const double> details, std::size_t channels, double sign, std::span<double> c) {
    parallel_each(step.refine.columns(), [&](std::size_t v) {
        for (std::size_t i = step.star.offsets[v]; i < step.star.offsets[v + 1]; ++i) {
            const std::size_t from = step.star.values[i] * channels;
            const double weight = sign * step.lift[i];
            for (std::size_t k = 0; k < channels; ++k) c[v * channels + k] += weight * details[from + k];
        }
    });
}

/// sum of U over the new values at an old point, channel k
double even_sum(const WaveletStep& step, std::span<const double> fresh, std::size_t channels, std::size_t v, std::size_t k) {
    double sum = 0;
    for (std::size_t i = step.star.offsets[v]; i < step.star.offsets[v + 1]; ++i) {
        sum += step.even[i] * fresh[step.star.values[i] * channels + k];
    }
    return sum;
}

/// One step of analysis: `fine` becomes the coarser values; returns the details.
std::vector<double> analyze_step(const WaveletStep& step, std::vector<double>& fine, std::size_t channels) {
    const std::size_t old_points = step.refine.columns(), begin = old_points * channels;
    std::vector<double> coarse(fine.begin(), fine.begin() + static_cast<std::ptrdiff_t>(begin));
    const std::span<const double> fresh = std::span<const double>(fine).subspan(begin);
    if (!step.even.empty()) {
        parallel_each(old_points, [&](std::size_t v) {
            for (std::size_t k = 0; k < channels; ++k) {
                double& value = coarse[v * channels + k];
                value = (value - even_sum(step, fresh, channels, v, k)) / step.own[v];
            }
        });
    }
    std::vector<double> refined(step.refine.rows() * channels);
    step.refine.apply(std::span<const double>(coarse), channels, std::span<double>(refined));
    std::vector<double> details(fresh.size());
    parallel_each(details.size(), [&](std::size_t i) { details[i] = fresh[i] - refined[begin + i]; });
    lift(step, details, channels, 1, coarse);
    fine = std::move(coarse);
    return details;
}

/// One step of synthesis: the finer values from the coarser ones.
std::vector<double> synthesize_step(const WaveletStep& step, std::vector<double> coarse, std::span<const double> details,
                                    std::size_t channels) {
    const std::size_t old_points = step.refine.columns(), begin = old_points * channels;
    lift(step, details, channels, -1, coarse);
    std::vector<double> fine(step.refine.rows() * channels);
    step.refine.apply(std::span<const double>(coarse), channels, std::span<double>(fine));
    parallel_each(details.size(), [&](std::size_t i) { fine[begin + i] += details[i]; });
    if (!step.even.empty()) {
        const std::span<const double> fresh = std::span<const double>(fine).subspan(begin);
        parallel_each(old_points, [&](std::size_t v) {
            for (std::size_t k = 0; k < channels; ++k) {
                fine[v * channels + k] = step.own[v] * coarse[v * channels + k] + even_sum(step, fresh, channels, v, k);
            }
        });
    }
    return fine;
}

struct Axes {
    std::array<Vec3, 3> along{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
};

/// Right-handed unit axes at a new point from its neighbours; those of the world where these lie on a line.
Axes axes_at(const WaveletStep& step, std::size_t n, std::span<const double> refined) {
    const auto point = [&](std::size_t p) { return Vec3(refined[3 * p], refined[3 * p + 1], refined[3 * p + 2]); };
    const Vec3 at = point(step.refine.columns() + n);
    const auto& [a, b, c] = step.beside[n];
    const Vec3 u = point(a) - at, v = point(b) - at;
    const Vec3 normal = glm::cross(u, v);
    const double length = glm::length(u), area = glm::length(normal);
    if (!(area > 1e-9 * length * glm::length(v))) return {};
    const Vec3 x = u / length, z = normal / area;
    return {{x, glm::cross(z, x), z}};
}

enum class Turn { ToShape, ToWorld };

void turn(const WaveletBasis& basis, WaveletField& shape, Turn direction) {
    if (shape.channels != 3) refuse(shape.channels, 3, "channels of positions");
    check(basis, shape);
    std::vector<double> coarse = shape.coarse;
    for (std::size_t l = 0; l < shape.details.size(); ++l) {
        const WaveletStep& step = basis.steps[l];
        std::vector<double>& details = shape.details[l];
        std::vector<double> refined(step.refine.rows() * 3), world(details.size());
        step.refine.apply(std::span<const double>(coarse), 3, std::span<double>(refined));
        parallel_each(step.new_points(), [&](std::size_t n) {
            const Axes axes = axes_at(step, n, refined);
            const Vec3 given(details[3 * n], details[3 * n + 1], details[3 * n + 2]);
            Vec3 turned(0);
            for (int a = 0; a < 3; ++a) {
                const Vec3& axis = axes.along[static_cast<std::size_t>(a)];
                if (direction == Turn::ToShape) {
                    turned[a] = glm::dot(axis, given);
                } else {
                    turned += given[a] * axis;
                }
            }
            const Vec3& in_world = direction == Turn::ToShape ? given : turned;
            for (int a = 0; a < 3; ++a) {
                details[3 * n + static_cast<std::size_t>(a)] = turned[a];
                world[3 * n + static_cast<std::size_t>(a)] = in_world[a];
            }
        });
        coarse = synthesize_step(step, std::move(coarse), world, 3);
    }
}

}  // namespace

WaveletField analyze(const WaveletBasis& basis, std::span<const double> values, std::size_t channels) {
    if (channels == 0 || values.size() != basis.points() * channels) refuse(values.size(), basis.points() * channels, "values");
    WaveletField field{channels, {values.begin(), values.end()}, {}};
    field.details.resize(basis.steps.size());
    for (std::size_t l = basis.steps.size(); l-- > 0;) {
        field.details[l] = analyze_step(basis.steps[l], field.coarse, channels);
    }
    return field;
}

std::vector<double> synthesize(const WaveletBasis& basis, const WaveletField& field) {
    check(basis, field);
    std::vector<double> values = field.coarse;
    for (std::size_t l = 0; l < field.details.size(); ++l) {
        values = synthesize_step(basis.steps[l], std::move(values), field.details[l], field.channels);
    }
    return values;
}

void turn_details_to_shape(const WaveletBasis& basis, WaveletField& shape) {
    turn(basis, shape, Turn::ToShape);
}

void turn_details_to_world(const WaveletBasis& basis, WaveletField& shape) {
    turn(basis, shape, Turn::ToWorld);
}

}  // namespace subvol
