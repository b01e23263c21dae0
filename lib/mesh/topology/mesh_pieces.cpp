// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/mesh_pieces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kWiden = 0.25;

}  // namespace

CellReaches::CellReaches(const HexMesh& mesh) : mesh_(mesh), about_(mesh.points.size()) {
    for (const auto& cell : mesh.cells) {
        Box box;
        for (const Index p : cell) box.add(mesh.points[p]);
        for (const Index p : cell) about_[p].add(box);
    }
}

Box CellReaches::operator()(std::size_t cell) const {
    Box box;
    for (const Index p : mesh_.cells[cell]) box.add(about_[p]);
    const Vec3 more = kWiden * box.size();
    return {box.lower - more, box.upper + more};
}

bool touch(const Box& a, const Box& b) {
    for (int d = 0; d < 3; ++d) {
        if (!(a.lower[d] <= b.upper[d] && b.lower[d] <= a.upper[d])) return false;
    }
    return true;
}

MeshPiece subset(const MeshPiece& part, std::span<const std::uint8_t> cells) {
    MeshSubset some = subset(part.mesh, cells);
    MeshPiece result;
    result.mesh = std::move(some.mesh);
    for (const Index c : some.cells) {
        result.cell_numbers.push_back(part.cell_numbers[c]);
        result.owned_cells.push_back(part.owned_cells[c]);
    }
    for (const Index p : some.points) {
        result.point_numbers.push_back(part.point_numbers[p]);
        result.owned_points.push_back(part.owned_points[p]);
    }
    return result;
}

MeshPiece merged(std::vector<MeshPiece> parts) {
    MeshPiece all;
    if (parts.empty()) return all;
    if (parts.size() == 1) return std::move(parts.front());
    for (const MeshPiece& part : parts) {
        all.point_numbers.insert(all.point_numbers.end(), part.point_numbers.begin(), part.point_numbers.end());
        all.cell_numbers.insert(all.cell_numbers.end(), part.cell_numbers.begin(), part.cell_numbers.end());
    }
    for (auto* numbers : {&all.point_numbers, &all.cell_numbers}) {
        std::ranges::sort(*numbers);
        numbers->erase(std::unique(numbers->begin(), numbers->end()), numbers->end());
    }
    const std::size_t points = all.point_numbers.size(), cells = all.cell_numbers.size();
    all.mesh.points.resize(points);
    all.mesh.cells.resize(cells);
    all.owned_points.assign(points, 0);
    all.owned_cells.assign(cells, 0);
    for (const Attribute& field : parts.front().mesh.attributes) {
        Attribute& to = all.mesh.attributes.emplace_back(without_values(field));
        to.values.resize(points * static_cast<std::size_t>(field.channels));
        if (field.function != nullptr) to.arguments.resize(points * field.function->arguments);
    }
    std::set<std::array<Index, 2>> creases;
    std::set<std::array<Index, 4>> faces;
    for (MeshPiece& part_left : parts) {
        const MeshPiece part = std::move(part_left);  // frees each part after its turn
        std::vector<Index> places(part.point_numbers.size());
        std::size_t at = 0;
        for (std::size_t p = 0; p < places.size(); ++p) {
            while (all.point_numbers[at] != part.point_numbers[p]) ++at;
            places[p] = static_cast<Index>(at);
            all.mesh.points[at] = part.mesh.points[p];
            all.owned_points[at] |= part.owned_points[p];
            for (std::size_t a = 0; a < all.mesh.attributes.size(); ++a) {
                copy_point(part.mesh.attributes[a], p, all.mesh.attributes[a], at);
            }
        }
        at = 0;
        for (std::size_t c = 0; c < part.cell_numbers.size(); ++c) {
            while (all.cell_numbers[at] != part.cell_numbers[c]) ++at;
            for (std::size_t k = 0; k < 8; ++k) all.mesh.cells[at][k] = places[part.mesh.cells[c][k]];
            all.owned_cells[at] |= part.owned_cells[c];
        }
        for (auto crease : part.mesh.creases) {
            for (Index& p : crease) p = places[p];
            creases.insert(crease);
        }
        for (auto face : part.mesh.sharp_faces) {
            for (Index& p : face) p = places[p];
            faces.insert(face);
        }
    }
    all.mesh.creases.assign(creases.begin(), creases.end());
    all.mesh.sharp_faces.assign(faces.begin(), faces.end());
    return all;
}

std::vector<std::uint8_t> hull_points_of_owned(const MeshPiece& part) {
    std::vector<std::uint8_t> of_owned(part.mesh.points.size(), 0), on_hull(part.mesh.points.size(), 0);
    for (std::size_t c = 0; c < part.mesh.cells.size(); ++c) {
        if (!part.owned_cells[c]) continue;
        for (const Index p : part.mesh.cells[c]) of_owned[p] = 1;
    }
    // All cells at a point of an owned cell are here, so a face with such a point that has one cell here has no other.
    const auto at_owned = [&](const auto& face) {
        return std::ranges::any_of(face, [&](Index p) { return of_owned[p] != 0; });
    };
    for (const auto& quad : hull_quads(part.mesh, at_owned)) {
        for (const Index p : quad) on_hull[p] = 1;
    }
    return on_hull;
}

MeshPiece chosen_cells(const MeshPiece& part, std::span<const std::uint8_t> chosen, int layers) {
    if (std::ranges::find(chosen, 1) == chosen.end()) return {};
    std::vector<std::uint8_t> kept(chosen.begin(), chosen.end());
    grow(part.mesh, kept, layers);
    MeshPiece result = subset(part, kept);
    result.owned_cells.clear();
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (kept[c]) result.owned_cells.push_back(chosen[c]);
    }
    return result;
}

std::optional<MeshPiece> gather_cells(const MeshSource::Stored& stored, const GatherOptions& options) {
    std::vector<MeshPiece> parts;
    std::uint64_t cells = 0;
    for (std::size_t p = 0; p < stored.pieces.size(); ++p) {
        report_progress(options.progress, "gather", p, stored.pieces.size());
        if (!options.reads(p)) continue;
        const MeshPiece piece = stored.read(p);
        MeshPiece part = chosen_cells(piece, options.chooses(piece), options.layers);
        cells += part.mesh.cells.size();
        if (!part.mesh.cells.empty()) parts.push_back(std::move(part));
        if (cells <= options.most_cells) continue;
        MeshPiece sum = merged(std::move(parts));  // cells about the chosen ones may be in several parts
        cells = sum.mesh.cells.size();
        if (cells > options.most_cells) return std::nullopt;
        parts.clear();
        parts.push_back(std::move(sum));
    }
    return merged(std::move(parts));
}

}  // namespace subvol::detail

namespace subvol {

MeshSource MeshSource::changed(std::function<HexMesh(HexMesh)> change, std::vector<SourceField> fields) const {
    Stored stored = stored_;
    stored.fields = std::move(fields);
    stored.read = [read = stored_.read, change = std::move(change)](std::size_t number) {
        MeshPiece piece = read(number);
        piece.mesh = change(std::move(piece.mesh));
        return piece;
    };
    return MeshSource(std::move(stored));
}

MeshSource::Stored MeshSource::in_pieces() const {
    if (mesh_ == nullptr) return stored_;
    constexpr int kNoEnd = 16;  // layers of cells: the most that anyone asks for
    const std::size_t points = mesh_->points.size(), cells = mesh_->cells.size();
    const auto read = [mesh = mesh_, points, cells](std::size_t) {
        MeshPiece piece{*mesh, std::vector<std::uint64_t>(points), std::vector<std::uint64_t>(cells), {}, {}};
        std::iota(piece.point_numbers.begin(), piece.point_numbers.end(), std::uint64_t{0});
        std::iota(piece.cell_numbers.begin(), piece.cell_numbers.end(), std::uint64_t{0});
        piece.owned_points.assign(points, 1);
        piece.owned_cells.assign(cells, 1);
        return piece;
    };
    const Box box = bounds();
    const Vec3 everywhere(std::numeric_limits<double>::infinity());
    return {.name = {},
            .cells = cells,
            .points = points,
            .bounds = box,
            .halo_layers = kNoEnd,
            .fields = {},
            .pieces = {{cells, points, box, {-everywhere, everywhere}}},
            .read = read};
}

void MeshSource::check_halo(int layers, const std::string& what) const {
    if (mesh_ != nullptr || stored_.halo_layers >= layers) return;
    throw Error(ErrorCode::InvalidInput,
                "its bricks have " + std::to_string(stored_.halo_layers) + " layers of halo, " + what + " need " +
                    std::to_string(layers),
                stored_.name, "split with --halo " + std::to_string(layers));
}

MeshPiece gather(const MeshSource& source, const Box& box) {
    using detail::touch;
    const MeshSource::Stored& stored = source.stored();
    const auto chooses = [&](const MeshPiece& piece) {
        const detail::CellReaches reaches(piece.mesh);
        std::vector<std::uint8_t> chosen = piece.owned_cells;
        for (std::size_t c = 0; c < chosen.size(); ++c) chosen[c] = chosen[c] && touch(reaches(c), box);
        return chosen;
    };
    return *detail::gather_cells(stored, {.reads = [&](std::size_t p) { return touch(stored.pieces[p].reach, box); },
                                          .chooses = chooses,
                                          .layers = stored.halo_layers});
}

MeshHull gather_hull(const MeshSource& source, Progress* progress) {
    using namespace detail;
    std::vector<MeshPiece> parts;
    for_each_piece(source.in_pieces(), "hull", progress, [&](std::size_t, MeshPiece piece) {
        const std::vector<std::uint8_t> on_hull = hull_points_of_owned(piece);
        piece.owned_points = on_hull;  // so that merging puts the flags together
        std::vector<std::uint8_t> kept(piece.owned_cells.size());
        for (std::size_t c = 0; c < kept.size(); ++c) {
            kept[c] =
                piece.owned_cells[c] && std::ranges::any_of(piece.mesh.cells[c], [&](Index p) { return on_hull[p] != 0; });
        }
        // The cells at the hull are few in a large mesh, so they fit into memory although the mesh does not.
        if (std::ranges::find(kept, 1) != kept.end()) parts.push_back(subset(piece, kept));
    });
    MeshPiece all = merged(std::move(parts));
    const auto at_hull = [&](const auto& tag) {
        return std::ranges::any_of(tag, [&](Index p) { return all.owned_points[p] != 0; });
    };
    std::erase_if(all.mesh.creases, [&](const auto& crease) { return !at_hull(crease); });
    std::erase_if(all.mesh.sharp_faces, [&](const auto& face) { return !at_hull(face); });
    return {std::move(all.mesh), std::move(all.owned_points)};
}

}  // namespace subvol
