// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model_block.h"
#include "subvol/detail/twist_block.h"
#include "subvol/model.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kPi = std::numbers::pi;
// The arc of radius 1.6 reaches from -63° to 63°; the section turns by 90° on the way.
constexpr double kRadius = 1.6, kHalfLength = 0.35 * kPi * kRadius;
constexpr Vec3 kHalf{0.6, 0.6, kHalfLength};
constexpr std::array<model::Deformation, 2> kTwistDeformation{
    model::Twist{.axis = 2, .rate = kPi / 4 / kHalfLength, .offset = kPi / 4},
    model::Bend{.along = 2, .towards = 0, .radius = kRadius}};

double rounded_to_float(double x) {
    // volatile: GCC 12.2 at -O2 drops double → float → double when it vectorizes neighbouring components.
    const volatile float rounded = static_cast<float>(x);
    return rounded;
}

}  // namespace

Vec3 TwistField::parameter(const Vec3& x) {
    return model::undo(kTwistDeformation, x) / kHalf;
}

Vec3 TwistField::position(const Vec3& parameter) {
    return model::apply(kTwistDeformation, kHalf * parameter);
}

double TwistField::density(const Vec3& p) {
    const double f =
        std::sin(3.1 * p.x + 0.3) * std::cos(2.7 * p.y) * std::sin(2.3 * p.z + 0.5) + 0.25 * std::cos(4 * glm::dot(p, p));
    return std::clamp(f, -1.0, 1.0);
}

std::optional<double> TwistField::value(const Vec3& x) const {
    const Vec3 p = parameter(x);
    if (!model::in_block(p)) return std::nullopt;
    return density(p);
}

HexMesh detail::twist_block(std::uint64_t n, const CellRange& cells) {
    HexMesh mesh;
    Attribute field{.name = "density", .channels = 1, .values = {}};
    const auto coordinate = [n](std::uint64_t i) { return -1 + 2.0 * static_cast<double>(i) / static_cast<double>(n); };
    for (std::uint64_t z = cells.begin[2]; z <= cells.end[2]; ++z) {
        for (std::uint64_t y = cells.begin[1]; y <= cells.end[1]; ++y) {
            for (std::uint64_t x = cells.begin[0]; x <= cells.end[0]; ++x) {
                const Vec3 parameter(coordinate(x), coordinate(y), coordinate(z));
                field.values.push_back(TwistField::density(parameter));
                const Vec3 at = TwistField::position(parameter);
                // Rounded, as the published benchmark has it.
                mesh.points.emplace_back(rounded_to_float(at.x), rounded_to_float(at.y), rounded_to_float(at.z));
            }
        }
    }
    mesh.attributes.push_back(std::move(field));
    const auto row = static_cast<Index>(cells.end[0] - cells.begin[0] + 1);
    const auto layer = static_cast<Index>(row * (cells.end[1] - cells.begin[1] + 1));
    for (std::uint64_t z = cells.begin[2]; z < cells.end[2]; ++z) {
        for (std::uint64_t y = cells.begin[1]; y < cells.end[1]; ++y) {
            for (std::uint64_t x = cells.begin[0]; x < cells.end[0]; ++x) {
                const auto p = static_cast<Index>(x - cells.begin[0] + row * (y - cells.begin[1]) +
                                                  std::uint64_t{layer} * (z - cells.begin[2]));
                const Index q = p + layer;
                mesh.cells.push_back({p, p + 1, p + 1 + row, p + row, q, q + 1, q + 1 + row, q + row});
            }
        }
    }
    return mesh;
}

HexMesh detail::model::make_twist(Index resolution) {
    return twist_block(resolution, {{0, 0, 0}, {resolution, resolution, resolution}});
}

}  // namespace subvol
