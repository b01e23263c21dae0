// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "brick_file.h"
#include "brick_folder.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/option.h"

// A mesh in memory is cut by numbers alone: the brick of each cell is given, a point belongs to the brick of the first cell
// that has it, and a halo is grown from the owned cells layer by layer. Points and cells keep their order, so that sums over a
// brick have their terms in the order of the whole, and results its bits.

namespace subvol {

using namespace detail;

namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::uint64_t hash_of(const HexMesh& mesh, std::span<const std::uint32_t> brick_of_cell) {
    ByteHash hash;
    for (const std::string_view bytes :
         {bytes_of(mesh.points), bytes_of(mesh.cells), bytes_of(mesh.creases), bytes_of(mesh.sharp_faces)}) {
        hash.add(bytes);
    }
    for (const Attribute& field : mesh.attributes) {
        hash.add(field.name);
        hash.add(bytes_of(field.values));
        hash.add(bytes_of(field.bounds));
    }
    hash.add({reinterpret_cast<const char*>(brick_of_cell.data()), brick_of_cell.size_bytes()});
    return hash.value();
}

/// Takes bricks out of a mesh in memory.
class BrickTaker {
public:
    BrickTaker(const HexMesh& mesh, std::span<const std::uint32_t> brick_of_cell, std::size_t count)
        : mesh_(mesh),
          brick_of_cell_(brick_of_cell),
          owners_(mesh.points.size(), ~0U),
          of_brick_(count),
          places_(mesh.points.size(), kNone),
          at_points_(lists_at_points(mesh.cells, mesh.points.size())),
          seen_(mesh.cells.size(), 0) {
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            for (const Index p : mesh.cells[c]) {
                if (owners_[p] == ~0U) owners_[p] = brick_of_cell[c];
            }
            of_brick_[brick_of_cell[c]].push_back(c);
        }
    }

    [[nodiscard]] bool empty(std::size_t brick) const { return of_brick_[brick].empty(); }

    [[nodiscard]] MeshPiece take(std::size_t brick, int layers) {
        std::vector<Index> cells = of_brick_[brick];
        for (const Index c : cells) seen_[c] = 1;
        // Breadth first: cells from `from` on are the last layer, and their neighbours the next one.
        for (std::size_t from = 0; layers > 0; --layers) {
            const std::size_t end = cells.size();
            for (std::size_t i = from; i < end; ++i) {
                for (const Index p : mesh_.cells[cells[i]]) {
                    for (const Index c : at_points_[p]) {
                        if (seen_[c]) continue;
                        seen_[c] = 1;
                        cells.push_back(c);
                    }
                }
            }
            from = end;
        }
        std::ranges::sort(cells);
        return taken(brick, cells);
    }

private:
    [[nodiscard]] MeshPiece taken(std::size_t brick, const std::vector<Index>& cells) {
        MeshPiece part;
        std::vector<Index> points;
        for (const Index c : cells) {
            seen_[c] = 0;
            part.cell_numbers.push_back(c);
            part.owned_cells.push_back(brick_of_cell_[c] == brick);
            for (const Index p : mesh_.cells[c]) {
                // While points are collected, 0 marks those that are in the list; then each gets its place in the brick. kNone
                // is restored at the end, so that taking a brick costs no more than the brick.
                if (places_[p] == 0) continue;
                places_[p] = 0;
                points.push_back(p);
            }
        }
        std::ranges::sort(points);
        HexMesh& mesh = part.mesh;
        for (const Attribute& field : mesh_.attributes)
            mesh.attributes.push_back({field.name, field.channels, {}, field.bounds});
        for (Index i = 0; i < points.size(); ++i) {
            const Index p = points[i];
            places_[p] = i;
            mesh.points.push_back(mesh_.points[p]);
            part.point_numbers.push_back(p);
            part.owned_points.push_back(owners_[p] == brick);
            for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
                const Attribute& from = mesh_.attributes[a];
                const auto first = from.values.begin() + static_cast<std::ptrdiff_t>(p) * from.channels;
                mesh.attributes[a].values.insert(mesh.attributes[a].values.end(), first, first + from.channels);
            }
        }
        for (const Index c : cells) {
            auto& cell = mesh.cells.emplace_back(mesh_.cells[c]);
            for (Index& p : cell) p = places_[p];
        }
        const auto take_tags = [&](const auto& tags, auto& taken) {
            for (auto tag : tags) {
                // A crease or a sharp face can be stored only if all its points are in the brick.
                if (std::ranges::any_of(tag, [&](Index p) { return places_[p] == kNone; })) continue;
                for (Index& p : tag) p = places_[p];
                taken.push_back(tag);
            }
        };
        take_tags(mesh_.creases, mesh.creases);
        take_tags(mesh_.sharp_faces, mesh.sharp_faces);
        keep_own_tags(mesh);
        for (const Index p : points) places_[p] = kNone;
        return part;
    }

    const HexMesh& mesh_;
    std::span<const std::uint32_t> brick_of_cell_;
    std::vector<std::uint32_t> owners_;         // of points: the brick of the first cell
    std::vector<std::vector<Index>> of_brick_;  // cells
    std::vector<Index> places_;                 // of points in the brick that is being taken
    IndexRows at_points_;                       // cells
    std::vector<std::uint8_t> seen_;            // cells of it
};

}  // namespace

SplitResult split_mesh(const std::filesystem::path& folder, HexMesh mesh, std::span<const std::uint32_t> brick_of_cell,
                       const SplitOptions& options) {
    check_options(options);
    validate(mesh);
    mesh = without_unused_points(std::move(mesh));
    mesh.attributes = detail::without_functions(std::move(mesh.attributes));
    std::erase_if(mesh.attributes, [](const Attribute& field) { return field.name == kNodeNumbers || field.name == kGhosts; });
    if (brick_of_cell.size() != mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, "there are bricks for " + std::to_string(brick_of_cell.size()) + " cells", {},
                    "the mesh has " + std::to_string(mesh.cells.size()));
    }
    const std::size_t count = std::size_t{std::ranges::max(brick_of_cell)} + 1;
    if (count > kMostBricks) throw Error(ErrorCode::InvalidInput, "there are more than a million bricks");
    BricksWriter writer(folder, hash_of(mesh, brick_of_cell), options.halo_layers);
    BrickTaker taker(mesh, brick_of_cell, count);
    for (std::size_t k = 0; k < count; ++k) {
        report_progress(options.progress, "split", k, count);
        if (!taker.empty(k) && !writer.keeps(k)) writer.write(k, taker.take(k, options.halo_layers));
    }
    report_progress(options.progress, "split", 1);
    return writer.finish();
}

SplitResult split_mesh(const std::filesystem::path& folder, HexMesh mesh, const SplitOptions& options) {
    const std::vector<std::uint32_t> bricks = bricks_of_cells(mesh, options);
    return split_mesh(folder, std::move(mesh), bricks, options);
}

}  // namespace subvol
