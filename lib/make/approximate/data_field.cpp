// SPDX-License-Identifier: Apache-2.0
#include "data_field.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/topology.h"

namespace subvol::detail {

DataField::DataField(const HexMesh& data, const ApproximateOptions& options) : options_(options) {
    mesh_.points = data.points;
    mesh_.cells = data.cells;
    mesh_.creases = data.creases;
    mesh_.sharp_faces = data.sharp_faces;
    options_.progress = nullptr;
    if (!interpolates(options.scheme.kind)) options_.scheme = {.crease_angle_deg = options.scheme.crease_angle_deg};
    if (!has_cells()) return;
    validate(mesh_);
    if (options_.scheme.crease_angle_deg) tag_creases(mesh_, *options_.scheme.crease_angle_deg);
    options_.scheme.crease_angle_deg.reset();
}

std::vector<LimitQuery> DataField::find(std::span<const Vec3> positions, Progress* progress) const {
    std::vector<LimitQuery> places(positions.size(), {kNone, Vec3(0.0)});
    if (!has_cells() || positions.empty()) return places;
    const ProbeResult found = SampleFinder(mesh_, options_).at(positions, progress);
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = {found.cells[k], found.parameters[k]};
    return places;
}

std::vector<LimitQuery> DataField::spread(std::size_t count) const {
    return spread_places(mesh_.cells.size(), count);
}

std::vector<Vec3> DataField::positions(std::span<const LimitQuery> places) const {
    return limit_at(mesh_, places, {.scheme = options_.scheme}).positions;
}

std::vector<std::vector<double>> DataField::values(std::span<const Attribute> fields,
                                                   std::span<const LimitQuery> places) const {
    std::vector<std::vector<double>> values(fields.size());
    if (places.empty()) return values;
    HexMesh with_fields = mesh_;
    with_fields.attributes.assign(fields.begin(), fields.end());
    LimitSamples found = limit_at(with_fields, places, {.scheme = options_.scheme});
    for (std::size_t f = 0; f < values.size(); ++f) values[f] = std::move(found.attributes[f].values);
    return values;
}

LimitSamples limit_at(const HexMesh& mesh, std::span<const LimitQuery> places, const LimitOptions& options) {
    std::vector<std::uint8_t> kept(mesh.cells.size(), 0);
    for (const LimitQuery& place : places) kept[place.cell] = 1;
    constexpr std::ptrdiff_t kCellsAbout = 343;  // of a cell in a grid, with the halo
    if (std::ranges::count(kept, 1) * kCellsAbout > static_cast<std::ptrdiff_t>(mesh.cells.size()))
        return evaluate_limit(mesh, places, options);
    grow(mesh, kept, kHaloOfLimit);
    const MeshSubset part = subset(mesh, kept);
    std::vector<LimitQuery> in_part(places.begin(), places.end());
    for (LimitQuery& place : in_part)
        place.cell = static_cast<Index>(std::ranges::lower_bound(part.cells, place.cell) - part.cells.begin());
    return LimitEvaluator(part.mesh, options, limit_extent(mesh)).at(in_part);
}

std::vector<LimitQuery> spread_places(std::size_t cells, std::size_t count) {
    if (cells == 0) return {};
    constexpr std::size_t kMany = std::size_t{1} << 15, kSome = 256;
    const std::size_t used = cells > kMany ? kSome : std::min(cells, count);
    const std::size_t per_cell = std::max<std::size_t>(1, count / used), stride = (cells + used - 1) / used;
    std::vector<LimitQuery> places;
    // Multiples of the powers of the root of x⁴ = x + 1, modulo 1, are spread evenly in a cube.
    constexpr double kRoot = 1.2207440846057594753616853491;
    const Vec3 step(1 / kRoot, 1 / (kRoot * kRoot), 1 / (kRoot * kRoot * kRoot));
    for (std::size_t c = 0; c < cells; c += stride) {
        for (std::size_t k = 0; k < per_cell; ++k)
            places.push_back({static_cast<Index>(c), glm::fract(0.5 + static_cast<double>(places.size()) * step)});
    }
    return places;
}

}  // namespace subvol::detail
