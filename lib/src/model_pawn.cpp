#include <algorithm>
#include <array>
#include <cmath>

#include "model_parts.h"
#include "subvol/model.h"

namespace subvol {
namespace {

// 50° of bend over a height of 2, 75° of twist. The arc's length is the block's height, so lengths on the axis are kept.
constexpr double kBend = 0.4363;
constexpr model::BentBlock kBlock{.half_width = 0.5, .twist_rad = 0.6545, .bend_rad = kBend, .radius = 1 / kBend};

// The density saturates over this length (tanh): from -.76 to .76 in 2 · .03, two cells at the default resolution.
constexpr double kTransition = 0.03;
// Parts are joined and cut with rounded edges of about this size (log-sum-exp).
constexpr double kRounding = 0.02;

double smooth_max(std::initializer_list<double> values) {
    const double top = std::max(values);
    double sum = 0;
    for (const double v : values) sum += std::exp((v - top) / kRounding);
    return top + kRounding * std::log(sum);
}

double smooth_min(double a, double b) {
    return -smooth_max({-a, -b});
}

/// Like a signed distance, positive inside, with slope 1 at the surface; a polynomial, so smooth on the axis too.
double inside(double squared_distance, double radius) {
    return (radius * radius - squared_distance) / (2 * radius);
}

double slab(double z, double center, double half_height) {
    return inside((z - center) * (z - center), half_height);
}

double disk(double r2, double z, double radius, double center, double half_height) {
    return smooth_min(inside(r2, radius), slab(z, center, half_height));
}

/// A chess pawn about the z axis, from -.9 to .87, radius .42. r2: squared distance from the axis
double pawn(double r2, double z) {
    const double base = disk(r2, z, 0.42, -0.80, 0.11);
    const double step = disk(r2, z, 0.33, -0.62, 0.10);
    const double slope = (0.36 - z) / 0.9;
    const double body = smooth_min(inside(r2, 0.115 + 0.15 * slope * slope), slab(z, -0.10, 0.62));
    const double collar = disk(r2, z, 0.26, 0.35, 0.065);
    const double head = inside(r2 + (z - 0.62) * (z - 0.62), 0.25);
    return smooth_max({base, step, body, collar, head});
}

}  // namespace

Vec3 PawnField::parameter(const Vec3& x) {
    return kBlock.parameter(x);
}

Vec3 PawnField::position(const Vec3& parameter) {
    return kBlock.position(parameter);
}

double PawnField::density(const Vec3& p) {
    const double half = kBlock.half_width;
    return std::tanh(pawn(half * half * (p.x * p.x + p.y * p.y), p.z) / kTransition);
}

std::optional<double> PawnField::value(const Vec3& x) const {
    const Vec3 p = parameter(x);
    if (!model::in_block(p)) return std::nullopt;
    return density(p);
}

HexMesh model::make_pawn(Index resolution) {
    const Index across = std::max<Index>(1, resolution / 2);  // the block is twice as high as wide
    HexMesh mesh = parameter_block({across, across, resolution});
    Attribute field{.name = "density", .channels = 1, .values = {}};
    field.values.reserve(mesh.points.size());
    for (Vec3& p : mesh.points) {
        field.values.push_back(PawnField::density(p));
        p = PawnField::position(p);
    }
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol
