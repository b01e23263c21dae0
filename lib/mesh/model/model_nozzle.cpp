// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "model_block.h"
#include "subvol/model.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kThroat = 0.21;      // radius where the gas is as fast as sound
constexpr double kHalfCore = 0.5;     // half the side of the core square, relative to the radius
constexpr double kBulgeOfCore = 0.5;  // how far the core square is rounded towards a disk, in [0,1]
constexpr double kBoundaryLayer = 6;  // exponent of the profile across the flow: the layer takes about a tenth of the radius

constexpr std::array<model::Deformation, 2> kNozzleDeformation{
    model::Sway{.along = 0, .towards = 1, .amount = 0.1, .rate = 2.2}, model::Bend{.along = 0, .towards = 2, .radius = 2.6}};

/// The Mach number: from .15 at the inlet to 3 at the outlet, which have about the same cross-section.
double mach(double s) {
    return std::exp(-0.3993 + 1.4979 * s);
}

/// The radius of the cross-section at s, by the isentropic relation of area and Mach number for a heat capacity ratio of 1.4.
double radius(double s) {
    const double m = mach(s), temperature = (1 + 0.2 * m * m) / 1.2;
    return kThroat * std::sqrt(temperature * temperature * temperature / m);
}

/// The speed in the core of the flow, relative to the greatest speed that a gas from rest can reach.
double core_speed(double s) {
    const double m2 = mach(s) * mach(s);
    return std::sqrt(0.2 * m2 / (1 + 0.2 * m2));
}

/// Maps the square [-1,1]² smoothly onto the unit disk, its rim onto the circle.
Vec2 disk_from_square(const Vec2& p) {
    return {p.x * std::sqrt(1 - 0.5 * p.y * p.y), p.y * std::sqrt(1 - 0.5 * p.x * p.x)};
}

/// The points and quads of the unit disk: a core of n × n quads and m rings of 4n about it.
struct Section {
    std::vector<Vec2> points;
    std::vector<std::array<Index, 4>> quads;
};

/// The points on the rim of an (n+1)² lattice, counter-clockwise.
std::vector<Index> rim(Index n) {
    const Index row = n + 1;
    std::vector<Index> ids;
    for (Index i = 0; i < n; ++i) ids.push_back(i);
    for (Index i = 0; i < n; ++i) ids.push_back(n + row * i);
    for (Index i = 0; i < n; ++i) ids.push_back(n - i + row * n);
    for (Index i = 0; i < n; ++i) ids.push_back(row * (n - i));
    return ids;
}

void add_core(Section& section, Index n) {
    const Index row = n + 1;
    const auto coordinate = [n](Index i) { return -1 + 2.0 * static_cast<double>(i) / static_cast<double>(n); };
    for (Index j = 0; j <= n; ++j) {
        for (Index i = 0; i <= n; ++i) section.points.emplace_back(coordinate(i), coordinate(j));
    }
    for (Index j = 0; j < n; ++j) {
        for (Index i = 0; i < n; ++i) {
            const Index p = i + row * j;
            section.quads.push_back({p, p + 1, p + 1 + row, p + row});
        }
    }
}

/// Adds rings around the core, whose points are still those of the square.
void add_rings(Section& section, const std::vector<Index>& inner, Index rings) {
    const auto around = static_cast<Index>(inner.size()), core = static_cast<Index>(section.points.size());
    const auto point = [&](Index layer, Index k) { return layer == 0 ? inner[k] : core + (layer - 1) * around + k; };
    for (Index layer = 1; layer <= rings; ++layer) {
        const double t = static_cast<double>(layer) / static_cast<double>(rings);
        for (const Index id : inner) {
            const Vec2 square = section.points[id], disk = disk_from_square(square);
            section.points.push_back(glm::mix(kHalfCore * glm::mix(square, disk, kBulgeOfCore), disk, t));
        }
        for (Index k = 0; k < around; ++k) {
            const Index next = (k + 1) % around;
            section.quads.push_back({point(layer - 1, k), point(layer, k), point(layer, next), point(layer - 1, next)});
        }
    }
}

Section o_grid(Index across, Index rings) {
    Section section;
    add_core(section, across);
    const std::size_t core = section.points.size();
    add_rings(section, rim(across), rings);
    for (std::size_t p = 0; p < core; ++p) {
        section.points[p] = kHalfCore * glm::mix(section.points[p], disk_from_square(section.points[p]), kBulgeOfCore);
    }
    return section;
}

HexMesh extruded(const Section& section, Index layers) {
    const auto count = static_cast<Index>(section.points.size());
    HexMesh mesh;
    mesh.points.reserve(std::size_t{count} * (layers + 1));
    for (Index layer = 0; layer <= layers; ++layer) {
        const double s = -1 + 2.0 * static_cast<double>(layer) / static_cast<double>(layers);
        for (const Vec2& p : section.points) mesh.points.emplace_back(s, p.x, p.y);
    }
    mesh.cells.reserve(section.quads.size() * layers);
    for (Index layer = 0; layer < layers; ++layer) {
        for (const auto& [a, b, c, d] : section.quads) {
            const Index low = count * layer, high = low + count;
            mesh.cells.push_back({low + a, low + b, low + c, low + d, high + a, high + b, high + c, high + d});
        }
    }
    return mesh;
}

}  // namespace

Vec3 NozzleField::parameter(const Vec3& x) {
    const Vec3 q = model::undo(kNozzleDeformation, x);
    const double r = radius(q.x);
    return {q.x, q.y / r, q.z / r};
}

Vec3 NozzleField::position(const Vec3& p) {
    const double r = radius(p.x);
    return model::apply(kNozzleDeformation, {p.x, r * p.y, r * p.z});
}

double NozzleField::density(const Vec3& p) {
    const double r2 = p.y * p.y + p.z * p.z;
    const double profile = std::max(0.0, 1 - std::pow(r2, kBoundaryLayer / 2));  // at the rim r2 may round to more than 1
    return -1 + 2 * core_speed(p.x) / core_speed(1) * profile;
}

std::optional<double> NozzleField::value(const Vec3& x) const {
    const Vec3 p = parameter(x);
    if (!(std::abs(p.x) <= 1 && p.y * p.y + p.z * p.z <= 1)) return std::nullopt;
    return density(p);
}

HexMesh detail::model::make_nozzle(Index resolution) {
    const Index across = std::max<Index>(1, (resolution + 2) / 4), rings = std::max<Index>(1, (5 * resolution + 24) / 48);
    HexMesh mesh = extruded(o_grid(across, rings), resolution);
    Attribute field{.name = "density", .channels = 1, .values = {}};
    field.values.reserve(mesh.points.size());
    for (Vec3& p : mesh.points) {
        field.values.push_back(NozzleField::density(p));
        p = NozzleField::position(p);
    }
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol
