// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "subvol/detail/across.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/space_order.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/streamlines.h"

namespace subvol {
namespace {

struct SeedKind {
    std::string_view name;
    std::size_t numbers;
};
constexpr std::array<SeedKind, 5> kKinds{{{"at:", 3}, {"line:", 6}, {"disk:", 7}, {"sphere:", 4}, {"box:", 6}}};
constexpr const char* kAllowed =
    "at:x,y,z, line:x0,y0,z0,x1,y1,z1, disk:x,y,z,nx,ny,nz,r, sphere:x,y,z,r, box:x0,y0,z0,x1,y1,z1";

[[noreturn]] void fail_seeds(const std::string& text, const std::string& what) {
    throw Error(ErrorCode::InvalidInput, what, "seeds '" + detail::shortened(text) + "'", kAllowed);
}

std::vector<double> numbers_of(const std::string& text, const SeedKind& kind) {
    std::vector<double> numbers;
    for (std::size_t begin = kind.name.size(); begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const auto number = detail::plain_number(std::string_view(text).substr(begin, end - begin));
        if (!number || !std::isfinite(*number)) fail_seeds(text, "a number is wrong");
        numbers.push_back(*number);
        begin = end + 1;
    }
    if (numbers.size() != kind.numbers) {
        fail_seeds(text, "has " + std::to_string(numbers.size()) + " numbers instead of " + std::to_string(kind.numbers));
    }
    return numbers;
}

/// The i-th number of a sequence that fills 0 to 1 evenly, by Halton.
double halton(std::size_t i, std::size_t base) {
    double sum = 0, part = 1;
    for (; i > 0; i /= base) {
        part /= static_cast<double>(base);
        sum += part * static_cast<double>(i % base);
    }
    return sum;
}

Vec3 halton(std::size_t i) {
    return {halton(i, 2), halton(i, 3), halton(i, 5)};
}

std::vector<Vec3> in_sphere(const Vec3& center, double radius, std::size_t count) {
    std::vector<Vec3> places;
    for (std::size_t i = 1; places.size() < count; ++i) {
        const Vec3 place = 2.0 * halton(i) - 1.0;
        if (glm::dot(place, place) <= 1) places.push_back(center + radius * place);
    }
    return places;
}

/// In a spiral with as much area for each place.
std::vector<Vec3> on_disk(const Vec3& center, const Vec3& normal, double radius, std::size_t count) {
    const auto [u, v] = detail::across(glm::normalize(normal));
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < count; ++i) {
        const double number = static_cast<double>(i);
        const double r = radius * std::sqrt((number + 0.5) / static_cast<double>(count));
        places.push_back(center + r * std::cos(number * turn) * u + r * std::sin(number * turn) * v);
    }
    return places;
}

}  // namespace

std::vector<Vec3> parse_seeds(const std::string& text, std::size_t count) {
    const auto kind = std::ranges::find_if(kKinds, [&](const SeedKind& k) { return text.starts_with(k.name); });
    if (kind == kKinds.end()) fail_seeds(text, "are not places");
    const std::vector<double> n = numbers_of(text, *kind);
    const Vec3 first(n[0], n[1], n[2]);
    if (count == 0) fail_seeds(text, "no place is asked for");
    if (kind->name == "at:") return {first};
    if (kind->name == "sphere:") {
        if (!(n[3] > 0)) fail_seeds(text, "the radius is not positive");
        return in_sphere(first, n[3], count);
    }
    const Vec3 second(n[3], n[4], n[5]);
    if (kind->name == "line:") return places_on_line(first, second, count);
    if (kind->name == "disk:") {
        if (!(glm::length(second) > 0)) fail_seeds(text, "the normal has no direction");
        if (!(n[6] > 0)) fail_seeds(text, "the radius is not positive");
        return on_disk(first, second, n[6], count);
    }
    std::vector<Vec3> places;
    for (std::size_t i = 1; i <= count; ++i) places.push_back(first + halton(i) * (second - first));
    return places;
}

std::vector<Vec3> middles_of_cells(const HexMesh& mesh, std::size_t count, const LimitOptions& options) {
    if (count == 0) throw Error(ErrorCode::InvalidInput, "no place is asked for", "middles_of_cells", "a count of at least 1");
    std::vector<Index> cells(mesh.cells.size());
    for (Index c = 0; c < cells.size(); ++c) cells[c] = c;
    std::vector<LimitQuery> queries;
    if (count >= cells.size()) {
        for (const Index c : cells) queries.push_back({c, Vec3(0.5)});
    } else {
        const std::vector<Index> sorted = detail::in_space_order(mesh, cells);
        std::vector<double> until(sorted.size());  // the volume of the cells up to each
        double sum = 0;
        for (std::size_t i = 0; i < sorted.size(); ++i) {
            std::array<Vec3, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[sorted[i]][k]];
            until[i] = sum += std::max(0.0, cell_volume(corners));
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double wanted = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * sum;
            const auto at =
                std::min(static_cast<std::size_t>(std::ranges::lower_bound(until, wanted) - until.begin()), sorted.size() - 1);
            if (queries.empty() || queries.back().cell != sorted[at]) queries.push_back({sorted[at], Vec3(0.5)});
        }
    }
    return evaluate_limit(mesh, queries, options).positions;
}

}  // namespace subvol
