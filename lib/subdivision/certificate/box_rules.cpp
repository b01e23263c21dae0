// SPDX-License-Identifier: Apache-2.0
#include "box_rules.h"

#include <cmath>
#include <map>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/refine.h"

namespace subvol::detail {

namespace {

// A box of unit cells; point (i, j, k) has the number (i n₁ + j) n₂ + k.
HexMesh box_of(const std::array<std::size_t, 3>& points) {
    HexMesh mesh;
    const auto number = [&](std::size_t i, std::size_t j, std::size_t k) {
        return static_cast<Index>((i * points[1] + j) * points[2] + k);
    };
    for (std::size_t i = 0; i < points[0]; ++i) {
        for (std::size_t j = 0; j < points[1]; ++j) {
            for (std::size_t k = 0; k < points[2]; ++k) {
                mesh.points.emplace_back(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
                if (i + 1 == points[0] || j + 1 == points[1] || k + 1 == points[2]) continue;
                auto& cell = mesh.cells.emplace_back();
                for (std::size_t c = 0; c < 8; ++c) {
                    const auto& [u, v, w] = kCornerParameters[c];
                    cell[c] = number(i + static_cast<std::size_t>(u), j + static_cast<std::size_t>(v),
                                     k + static_cast<std::size_t>(w));
                }
            }
        }
    }
    return mesh;
}

AxisType child_axis(const AxisType& type, bool upper) {
    const auto two = [](int layers) { return static_cast<std::uint8_t>(std::min(2, layers)); };
    return {two(2 * type.low + (upper ? 1 : 0)), two(2 * type.high + (upper ? 0 : 1))};
}

bool is_upper(std::size_t child, std::size_t axis) {
    return (child >> (2 - axis) & 1) != 0;
}

}  // namespace

std::size_t window_points(const BoxType& type) {
    return type[0].points() * type[1].points() * type[2].points();
}

BoxType child_type(const BoxType& type, std::size_t child) {
    BoxType result;
    for (std::size_t axis = 0; axis < 3; ++axis) result[axis] = child_axis(type[axis], is_upper(child, axis));
    return result;
}

BoxRules box_rules(const BoxType& type) {
    // One layer more where there are two, so that no point that is needed is at a boundary that the cell does not have.
    std::array<std::size_t, 3> first{}, points{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = type[axis].low == 2 ? 1 : 0;
        points[axis] = type[axis].points() + first[axis] + (type[axis].high == 2 ? 1 : 0);
    }
    const HexMesh box = box_of(points);
    const RefinementTables tables = refinement_tables(build_topology(box), {.scheme = {.kind = Scheme::Mcq}, .levels = 1});
    // Linear data stay linear, so the points of the box show where the new ones are.
    std::vector<double> places;
    for (const Vec3& x : box.points) places.insert(places.end(), {x.x, x.y, x.z});
    const std::vector<double> fine_places = tables.apply(std::span<const double>(places), 3);
    std::map<std::array<long, 3>, std::size_t> numbers;  // by twice their place
    for (std::size_t p = 0; p < tables.points(); ++p) {
        const auto twice = [&](std::size_t c) { return std::lround(2 * fine_places[3 * p + c]); };
        numbers[{twice(0), twice(1), twice(2)}] = p;
    }
    const std::size_t columns = window_points(type);
    std::vector<double> units(box.points.size() * columns, 0.0);
    const auto size = [&](std::size_t axis) { return type[axis].points(); };
    for (std::size_t p = 0; p < columns; ++p) {
        const std::array<std::size_t, 3> at{p / (size(1) * size(2)), p / size(2) % size(1), p % size(2)};
        const std::size_t in_box = ((at[0] + first[0]) * points[1] + at[1] + first[1]) * points[2] + at[2] + first[2];
        units[in_box * columns + p] = 1;
    }
    const std::vector<double> weights = tables.apply(std::span<const double>(units), columns);
    BoxRules rules;
    for (std::size_t child = 0; child < 8; ++child) {
        const BoxType fine = child_type(type, child);
        auto& rows = rules.children[child];
        rows.resize(static_cast<Eigen::Index>(window_points(fine)), static_cast<Eigen::Index>(columns));
        Eigen::Index row = 0;
        std::array<long, 3> low{};  // the first point of the child's window, in steps of the finer level
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t corner = 2 * (first[axis] + type[axis].low) + (is_upper(child, axis) ? 1 : 0);
            low[axis] = static_cast<long>(corner) - fine[axis].low;
        }
        const auto count = [&](std::size_t axis) { return static_cast<long>(fine[axis].points()); };
        for (long i = 0; i < count(0); ++i) {
            for (long j = 0; j < count(1); ++j) {
                for (long k = 0; k < count(2); ++k, ++row) {
                    const std::size_t p = numbers.at({low[0] + i, low[1] + j, low[2] + k});
                    for (std::size_t c = 0; c < columns; ++c) {
                        rows(row, static_cast<Eigen::Index>(c)) = weights[p * columns + c];
                    }
                }
            }
        }
    }
    return rules;
}

}  // namespace subvol::detail
