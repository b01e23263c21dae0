// SPDX-License-Identifier: Apache-2.0
// The plane is a region of almost no width: what lies between two half spaces. Its extremes are found as those of any other
// region, in pieces of those cells about the plane that may go beyond the picture's values, and then followed in the limit:
//
//     ── half ──   pieces within 1e-4 of the range    ──►  the best place  ──►  8 places around it on the plane, nearer and
//     ── half ──                                                                nearer, in the limit
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "box_polynomial.h"
#include "given_figures.h"
#include "region_extremes.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/piece_tree.h"
#include "subvol/measure.h"
#include "subvol/part_places.h"
#include "subvol/probe.h"

namespace subvol {
namespace {

bool crosses(const Box& box, const Vec3& point, const Vec3& normal) {
    const Vec3 half = 0.5 * box.size();
    const double reach = std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
    return std::abs(glm::dot(box.center() - point, normal)) <= reach;
}

/// right, down: of length 1, at right angles
struct SlicePlane {
    Vec3 origin, right, down;
};

/// The best of the places around the best one on the plane, again and again, in steps that become shorter.
class PlaneClimb {
public:
    /// cells: a flag for each cell of the probe's mesh that counts
    PlaneClimb(const LimitProbe& probe, std::span<const std::uint8_t> cells, const Vec3& right, const Vec3& down)
        : probe_(probe), cells_(cells), right_(right), down_(down) {}

    /// Places of other cells are outside.
    [[nodiscard]] ProbeResult at(std::span<const Vec3> places) const {
        ProbeResult found = probe_.at(places);
        keep_places_in(probe_.mesh(), cells_, found);
        return found;
    }

    /// sign: 1 for the largest value, −1 for the least; value, place: the best so far; step: world
    void climb(double sign, double& value, Vec3& place, double step) const {
        constexpr int kRounds = 40;
        constexpr double kShortest = 1e-4;  // of the first step
        double length = step;
        for (int round = 0; round < kRounds && length > kShortest * step; ++round) {
            std::vector<Vec3> places;
            for (int n = 0; n < 9; ++n) places.push_back(place + length * ((n % 3 - 1.0) * right_ + (n / 3 - 1.0) * down_));
            const ProbeResult found = at(places);
            bool is_better = false;
            for (std::size_t n = 0; n < places.size(); ++n) {
                if (!found.inside(n) || sign * found.fields[0].values[n] <= sign * value) continue;
                value = found.fields[0].values[n];
                place = places[n];
                is_better = true;
            }
            if (!is_better) length /= 3;
        }
    }

private:
    const LimitProbe& probe_;
    std::span<const std::uint8_t> cells_;
    Vec3 right_, down_;  // of length 1
};

/// Some cells of a mesh with layers of others around them.
struct CellsWithHalo {
    detail::MeshSubset part;
    std::vector<Index> inner;  ///< the numbers of the cells in the part, ascending

    /// cells: a flag for each cell of the mesh
    CellsWithHalo(const HexMesh& mesh, const std::vector<std::uint8_t>& cells, int layers) {
        std::vector<std::uint8_t> grown = cells;
        detail::grow(mesh, grown, layers);
        part = detail::subset(mesh, grown);
        for (std::size_t c = 0; c < part.cells.size(); ++c) {
            if (cells[part.cells[c]] != 0) inner.push_back(static_cast<Index>(c));
        }
    }
};

/// Leaves those of some cells in which the limit may go beyond the values that are known.
///
/// cells:  a flag for each cell
/// ranges: of the field
void keep_cells_beyond(const HexMesh& chosen, const RefineOptions& refinement, std::span<const std::array<double, 2>> ranges,
                       const SliceExtremes& known, std::vector<std::uint8_t>& cells) {
    if (std::isnan(known.min.value) || std::isnan(known.max.value)) return;
    constexpr double kTolerance = 1e-2;
    const CellsWithHalo around(chosen, cells, detail::kHaloOfLimit);
    const LimitCells limit =
        detail::find_limit_cells(around.part.mesh, around.inner, refinement,
                                 {.position_world = HUGE_VAL, .value_of_range = kTolerance, .max_levels = 4}, ranges);
    if (!limit.pieces) return;
    // At kinks of the limit three times as much may be left.
    const double margin = 3 * std::max(kTolerance, limit.value_of_range) * (ranges.front()[1] - ranges.front()[0]);
    const LimitPieces& pieces = *limit.pieces;
    std::ranges::fill(cells, 0);
    for (std::size_t p = 0; p < pieces.cells.size(); ++p) {
        detail::BoxPolynomial values;
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = pieces.value(p, n, 0);
        const detail::BoxPolynomial coefficients = detail::polynomial_through(values);
        const auto [least, most] = std::ranges::minmax(coefficients);
        if (least - margin < known.min.value || most + margin > known.max.value) cells[around.part.cells[pieces.cells[p]]] = 1;
    }
}

/// The extremes on a plane, which begin with those that are known.
///
/// chosen:  with the field alone
/// of_part: a flag for each cell that counts; empty: all
void find_on_plane(const HexMesh& chosen, const SlicePlane& plane, const LimitOptions& options,
                   std::span<const std::uint8_t> of_part, SliceExtremes& known) {
    constexpr double kTolerance = 1e-4, kWidth = 1e-9;
    const Attribute& field = chosen.attributes.front();
    const detail::LimitExtent extent = detail::limit_extent(chosen);
    const auto& [low, high] = extent.ranges.front();
    const double diagonal = bounds(chosen).diagonal(), range = high - low;
    if (!(range > 0)) return;
    const Vec3 normal = glm::cross(plane.right, plane.down);
    const detail::CellReaches reaches(chosen);
    std::vector<std::uint8_t> wanted(chosen.cells.size(), 0);
    for (std::size_t c = 0; c < wanted.size(); ++c)
        wanted[c] = (of_part.empty() || of_part[c] != 0) && crosses(reaches(c), plane.origin, normal) ? 1 : 0;
    const RefineOptions refinement{.scheme = options.scheme, .progress = options.progress};
    keep_cells_beyond(chosen, refinement, extent.ranges, known, wanted);
    // Places are looked for in the cells beside those that are wanted, too.
    const CellsWithHalo around(chosen, wanted, 1 + detail::kHaloOfLimit);
    const detail::MeshSubset& part = around.part;
    const LimitCells limit = detail::find_limit_cells(
        part.mesh, around.inner, refinement,
        {.position_world = kTolerance * diagonal, .value_of_range = kTolerance, .max_levels = 4}, extent.ranges);
    if (!limit.pieces) return;
    const Vec3 little = kWidth * diagonal * normal;
    const std::array<Region, 2> slab{half_space(plane.origin - little, normal), half_space(plane.origin + little, -normal)};

    const LimitProbe probe(part.mesh, {.limit = options});
    std::vector<std::uint8_t> counts;
    for (const Index cell : part.cells) counts.push_back(wanted[cell]);
    const PlaneClimb climber(probe, counts, plane.right, plane.down);
    for (const double sign : {-1.0, 1.0}) {
        LimitExtreme& best = sign > 0 ? known.max : known.min;
        double& value = best.value;
        Vec3& place = best.place;
        detail::RegionExtreme extreme;
        extreme.sign = sign;
        if (!field.bounds.empty()) extreme.limit = sign > 0 ? field.bounds[0][1] : -field.bounds[0][0];
        extreme.best.value = -sign * HUGE_VAL;
        detail::find_extreme(*limit.pieces, slab, {}, kTolerance * range, extreme);
        double piece = diagonal / 64;
        Vec3 start = place;
        double found = value;
        if (extreme.best.cell != kNone) {
            const Vec3& at = extreme.best.place;
            start = at - glm::dot(at - plane.origin, normal) * normal;
            const ProbeResult there = climber.at(std::array{start});
            found = there.inside(0) ? there.fields[0].values[0] : std::isnan(value) ? extreme.best.value : -sign * HUGE_VAL;
            Box box;
            for (const Index p : part.mesh.cells[extreme.best.cell]) box.add(part.mesh.points[p]);
            piece = box.diagonal() / 16;
        }
        if (!(sign * found <= sign * value)) {
            value = found;
            place = start;
        }
        if (std::isnan(value)) continue;  // the plane misses the cells
        climber.climb(sign, value, place, piece);
        const ProbeResult there = climber.at(std::array{place});
        best.cell = there.inside(0) ? part.cells[there.cells[0]] : kNone;
        if (there.inside(0)) best.uvw = there.parameters[0];
    }
}

/// Whether some of the corners lie on either side of a plane.
bool cuts(const HexMesh& mesh, const std::array<Index, 8>& cell, const SlicePlane& plane) {
    const Vec3 normal = glm::cross(plane.right, plane.down);
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const Index p : cell) {
        const double height = glm::dot(mesh.points[p] - plane.origin, normal);
        least = std::min(least, height);
        most = std::max(most, height);
    }
    return least <= 0 && most >= 0;
}

/// The least and the largest value of the cells that a plane cuts, of a field that is constant in each. of_part: as above
SliceExtremes of_cut_cells(const HexMesh& mesh, const Attribute& field, const SlicePlane& plane,
                           std::span<const std::uint8_t> of_part) {
    SliceExtremes found{{.value = HUGE_VAL}, {.value = -HUGE_VAL}};
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if ((!of_part.empty() && of_part[c] == 0) || !cuts(mesh, mesh.cells[c], plane)) continue;
        Vec3 middle(0.0);
        for (const Index p : mesh.cells[c]) middle += mesh.points[p] / 8.0;
        const LimitExtreme here{field.cells[c], middle, static_cast<Index>(c), Vec3(0.5)};
        if (here.value < found.min.value) found.min = here;
        if (here.value > found.max.value) found.max = here;
    }
    if (found.min.cell == kNone) return {};  // it misses them
    return found;
}

}  // namespace

SliceExtremes find_slice_extremes(const HexMesh& mesh, LimitSlice& slice, const LimitOptions& options,
                                  std::span<const std::uint8_t> of_part) {
    const SlicePlane plane{slice.origin, glm::normalize(slice.right), glm::normalize(slice.down)};
    const HexMesh chosen = with_scalar_field(mesh, slice.field);
    SliceExtremes limit{{.value = slice.min, .place = slice.min_at}, {.value = slice.max, .place = slice.max_at}};
    find_on_plane(chosen, plane, options, of_part, limit);
    slice.min = limit.min.value;
    slice.min_at = limit.min.place;
    slice.max = limit.max.value;
    slice.max_at = limit.max.place;

    SliceExtremes given;
    const HexMesh cells = detail::as_given(chosen);
    const Attribute& field = cells.attributes.front();
    if (field.derived) return given;
    if (field.constant) return of_cut_cells(cells, field, plane, of_part);
    const auto [least, most] = std::ranges::minmax(field.values);
    if (least == most) return {{.value = least, .place = slice.min_at}, {.value = most, .place = slice.max_at}};
    find_on_plane(cells, plane, {.scheme = {.kind = Scheme::Linear}, .progress = options.progress}, of_part, given);
    return given;
}

namespace {

using Probing = std::function<ProbeResult(std::span<const Vec3> places)>;

/// The limit of a mesh near a plane, at places on it. field: its only one; of_part: a flag for each cell that counts; empty:
/// all
Probing probing_near(const HexMesh& mesh, const LimitSlice& slice, const LimitOptions& options,
                     std::span<const std::uint8_t> of_part) {
    const detail::CellReaches reaches(mesh);
    const Vec3 normal = glm::normalize(glm::cross(slice.right, slice.down));
    std::vector<std::uint8_t> near(mesh.cells.size(), 0);
    for (std::size_t c = 0; c < near.size(); ++c) near[c] = crosses(reaches(c), slice.origin, normal) ? 1 : 0;
    detail::grow(mesh, near, detail::kHaloOfLimit);
    detail::MeshSubset part = detail::subset(mesh, near);
    std::vector<std::uint8_t> counts;
    for (const Index cell : part.cells) {
        if (!of_part.empty()) counts.push_back(of_part[cell]);
    }
    const auto probe = std::make_shared<LimitProbe>(std::move(part.mesh), ProbeOptions{.limit = options});
    return [probe, counts, progress = options.progress](std::span<const Vec3> places) {
        ProbeResult found = probe->at(places, progress);
        if (!counts.empty()) keep_places_in(probe->mesh(), counts, found);
        return found;
    };
}

/// changed: makes the mesh that is probed, with one field, of that of the source
Probing probing_of(const MeshSource& source, const std::function<HexMesh(const HexMesh&)>& changed, const LimitSlice& slice,
                   const LimitOptions& options, std::span<const std::uint8_t> of_part) {
    if (const HexMesh* mesh = source.mesh()) return probing_near(changed(*mesh), slice, options, of_part);
    return [pieces = source.changed(changed), options](std::span<const Vec3> places) {
        return probe_limit(pieces, places, {.limit = options}, options.progress);
    };
}

/// Sums over the squares of a slice.
class SliceSums {
public:
    explicit SliceSums(const LimitSlice& slice) : slice_(slice), width_(static_cast<std::size_t>(slice.width)) {}

    /// values, cells: of the places of the slice, row by row
    [[nodiscard]] SliceFigures figures(std::span<const double> values, std::span<const Index> cells, const Probing& probe) {
        std::vector<std::size_t> rim;
        SliceFigures figures;
        for (std::size_t p = 0; p < cells.size(); ++p) {
            if (cells[p] != kNone) {
                const LimitExtreme here{values[p], place(p), cells[p], Vec3(0.5)};
                if (!(here.value >= figures.min.value)) figures.min = here;
                if (!(here.value <= figures.max.value)) figures.max = here;
            }
            if (is_at_rim(cells, p)) {
                rim.push_back(p);
            } else if (cells[p] != kNone) {
                add(values[p], 1);
            }
        }
        constexpr std::size_t kAtOnce = 4096;  // squares
        std::vector<Vec3> places;
        for (std::size_t first = 0; first < rim.size(); first += kAtOnce) {
            places.clear();
            for (std::size_t i = first; i < std::min(first + kAtOnce, rim.size()); ++i) {
                for (int n = 0; n < 16; ++n) {
                    places.push_back(place(rim[i]) + (n % 4 - 1.5) / 4 * slice_.right + (n / 4 - 1.5) / 4 * slice_.down);
                }
            }
            const ProbeResult found = probe(places);
            for (std::size_t q = 0; q < places.size(); ++q) {
                if (found.inside(q)) add(found.fields.front().values[q], 1. / 16);
            }
        }
        figures.area = squares_ * glm::length(slice_.right) * glm::length(slice_.down);
        if (squares_ > 0) figures.mean = origin_ + sum_ / squares_;
        return figures;
    }

private:
    [[nodiscard]] Vec3 place(std::size_t p) const {
        return slice_.place(static_cast<double>(p % width_), static_cast<double>(p / width_));
    }

    /// Whether a square beside this one is on the other side of the rim. Beyond the picture there is nothing.
    [[nodiscard]] bool is_at_rim(std::span<const Index> cells, std::size_t p) const {
        const bool inside = cells[p] != kNone;
        const auto differs = [&](bool is_there, std::size_t q) { return (is_there && cells[q] != kNone) != inside; };
        return differs(p % width_ > 0, p - 1) || differs(p % width_ + 1 < width_, p + 1) || differs(p >= width_, p - width_) ||
               differs(p + width_ < cells.size(), p + width_);
    }

    void add(double value, double weight) {
        if (squares_ == 0) origin_ = value;  // so that the sum keeps its digits
        squares_ += weight;
        sum_ += weight * (value - origin_);
    }

    const LimitSlice& slice_;
    std::size_t width_;
    double squares_ = 0, sum_ = 0, origin_ = 0;
};

}  // namespace

SliceFigures figures_of(const MeshSource& source, const LimitSlice& slice, const LimitOptions& options,
                        std::span<const std::uint8_t> cells) {
    const auto field = [&](const HexMesh& mesh) { return with_scalar_field(mesh, slice.field); };
    return SliceSums(slice).figures(slice.values, slice.cells, probing_of(source, field, slice, options, cells));
}

SliceFigures given_figures_of(const MeshSource& source, const LimitSlice& slice, std::span<const std::uint8_t> cells,
                              Progress* progress) {
    bool derived = false;
    const auto given = [&](const HexMesh& mesh) {
        HexMesh chosen = detail::as_given(with_scalar_field(mesh, slice.field));
        derived = chosen.attributes.front().derived;
        return chosen;
    };
    const Probing probe = probing_of(source, given, slice, {.scheme = {.kind = Scheme::Linear}, .progress = progress}, cells);
    constexpr std::size_t kAtOnce = 1 << 16;  // places
    std::vector<double> values;
    std::vector<Index> cells_at;
    std::vector<Vec3> places;
    for (int row = 0; row < slice.height; ++row) {
        for (int column = 0; column < slice.width; ++column) places.push_back(slice.place(column, row));
        if (places.size() < kAtOnce && row + 1 < slice.height) continue;
        const ProbeResult found = probe(places);
        values.insert(values.end(), found.fields.front().values.begin(), found.fields.front().values.end());
        cells_at.insert(cells_at.end(), found.cells.begin(), found.cells.end());
        places.clear();
    }
    const SliceFigures figures = SliceSums(slice).figures(values, cells_at, probe);
    if (!derived) return figures;
    SliceFigures area;
    area.area = figures.area;
    return area;
}

}  // namespace subvol
