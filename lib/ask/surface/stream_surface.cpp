// SPDX-License-Identifier: Apache-2.0
#include "subvol/stream_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shell_triangles.h"
#include "subvol/detail/across.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {
namespace {

constexpr std::size_t kTubeSides = 12;  // 30 degrees between normals: smooth where they are drawn
// Parts of an arrow of length 1.
constexpr double kShaftRadius = 0.035, kHeadRadius = 0.1, kHeadLength = 0.35;

/// Surfaces made of rings about a line.
class Rings : detail::ShellTriangles {
public:
    using ShellTriangles::ShellTriangles;

    /// Adds a ring, and the side between it and the one before.
    void ring(const Vec3& center, const Vec3& u, const Vec3& v, double radius, Index source) {
        const std::size_t first = next_point();
        for (std::size_t k = 0; k < kTubeSides; ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kTubeSides;
            add(center + radius * (std::cos(angle) * u + std::sin(angle) * v), source);
        }
        for (std::size_t k = 0; before_ && k < kTubeSides; ++k) {
            const std::size_t next = (k + 1) % kTubeSides;
            triangle(*before_ + k, *before_ + next, first + k);
            triangle(*before_ + next, first + next, first + k);
        }
        before_ = first;
    }

    /// Closes the last ring, or begins a new line with a closed one that `ring` adds next.
    void close(const Vec3& center, Index source) {
        const std::size_t middle = next_point();
        add(center, source);
        for (std::size_t k = 0; k < kTubeSides; ++k) triangle(*before_ + k, *before_ + (k + 1) % kTubeSides, middle);
    }

    void begin() { before_.reset(); }

private:
    std::optional<std::size_t> before_{};
};

void check_size(double size, const char* what) {
    if (size > 0 && std::isfinite(size)) return;
    throw Error(ErrorCode::InvalidInput, std::string(what) + " is not positive and finite", "stream surface");
}

}  // namespace

std::vector<Option> options_of(TubeOptions& options) {
    return {Option("tube-radius", options.radius)
                .between(1e-5, 0.1)
                .help("R", "the radius of the tubes that show streamlines, as a part of the diagonal")};
}

std::vector<Option> options_of(GlyphOptions& options) {
    return {Option("glyph-count", options.count).between(1, 1e6).help("N", "the number of arrows, at most one in each cell"),
            Option("glyph-size", options.size)
                .between(1e-4, 1)
                .help("L", "the length of the longest arrow, as a part of the diagonal")};
}

ShellSurface tube_surface(const Streamlines& lines, double radius_world) {
    check_size(radius_world, "the radius");
    ShellSurface made;
    Rings rings(made);
    for (std::size_t i = 0; i < lines.count(); ++i) {
        std::vector<std::size_t> kept;  // points that are not one
        for (std::size_t p = lines.firsts[i]; p < lines.firsts[i + 1]; ++p) {
            if (kept.empty() || glm::distance(lines.points[p], lines.points[kept.back()]) > 1e-3 * radius_world)
                kept.push_back(p);
        }
        if (kept.size() < 2) continue;
        rings.begin();
        Vec3 u(0.0);
        for (std::size_t k = 0; k < kept.size(); ++k) {
            const Vec3& here = lines.points[kept[k]];
            const Vec3& last = lines.points[kept[k == 0 ? 0 : k - 1]];
            const Vec3& next = lines.points[kept[std::min(k + 1, kept.size() - 1)]];
            Vec3 along = next - last;
            if (!(glm::length(along) > 0)) along = next - here;
            if (!(glm::length(along) > 0)) continue;
            along = glm::normalize(along);
            u -= glm::dot(u, along) * along;
            u = glm::length(u) > 1e-6 ? glm::normalize(u) : detail::across(along)[0];
            const auto source = static_cast<Index>(kept[k]);
            rings.ring(here, u, glm::cross(along, u), radius_world, source);
            if (k == 0 || k + 1 == kept.size()) rings.close(here, source);
        }
    }
    made.shell_triangles = 0;
    return made;
}

ShellSurface arrow_surface(std::span<const Vec3> places, std::span<const Vec3> vectors, double longest_world) {
    check_size(longest_world, "the length");
    if (places.size() != vectors.size()) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(vectors.size()) + " vectors for " + std::to_string(places.size()) + " places",
                    "stream surface");
    }
    double largest = 0;
    for (const Vec3& vector : vectors) largest = std::max(largest, glm::length(vector));
    ShellSurface made;
    Rings rings(made);
    for (std::size_t p = 0; p < places.size(); ++p) {
        const double speed = glm::length(vectors[p]);
        if (!(speed > 0)) continue;
        const Vec3 along = vectors[p] / speed;
        const double length = speed / largest * longest_world;
        const auto [u, v] = detail::across(along);
        const auto source = static_cast<Index>(p);
        const auto at = [&](double t) { return places[p] + (t - 0.5) * length * along; };
        rings.begin();
        rings.ring(at(0), u, v, kShaftRadius * length, source);
        rings.close(at(0), source);
        rings.ring(at(1 - kHeadLength), u, v, kShaftRadius * length, source);
        rings.ring(at(1 - kHeadLength), u, v, kHeadRadius * length, source);
        rings.ring(at(1), u, v, 1e-3 * kHeadRadius * length, source);
    }
    return made;
}

}  // namespace subvol
