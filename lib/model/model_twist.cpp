// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model_block.h"
#include "subvol/model.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kPi = std::numbers::pi;
// The arc of radius 1.6 reaches from -63° to 63°; the section turns by 90° on the way.
constexpr double kRadius = 1.6, kHalfLength = 0.35 * kPi * kRadius;
constexpr Vec3 kHalf{0.6, 0.6, kHalfLength};
constexpr std::array<model::Deformation, 2> kDeformation{
    model::Twist{.axis = 2, .rate = kPi / 4 / kHalfLength, .offset = kPi / 4},
    model::Bend{.along = 2, .towards = 0, .radius = kRadius}};

double rounded_to_float(double x) {
    // volatile: GCC 12.2 at -O2 drops double → float → double when it vectorizes neighbouring components.
    const volatile float rounded = static_cast<float>(x);
    return rounded;
}

}  // namespace

Vec3 TwistField::parameter(const Vec3& x) {
    return model::undo(kDeformation, x) / kHalf;
}

Vec3 TwistField::position(const Vec3& parameter) {
    return model::apply(kDeformation, kHalf * parameter);
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

HexMesh detail::model::make_twist(Index resolution) {
    HexMesh mesh = parameter_block({resolution, resolution, resolution});
    Attribute field{.name = "density", .channels = 1, .values = {}};
    field.values.reserve(mesh.points.size());
    for (Vec3& p : mesh.points) {
        field.values.push_back(TwistField::density(p));
        const Vec3 x = TwistField::position(p);
        p = {rounded_to_float(x.x), rounded_to_float(x.y), rounded_to_float(x.z)};  // as the published benchmark has it
    }
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol
