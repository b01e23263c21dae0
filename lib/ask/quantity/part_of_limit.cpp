// SPDX-License-Identifier: Apache-2.0
#include "subvol/part_of_limit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/refine.h"
#include "subvol/region.h"

namespace subvol {
namespace {

using Edge = std::array<Index, 2>;

Edge edge_of(Index a, Index b) {
    return {std::min(a, b), std::max(a, b)};
}

/// What an edge belongs to.
enum class EdgeUse : std::uint8_t { CellOfPart, OtherCell, Boundary, Cut };

/// The points that cells of a part share with other cells. flags: a flag for each cell
std::vector<std::uint8_t> points_at_cut(const HexMesh& mesh, std::span<const std::uint8_t> flags) {
    constexpr std::uint8_t kPart = 1, kOther = 2;
    std::vector<std::uint8_t> points(mesh.points.size(), 0);
    for (std::size_t c = 0; c < flags.size(); ++c) {
        for (const Index p : mesh.cells[c]) points[p] |= flags[c] != 0 ? kPart : kOther;
    }
    for (std::uint8_t& point : points) point = point == (kPart | kOther) ? 1 : 0;
    return points;
}

bool has_one_of(const std::array<Index, 8>& cell, std::span<const std::uint8_t> points) {
    return std::ranges::any_of(cell, [&](Index p) { return points[p] != 0; });
}

/// A side of a cell, by its points in ascending order.
struct Side {
    std::array<Index, 4> points;
    Index cell;
    std::size_t number;

    bool operator<(const Side& other) const { return points < other.points; }
};

/// The edges that a part gets where it is cut out: those at which its boundary bends in the limit of the whole mesh, or ends at
/// that of the whole. Inside, the cells around an edge are alike in the limit, so that the boundary goes on smoothly where the
/// part has half of them, side by side. Edges of a single cell are sharp without a tag. A cut along sharp faces changes
/// nothing.
///
/// points: those of `points_at_cut`
std::vector<Edge> edges_of_cut(const HexMesh& mesh, std::span<const std::uint8_t> flags, std::span<const std::uint8_t> points) {
    std::vector<std::array<Index, 4>> sharp = mesh.sharp_faces;
    for (auto& face : sharp) std::ranges::sort(face);
    std::sort(sharp.begin(), sharp.end());
    std::vector<Side> sides;
    std::vector<std::pair<Edge, EdgeUse>> uses;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (!has_one_of(mesh.cells[c], points)) continue;
        const auto& corners = mesh.cells[c];
        for (const auto& [a, b] : kCellEdges)
            uses.emplace_back(edge_of(corners[a], corners[b]), flags[c] != 0 ? EdgeUse::CellOfPart : EdgeUse::OtherCell);
        for (std::size_t s = 0; s < kCellFaces.size(); ++s) {
            Side side{{}, c, s};
            for (std::size_t k = 0; k < 4; ++k) side.points[k] = corners[kCellFaces[s][k]];
            std::ranges::sort(side.points);
            sides.push_back(side);
        }
    }
    std::stable_sort(sides.begin(), sides.end());
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
        while (last < sides.size() && sides[last].points == sides[first].points) ++last;
        const bool hull = last - first == 1;
        const bool cut = last - first == 2 && flags[sides[first].cell] != flags[sides[first + 1].cell];
        const bool boundary = hull || std::binary_search(sharp.begin(), sharp.end(), sides[first].points);
        if (!boundary && !cut) continue;
        const auto& corners = mesh.cells[sides[first].cell];
        const auto& around = kCellFaces[sides[first].number];
        for (std::size_t k = 0; k < 4; ++k)
            uses.emplace_back(edge_of(corners[around[k]], corners[around[(k + 1) % 4]]),
                              boundary ? EdgeUse::Boundary : EdgeUse::Cut);
    }
    std::sort(uses.begin(), uses.end());
    std::vector<Edge> edges;
    for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
        std::array<std::size_t, 4> count{};
        for (; last < uses.size() && uses[last].first == uses[first].first; ++last)
            ++count[static_cast<std::size_t>(uses[last].second)];
        const auto [of_part, others, boundary, cut] = count;
        const bool runs_on = boundary == 0 && of_part == others && cut == 2;
        if (cut > 0 && of_part > 1 && !runs_on) edges.push_back(uses[first].first);
    }
    return edges;
}

/// Tags the descendants of some edges of a mesh in the cells that were refined.
///
/// numbers: of the mesh's cells that `fine` has the descendants of
void tag_descendants(const HexMesh& mesh, std::span<const Edge> edges, std::span<const Index> numbers, int levels,
                     HexMesh& fine) {
    const auto halves = std::size_t{1} << static_cast<unsigned>(levels);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        const auto& corners = mesh.cells[numbers[n]];
        for (const auto& ends : kCellEdges) {
            if (!std::binary_search(edges.begin(), edges.end(), edge_of(corners[ends[0]], corners[ends[1]]))) continue;
            for (std::size_t path = 0; path < halves; ++path) {
                std::size_t cell = n;  // a child at one of the edge's ends, and so on
                for (int level = 0; level < levels; ++level) cell = 8 * cell + ends[path >> static_cast<unsigned>(level) & 1U];
                fine.creases.push_back(edge_of(fine.cells[cell][ends[0]], fine.cells[cell][ends[1]]));
            }
        }
    }
    std::sort(fine.creases.begin(), fine.creases.end());
    fine.creases.erase(std::unique(fine.creases.begin(), fine.creases.end()), fine.creases.end());
}

std::array<Vec3, 8> corners_of(const HexMesh& mesh, std::size_t cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[cell][k]];
    return corners;
}

double volume_of(const HexMesh& mesh) {
    double sum = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) sum += cell_volume(corners_of(mesh, c));
    return sum;
}

/// Compares the part with the same cells of the whole mesh, both on the limit.
void compare(const HexMesh& whole, const HexMesh& own, std::span<const std::array<double, 2>> ranges, PartOfLimit& part) {
    for (std::size_t c = 0; c < whole.cells.size(); ++c) {
        for (std::size_t k = 0; k < 8; ++k) {
            const Index a = whole.cells[c][k], b = own.cells[c][k];
            part.distance_world = std::max(part.distance_world, glm::distance(whole.points[a], own.points[b]));
            for (std::size_t f = 0; f < ranges.size(); ++f) {
                const double range = ranges[f][1] - ranges[f][0];
                if (!(range > 0) || whole.attributes[f].constant) continue;
                const auto channels = static_cast<std::size_t>(whole.attributes[f].channels);
                for (std::size_t i = 0; i < channels; ++i) {
                    const double change =
                        whole.attributes[f].values[a * channels + i] - own.attributes[f].values[b * channels + i];
                    part.field_change = std::max(part.field_change, std::abs(change) / range);
                }
            }
        }
    }
    part.volume_change = volume_of(own) - volume_of(whole);
}

}  // namespace

HexMesh only_cells(const HexMesh& mesh, std::span<const std::uint8_t> cells) {
    detail::MeshSubset part = detail::subset(mesh, cells);
    tag_descendants(mesh, edges_of_cut(mesh, cells, points_at_cut(mesh, cells)), part.cells, 0, part.mesh);
    return std::move(part.mesh);
}

HexMesh refined_part(const HexMesh& mesh, std::span<const std::uint8_t> cells, const RefineOptions& options, bool on_limit) {
    std::vector<Index> numbers;
    for (Index c = 0; c < cells.size(); ++c) {
        if (cells[c] != 0) numbers.push_back(c);
    }
    HexMesh fine = on_limit ? detail::limit_of_cells(mesh, numbers, options) : refine_cells(mesh, numbers, options);
    tag_descendants(mesh, edges_of_cut(mesh, cells, points_at_cut(mesh, cells)), numbers, options.levels, fine);
    return fine;
}

PartWithHalo part_with_halo(const HexMesh& mesh, std::span<const std::uint8_t> cells) {
    std::vector<std::uint8_t> kept(cells.begin(), cells.end());
    detail::grow(mesh, kept, detail::kHaloOfLimit);
    detail::MeshSubset near = detail::subset(mesh, kept);
    for (Index& cell : near.cells) {
        if (cells[cell] == 0) cell = kNone;
    }
    return {std::move(near.mesh), std::move(near.cells)};
}

PartOfLimit part_of_limit(const HexMesh& mesh, std::span<const std::uint8_t> cells, const PartOptions& options) {
    if (cells.size() != mesh.cells.size() || !(options.tolerance > 0) || !(options.field_tolerance > 0) ||
        options.max_levels < 0 || options.max_levels > 4) {
        throw Error(ErrorCode::InvalidInput, "the flags of cells or the options of a part are wrong", "part_of_limit",
                    "a flag for each cell, tolerances above 0, and 0 to 4 levels");
    }
    detail::MeshSubset taken = detail::subset(mesh, cells);
    const std::vector<std::uint8_t> points = points_at_cut(mesh, cells);
    tag_descendants(mesh, edges_of_cut(mesh, cells, points), taken.cells, 0, taken.mesh);
    PartOfLimit part;
    part.mesh = std::move(taken.mesh);
    std::vector<Index> at_cut, places;  // cells, and where they are in the part
    for (Index place = 0; place < taken.cells.size(); ++place) {
        if (!has_one_of(mesh.cells[taken.cells[place]], points)) continue;
        at_cut.push_back(taken.cells[place]);
        places.push_back(place);
    }
    if (at_cut.empty()) return part;
    const HexMesh whole = detail::with_arguments(mesh);
    const std::vector<std::array<double, 2>> ranges = detail::limit_extent(whole).ranges;
    const double allowed = options.tolerance * bounds(part.mesh).diagonal();
    const double volume = std::abs(volume_of(part.mesh));
    while (true) {
        const Index descendants = Index{1} << static_cast<unsigned>(3 * part.levels);
        std::vector<Index> fine;
        for (const Index place : places) {
            for (Index d = 0; d < descendants; ++d) fine.push_back(place * descendants + d);
        }
        RefineOptions refinement{.scheme = options.scheme, .levels = part.levels + 1, .progress = options.progress};
        const HexMesh there = detail::limit_of_cells(whole, at_cut, refinement);
        refinement.levels = 1;
        part.distance_world = part.field_change = 0;
        compare(there, detail::limit_of_cells(detail::with_arguments(part.mesh), fine, refinement), ranges, part);
        part.volume_change = volume > 0 ? part.volume_change / volume : 0;
        const bool near = part.distance_world <= allowed && part.field_change <= options.field_tolerance;
        if (near || part.levels == options.max_levels || 8 * part.mesh.cells.size() > options.max_cells) return part;
        ++part.levels;
        refinement.levels = part.levels;
        part.mesh = refined_part(mesh, cells, refinement);
    }
}

std::string detail::part_words(const PartOfLimit& part) {
    const auto percent = [](double of) { return number_text(100 * std::abs(of), 2) + " %"; };
    const double size = bounds(part.mesh).diagonal();
    return "near the cut the part lies up to " + number_text(part.distance_world, 3) + " (" +
           percent(part.distance_world / size) + " of its size) from where it is in the whole, its volume differs by " +
           percent(part.volume_change) + ", and a field by up to " + percent(part.field_change) + " of its range";
}

std::string detail::part_warning(const PartOfLimit& part, OptionNames names) {
    constexpr double kWorthSaying = 0.01;
    const bool far = part.distance_world > kWorthSaying * bounds(part.mesh).diagonal();
    if (!far && std::abs(part.volume_change) <= kWorthSaying) return "";
    return part_words(part) + (names == OptionNames::Flags
                                   ? ": vdb, probe, slice and surface --boundary take it out of the whole itself"
                                   : ": only(levels=2) refines it, and measure(only=) takes it out of the whole itself");
}

}  // namespace subvol
