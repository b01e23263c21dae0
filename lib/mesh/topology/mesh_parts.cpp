// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/mesh_parts.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kLeastPoints = std::size_t{1} << 14, kMostPoints = std::size_t{1} << 20;  // of a part
constexpr std::size_t kFewParts = 16, kMostParts = 250;

std::size_t part_count(std::size_t points) {
    const std::size_t size = std::clamp(points / kFewParts, kLeastPoints, kMostPoints);
    return std::clamp<std::size_t>(points / size, 1, kMostParts);
}

/// Slabs between equal numbers of points, where bins of equal width would put too many into one: a far cell makes them wide.
std::vector<std::uint8_t> slabs_by_rank(const HexMesh& mesh, std::size_t count, int axis) {
    std::vector<double> places(mesh.points.size());
    parallel_each(places.size(), [&](std::size_t p) {
        const double x = mesh.points[p][axis];
        places[p] = std::isfinite(x) ? x : 0;  // of an unused point
    });
    std::vector<double> ends, sorted = places;
    tbb::parallel_sort(sorted.begin(), sorted.end());
    for (std::size_t k = 1; k < count; ++k) ends.push_back(sorted[k * sorted.size() / count]);
    std::vector<std::uint8_t> slabs(places.size());
    parallel_each(slabs.size(), [&](std::size_t p) {
        slabs[p] = static_cast<std::uint8_t>(std::ranges::upper_bound(ends, places[p]) - ends.begin());
    });
    return slabs;
}

/// The slab of each point. The slabs divide the longest side of the box so that each has about as many points. Neighbouring
/// points are near each other in space, even if their numbers are not.
std::vector<std::uint8_t> slabs_of(const HexMesh& mesh, std::size_t count) {
    constexpr std::size_t kBins = std::size_t{1} << 16;
    const Box box = bounds(mesh);
    const Vec3 size = box.size();
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    const auto bin_of = [&](const Vec3& x) {
        const double along = (x[axis] - box.lower[axis]) / size[axis];
        return along > 0 ? static_cast<std::size_t>(std::min(along, 1.0) * (kBins - 1)) : 0;  // unused points may be anywhere
    };
    std::vector<std::size_t> first(kBins + 1, 0);
    parallel_each(mesh.points.size(), [&](std::size_t p) {
        std::atomic_ref(first[bin_of(mesh.points[p]) + 1]).fetch_add(1, std::memory_order_relaxed);
    });
    const bool crowded = *std::ranges::max_element(first) * count > mesh.points.size();
    if (crowded && count > 1) return slabs_by_rank(mesh, count, axis);
    for (std::size_t b = 0; b < kBins; ++b) first[b + 1] += first[b];
    std::vector<std::uint8_t> slabs(mesh.points.size());
    parallel_each(slabs.size(), [&](std::size_t p) {
        slabs[p] = static_cast<std::uint8_t>(first[bin_of(mesh.points[p])] * count / mesh.points.size());
    });
    return slabs;
}

class Parts {
public:
    explicit Parts(const HexMesh& mesh)
        : mesh_(mesh),
          count_(part_count(mesh.points.size())),
          slabs_(slabs_of(mesh, count_)),
          reach_(mesh.cells.size()),
          numbers_(mesh.points.size(), kNone) {
        parallel_each(reach_.size(), [&](std::size_t c) {
            const auto slab = [&](Index p) { return slabs_[p]; };
            const auto [low, high] = std::ranges::minmax(mesh_.cells[c], {}, slab);
            reach_[c] = {slabs_[low], slabs_[high]};
        });
    }

    [[nodiscard]] std::size_t count() const { return count_; }

    [[nodiscard]] MeshPart part(std::size_t slab) {
        HexMesh cut = cells_about(slab);
        MeshPart part;
        part.points = numbers_where<std::vector<Index>>(numbers_.size(), [&](std::size_t p) { return numbers_[p] != kNone; });
        part.own.resize(part.points.size());
        parallel_each(part.points.size(), [&](std::size_t i) {
            numbers_[part.points[i]] = static_cast<Index>(i);
            part.own[i] = slabs_[part.points[i]] == slab;
        });
        renumber(cut.cells);
        renumber(cut.creases);
        renumber(cut.sharp_faces);
        cut.points.resize(part.points.size());
        for (const Index p : part.points) numbers_[p] = kNone;
        part.topology = topology_of(cut);
        return part;
    }

private:
    /// The cells and tags with a point of the slab; marks the points of these cells in numbers_.
    [[nodiscard]] HexMesh cells_about(std::size_t slab) {
        const auto about = [&](const auto& entity) {
            return std::ranges::any_of(entity, [&](Index p) { return slabs_[p] == slab; });
        };
        HexMesh cut;
        const auto cells = numbers_where<std::vector<Index>>(reach_.size(), [&](std::size_t c) {
            return slab >= reach_[c][0] && slab <= reach_[c][1] && about(mesh_.cells[c]);
        });
        cut.cells.resize(cells.size());
        parallel_each(cells.size(), [&](std::size_t i) {
            cut.cells[i] = mesh_.cells[cells[i]];
            for (const Index p : cut.cells[i]) std::atomic_ref(numbers_[p]).store(0, std::memory_order_relaxed);
        });
        std::ranges::copy_if(mesh_.creases, std::back_inserter(cut.creases), about);
        std::ranges::copy_if(mesh_.sharp_faces, std::back_inserter(cut.sharp_faces), about);
        return cut;
    }

    template <class Entities>
    void renumber(Entities& entities) const {
        parallel_each(entities.size(), [&](std::size_t i) {
            for (Index& p : entities[i]) p = numbers_[p];
        });
    }

    [[nodiscard]] Topology topology_of(const HexMesh& cut) const {
        try {
            return build_topology(cut);
        } catch (const Error&) {
            std::ignore = build_topology(mesh_);  // throws with the numbers of the whole mesh
            throw;
        }
    }

    const HexMesh& mesh_;
    std::size_t count_;
    std::vector<std::uint8_t> slabs_;
    std::vector<std::array<std::uint8_t, 2>> reach_;  // the first and the last slab of each cell
    std::vector<Index> numbers_;                      // of the points in the part that is being made
};

}  // namespace

void each_part(const HexMesh& mesh, const std::function<void(const MeshPart&)>& visit) {
    Parts parts(mesh);
    for (std::size_t slab = 0; slab < parts.count(); ++slab) visit(parts.part(slab));
}

void each_part(const HexMesh& mesh, const Share& share, const std::function<void(const MeshPart&)>& visit) {
    Parts parts(mesh);
    const auto [begin, end] = share.range(parts.count());
    for (std::size_t slab = begin; slab < end; ++slab) visit(parts.part(slab));
}

}  // namespace subvol::detail
