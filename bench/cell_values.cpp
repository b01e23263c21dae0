// SPDX-License-Identifier: Apache-2.0
// Values at points from cell means, by fit, exact and mean: errors, waves along rows of cells, CPU seconds.
//
//     cell_values                   twisted block and ball: a known field by its means, at three sizes
//     cell_values FILE…             a file with values at cells: how the limit varies along rows of cells; one with values at
//                                   points alone: their limit by its means
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include "lib/finite_volumes.h"
#include "subvol/cell.h"
#include "subvol/cell_means.h"
#include "subvol/limit.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/quantity.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

namespace {

using namespace subvol;

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double smooth(const Vec3& x) {
    return std::sin(4 * x.x) * std::cos(3 * x.y) + .5 * std::sin(2 * x.z + x.x);
}

std::vector<Attribute> mean_at_points(const HexMesh& mesh, const std::vector<Attribute>& of_cells) {
    std::vector<Attribute> fields;
    for (const Attribute& field : of_cells) {
        const auto width = static_cast<std::size_t>(field.channels);
        std::vector<double> sums(mesh.points.size() * width), volumes(mesh.points.size());
        for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.points[mesh.cells[c][k]];
            const double volume = std::abs(cell_volume(x));
            for (const Index p : mesh.cells[c]) {
                volumes[p] += volume;
                for (std::size_t k = 0; k < width; ++k) sums[p * width + k] += volume * field.values[c * width + k];
            }
        }
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(volumes[i / width], 1e-300);
        fields.push_back({field.name, field.channels, std::move(sums)});
    }
    return fields;
}

constexpr std::array kMethods{"mean", "exact", "fit"};

HexMesh with_values(HexMesh mesh, const std::string& method, const std::vector<Attribute>& of_cells,
                    std::span<const Index> parts, double& seconds) {
    const double before = cpu_seconds();
    if (method == "mean") mesh.attributes = mean_at_points(mesh, of_cells);
    if (method == "exact") mesh.attributes = fit_exact_cell_means(mesh, of_cells, parts).fields;
    if (method == "fit") mesh.attributes = fit_cell_means(mesh, of_cells, parts).fields;
    seconds = cpu_seconds() - before;
    return mesh;
}

struct Errors {
    double inside = 0, inside_most = 0, boundary = 0, boundary_most = 0;
};

Errors errors_of(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    std::vector<LimitQuery> queries;
    std::vector<bool> boundary;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        const bool at_boundary =
            std::ranges::any_of(mesh.cells[c], [&](Index p) { return topology.point_on_boundary[p] != 0; });
        for (const Vec3& at : {Vec3(.5, .5, .5), Vec3(.1, .3, .8), Vec3(0, .9, .4), Vec3(1, 1, 1)}) {
            queries.push_back({c, at});
            boundary.push_back(at_boundary);
        }
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.tolerance = 1e-4, .max_levels = 3});
    Errors errors;
    std::array<std::size_t, 2> counts{};
    for (std::size_t q = 0; q < queries.size(); ++q) {
        const double off = std::abs(samples.attributes[0].values[q] - smooth(samples.positions[q]));
        (boundary[q] ? errors.boundary : errors.inside) += off * off;
        double& most = boundary[q] ? errors.boundary_most : errors.inside_most;
        most = std::max(most, off);
        ++counts[boundary[q] ? 1 : 0];
    }
    errors.inside = std::sqrt(errors.inside / static_cast<double>(std::max<std::size_t>(1, counts[0])));
    errors.boundary = std::sqrt(errors.boundary / static_cast<double>(std::max<std::size_t>(1, counts[1])));
    return errors;
}

void known_fields() {
    for (const std::string model : {"twist", "ball"}) {
        const std::array<int, 3> sizes = model == "ball" ? std::array{3, 6, 12} : std::array{8, 16, 32};
        for (const std::string method : kMethods) {
            Errors last;
            for (const int size : sizes) {
                HexMesh mesh = make_model(model, size);
                double seconds = 0;
                const std::vector<Attribute> of_cells{{"f", 1, test::straight_means(mesh, smooth)}};
                const Errors now = errors_of(with_values(mesh, method, of_cells, {}, seconds));
                const auto order = [](double before, double after) { return before > 0 ? std::log2(before / after) : 0; };
                std::printf(
                    "%-6s %6zu cells %-6s inside %.2e (order %.1f) most %.2e, boundary %.2e (%.1f) most %.2e; %.2f us a cell\n",
                    model.c_str(), mesh.cells.size(), method.c_str(), now.inside, order(last.inside, now.inside),
                    now.inside_most, now.boundary, order(last.boundary, now.boundary), now.boundary_most,
                    1e6 * seconds / static_cast<double>(mesh.cells.size()));
                last = now;
            }
        }
    }
}

// The row of cells through a cell along its axis, with the parameter along which each is crossed.
struct Row {
    std::vector<Index> cells;
    std::vector<std::size_t> sides;  // through which each is left
};

Row row_from(const Topology& topology, Index cell, std::size_t side) {
    Row row;
    while (cell != kNone && std::ranges::find(row.cells, cell) == row.cells.end()) {
        row.cells.push_back(cell);
        row.sides.push_back(side);
        const Index face = topology.cell_faces[cell][side];
        const auto& cells = topology.face_cells[face];
        const Index next = cells[0] == cell ? cells[1] : cells[0];
        if (next == kNone) break;
        side =
            static_cast<std::size_t>(std::ranges::find(topology.cell_faces[next], face) - topology.cell_faces[next].begin()) ^
            1U;
        cell = next;
    }
    return row;
}

double length_of(const Attribute& field, std::size_t i) {
    const auto width = static_cast<std::size_t>(field.channels);
    if (width == 1) return field.values[i];
    double sum = 0;
    for (std::size_t k = 0; k < width; ++k) sum += field.values[i * width + k] * field.values[i * width + k];
    return std::sqrt(sum);
}

double variation(const std::vector<double>& values) {
    double sum = 0;
    for (std::size_t i = 1; i < values.size(); ++i) sum += std::abs(values[i] - values[i - 1]);
    return sum;
}

// Total variation of the limit from the first to the last centre, and of the cells' own values.
void add_row(const LimitEvaluator& limit, const Row& row, const std::vector<Attribute>& of_cells,
             std::vector<std::array<double, 2>>& sums) {
    constexpr int kSteps = 8;
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
        for (int s = 0; s < kSteps; ++s) {
            const double t = (s + .5) / kSteps;
            if ((i == 0 && t < .5) || (i + 1 == row.cells.size() && t > .5)) continue;
            Vec3 at(.5, .5, .5);
            at[static_cast<int>(row.sides[i] / 2)] = row.sides[i] % 2 == 1 ? t : 1 - t;
            queries.push_back({row.cells[i], at});
        }
    }
    const LimitSamples samples = limit.at(queries);
    for (std::size_t f = 0; f < of_cells.size(); ++f) {
        const Attribute at_places{"", of_cells[f].channels, samples.attributes[f].values};
        std::vector<double> along, cells;
        for (std::size_t q = 0; q < queries.size(); ++q) along.push_back(length_of(at_places, q));
        for (const Index c : row.cells) cells.push_back(length_of(of_cells[f], c));
        sums[f][0] += variation(along);
        sums[f][1] += variation(cells);
    }
}

// The means over the cells of the limit, of a mesh with one field.
std::vector<double> limit_means(const HexMesh& mesh) {
    constexpr std::array<double, 3> kAt{.1127016653792583, .5, .8872983346207417}, kWeight{5. / 18, 8. / 18, 5. / 18};
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t g = 0; g < 27; ++g) queries.push_back({c, {kAt[g % 3], kAt[g / 3 % 3], kAt[g / 9]}});
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.tolerance = 1e-4, .max_levels = 3});
    std::vector<double> means;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        double sum = 0, volume = 0;
        for (std::size_t g = 0; g < 27; ++g) {
            const double weight =
                kWeight[g % 3] * kWeight[g / 3 % 3] * kWeight[g / 9] * glm::determinant(samples.jacobians[27 * c + g]);
            sum += weight * samples.attributes[0].values[27 * c + g];
            volume += weight;
        }
        means.push_back(sum / volume);
    }
    return means;
}

// A field at the points of a file, whose limit is taken for the truth, by its means over the cells of the mesh and of the next
// level, which has the same limit.
void limit_field(const HexMesh& whole, const char* path) {
    HexMesh mesh = whole;
    mesh.attributes = {select_field(whole, {}).scalar};
    std::array<double, 3> last{};
    for (int level = 0; level < 2; ++level) {
        if (level > 0) mesh = refine(mesh, {.levels = 1});
        const auto [low, high] = std::ranges::minmax(mesh.attributes[0].values);
        std::vector<LimitQuery> queries;
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            for (const Vec3& at : {Vec3(.5, .5, .5), Vec3(.1, .3, .8), Vec3(0, .9, .4)}) queries.push_back({c, at});
        }
        const LimitOptions options{.tolerance = 1e-4, .max_levels = 3};
        const std::vector<double> truth = evaluate_limit(mesh, queries, options).attributes[0].values;
        const std::vector<Attribute> of_cells{{"f", 1, limit_means(mesh)}};
        for (std::size_t m = 0; m < kMethods.size(); ++m) {
            double seconds = 0, squares = 0;
            HexMesh bare = mesh;
            bare.attributes.clear();
            const HexMesh found = with_values(std::move(bare), kMethods[m], of_cells, {}, seconds);
            const std::vector<double> values = evaluate_limit(found, queries, options).attributes[0].values;
            for (std::size_t q = 0; q < values.size(); ++q) squares += std::pow(values[q] - truth[q], 2);
            const double off = std::sqrt(squares / static_cast<double>(values.size())) / (high - low);
            std::printf("%s, %s: %zu cells, %-6s off by %.2e of the range (rms), order %.1f\n", path,
                        whole.attributes.empty() ? "" : mesh.attributes[0].name.c_str(), mesh.cells.size(), kMethods[m], off,
                        last[m] > 0 ? std::log2(last[m] / off) : 0);
            last[m] = off;
        }
    }
}

void file_fields(const char* path) {
    const ReadResult read = read_mesh(path, {.cell_values = CellValues::Fit});
    if (read.cell_means.empty()) {
        limit_field(read.mesh, path);
        return;
    }
    const Topology topology = build_topology(read.mesh);
    HexMesh bare = read.mesh;
    bare.attributes.clear();
    for (const std::string method : {"mean", "exact", "fit", "meet", "normal"}) {
        double seconds = 0;
        const bool of_patches = method == "meet" || method == "normal";
        HexMesh mesh = with_values(bare, of_patches ? "fit" : method, read.cell_means, read.cell_parts, seconds);
        if (of_patches)
            meet_patch_values(mesh, read.on_patches, method == "meet" ? PatchValuesUse::Meet : PatchValuesUse::Normal);
        std::printf("%-6s %zu cells, %.2f us a cell\n", method.c_str(), mesh.cells.size(),
                    1e6 * seconds / static_cast<double>(mesh.cells.size()));
        const LimitEvaluator limit(mesh, {.tolerance = 1e-4, .max_levels = 3});
        std::vector<std::array<double, 2>> sums(read.cell_means.size());
        for (std::size_t r = 0; r < 48; ++r) {
            const auto cell = static_cast<Index>((r * 2654435761U) % mesh.cells.size());
            Row back = row_from(topology, cell, 2 * (r % 3));
            add_row(limit, row_from(topology, back.cells.back(), back.sides.back() ^ 1U), read.cell_means, sums);
        }
        std::vector<LimitQuery> centres;
        for (Index c = 0; c < mesh.cells.size(); ++c) centres.push_back({c, {.5, .5, .5}});
        const LimitSamples at_centres = limit.at(centres);
        for (std::size_t f = 0; f < sums.size(); ++f) {
            const Attribute values{"", read.cell_means[f].channels, at_centres.attributes[f].values};
            double squares = 0;
            for (std::size_t c = 0; c < centres.size(); ++c) {
                squares += std::pow(length_of(values, c) - length_of(read.cell_means[f], c), 2);
            }
            const auto [low, high] = std::ranges::minmax(values.values);
            const auto [least, most] = std::ranges::minmax(mesh.attributes[f].values);
            std::printf(
                "  %-12s variation %.3f of the cells', at centres off by %.3g (rms), %.4g to %.4g there, %.4g to %.4g at "
                "points\n",
                read.cell_means[f].name.c_str(), sums[f][0] / sums[f][1],
                std::sqrt(squares / static_cast<double>(centres.size())), low, high, least, most);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) known_fields();
    for (int i = 1; i < argc; ++i) file_fields(argv[i]);
}
