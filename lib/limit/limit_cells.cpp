// SPDX-License-Identifier: Apache-2.0
// The limit as pieces. All cells are refined once; those that are too coarse are refined again by way of their children, and
// each child as far as it needs. Every grid of nodes goes to a PieceCutter, which keeps the pieces that are fine enough:
//
//     cells ── level 1 ──► fine enough: pieces
//                └─ others ── level 2 ──► the cell, or some of its children
//                               └─ other children ── 2, 3 … levels of the child ──► the child, or parts of it
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <tuple>

#include "cell_refiner.h"
#include "piece_cutter.h"
#include "refine_steps.h"
#include "subvol/cell.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/limit_level.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMostSurfaceCells = 3e7;  // trilinear, were all cells refined to the surface's level

std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
    return hash ^ hash >> 29;
}

std::uint64_t hash_of(const HexMesh& mesh) {
    std::uint64_t hash = mesh.cells.size();
    for (const Vec3& p : mesh.points) {
        for (int d = 0; d < 3; ++d) hash = mixed(hash, std::bit_cast<std::uint64_t>(p[d]));
    }
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) hash = mixed(hash, p);
    }
    for (const auto& crease : mesh.creases) hash = mixed(mixed(hash, crease[0]), crease[1]);
    for (const auto& face : mesh.sharp_faces) {
        for (const Index p : face) hash = mixed(hash, p);
    }
    return hash;
}

std::uint64_t hash_of(const Attribute& attribute) {
    auto hash = static_cast<std::uint64_t>(attribute.channels);
    for (const double value : attribute.values) hash = mixed(hash, std::bit_cast<std::uint64_t>(value));
    return hash;
}

/// What one thread has found.
struct Found {
    PieceCutter cutter;
    PieceList list;
    std::size_t counted = 0;  // pieces
};

using FoundByThreads = tbb::enumerable_thread_specific<Found>;

class Search {
public:
    Search(const HexMesh& mesh, const RefineOptions& refinement, const LimitCellsOptions& options,
           const std::vector<double>& value_scales)
        : control_(control_mesh(mesh, refinement.scheme, 1)),
          refiner_(control_, refinement.scheme, true),
          options_(options),
          progress_(refinement.progress),
          found_([this, value_scales] {
              return Found{PieceCutter(value_scales, options_), {}, 0};
          }) {
        for (const Attribute& attribute : control_.attributes) node_size_ += static_cast<std::size_t>(attribute.channels);
    }

    void run() {
        refiner_.descend(options_.max_levels, progress_,
                         {.cell =
                              [&](const DenseCell& grid) {
                                  Found& found = found_.local();
                                  const bool more = !found.cutter.cut_cell(grid, options_.max_levels == 1, found.list);
                                  spare(found);
                                  return more;
                              },
                          .whole =
                              [&](const DenseCell& grid) {
                                  Found& found = found_.local();
                                  const std::uint8_t more = found.cutter.cut(grid, 0, {}, options_.max_levels <= 2, found.list);
                                  spare(found);
                                  return more;
                              },
                          .part =
                              [&](const DenseCell& grid, std::size_t child, int levels) {
                                  Found& found = found_.local();
                                  std::array<std::uint8_t, 3> lowest;
                                  for (std::size_t d = 0; d < 3; ++d)
                                      lowest[d] = static_cast<std::uint8_t>(kCornerParameters[child][d]);
                                  const std::size_t before = found.list.size();
                                  const bool more =
                                      found.cutter.cut(grid, 1, lowest, levels + 1 >= options_.max_levels, found.list) != 0;
                                  if (more) found.list.truncate(before);
                                  spare(found);
                                  return more;
                              }});
    }

    [[nodiscard]] LimitCells result(const HexMesh& mesh) {
        LimitCells cells{.cell_levels = std::vector<std::uint8_t>(control_.cells.size(), 1)};
        float trilinear = 0;
        for (const Found& found : found_) {
            for (std::size_t i = 0; i < found.list.size(); ++i) {
                auto& level = cells.cell_levels[found.list.cells[i]];
                level = std::max(level, static_cast<std::uint8_t>(found.list.levels[i] + 1));
                cells.position_world = std::max(cells.position_world, found.list.left[i].position);
                cells.value_of_range = std::max(cells.value_of_range, found.list.left[i].value);
                trilinear = std::max(trilinear, found.list.trilinear[i]);
            }
            cells.piece_count += found.list.size();
        }
        cells.converged = cells.position_world <= options_.position_world && cells.value_of_range <= options_.value_of_range;
        while (trilinear > static_cast<float>(cells.level) && cells.level < options_.max_levels &&
               std::ldexp(static_cast<double>(control_.cells.size()), 3 * (cells.level + 1)) <= kMostSurfaceCells) {
            ++cells.level;
        }
        if (pieces_ * bytes_of_piece() <= options_.max_bytes) cells.pieces = pieces_of(mesh, cells.piece_count);
        return cells;
    }

private:
    [[nodiscard]] std::size_t bytes_of_piece() const { return sizeof(Vec3) + LimitPieces::kNodes * node_size_ * sizeof(float); }

    /// Drops the nodes of pieces when there are too many to be kept.
    void spare(Found& found) {
        const std::size_t more = found.list.size() - found.counted;
        found.counted = found.list.size();
        if ((pieces_ += more) * bytes_of_piece() > options_.max_bytes && found.list.has_nodes) found.list.drop_nodes();
    }

    [[nodiscard]] std::shared_ptr<const LimitPieces> pieces_of(const HexMesh& mesh, std::size_t count) {
        std::vector<const PieceList*> lists;
        struct Place {
            Index cell;
            std::uint8_t level;
            std::array<std::uint8_t, 3> lowest;
            std::uint32_t list, number;
        };
        std::vector<Place> places;
        places.reserve(count);
        for (const Found& found : found_) {
            for (std::size_t i = 0; i < found.list.size(); ++i) {
                places.push_back({found.list.cells[i], found.list.levels[i], found.list.lowest[i],
                                  static_cast<std::uint32_t>(lists.size()), static_cast<std::uint32_t>(i)});
            }
            lists.push_back(&found.list);
        }
        tbb::parallel_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
            return std::tie(a.cell, a.level, a.lowest) < std::tie(b.cell, b.level, b.lowest);
        });
        auto pieces = std::make_shared<LimitPieces>();
        pieces->cells.resize(count);
        pieces->levels.resize(count);
        pieces->lowest.resize(count);
        pieces->origins.resize(count);
        pieces->node_size = node_size_;
        const std::size_t numbers = LimitPieces::kNodes * node_size_;
        pieces->nodes.resize(numbers * count);
        parallel_each(count, [&](std::size_t i) {
            const Place& place = places[i];
            const PieceList& from = *lists[place.list];
            pieces->cells[i] = place.cell;
            pieces->levels[i] = place.level;
            pieces->lowest[i] = place.lowest;
            pieces->origins[i] = from.origins[place.number];
            std::copy_n(&from.nodes[numbers * place.number], numbers, &pieces->nodes[numbers * i]);
        });
        pieces->mesh_hash = hash_of(mesh);
        for (const Attribute& attribute : mesh.attributes) {
            pieces->names.push_back(attribute.name);
            pieces->channels.push_back(attribute.channels);
            pieces->attribute_hashes.push_back(hash_of(attribute));
        }
        return pieces;
    }

    HexMesh control_;
    CellRefiner refiner_;
    const LimitCellsOptions& options_;
    Progress* progress_;
    std::size_t node_size_ = 3;
    std::atomic<std::size_t> pieces_{0};
    FoundByThreads found_;
};

}  // namespace

namespace {

LimitCells search(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options,
                  const std::function<std::vector<double>()>& scales) {
    const std::size_t count = mesh.cells.size();
    if (count == 0 || options.max_levels < 1) {
        return {.cell_levels = {}, .converged = count == 0};
    }
    validate(mesh);
    refinement.levels = 1;
    Search search(mesh, refinement, options, scales());
    search.run();
    return search.result(mesh);
}

}  // namespace

LimitCells find_limit_cells(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options) {
    return search(mesh, refinement, options, [&] { return value_scales(mesh); });
}

LimitCells detail::find_limit_cells(const HexMesh& part, RefineOptions refinement, const LimitCellsOptions& options,
                                    std::span<const std::array<double, 2>> ranges) {
    return search(part, refinement, options, [&] {
        std::vector<double> scales;
        for (std::size_t a = 0; a < part.attributes.size(); ++a) {
            scales.insert(scales.end(), static_cast<std::size_t>(part.attributes[a].channels),
                          value_scale(ranges[a][0], ranges[a][1]));
        }
        return scales;
    });
}

bool are_pieces_of(const LimitPieces& pieces, const HexMesh& mesh) {
    return pieces.mesh_hash == hash_of(mesh);
}

std::optional<std::size_t> place_in(const LimitPieces& pieces, const Attribute& attribute) {
    std::size_t first = 3;
    for (std::size_t a = 0; a < pieces.names.size(); ++a) {
        if (pieces.names[a] == attribute.name && pieces.attribute_hashes[a] == hash_of(attribute)) return first;
        first += static_cast<std::size_t>(pieces.channels[a]);
    }
    return {};
}

int finest_level(const LimitCells& limit) {
    int levels = limit.level;
    for (const int level : limit.cell_levels) levels = std::max(levels, level);
    return levels;
}

LimitCells limit_for_voxels(const HexMesh& mesh, const RefineOptions& refinement, double voxel_world) {
    return find_limit_cells(mesh, refinement, {.position_world = kLimitTolerance_voxels * voxel_world});
}

}  // namespace subvol
