// SPDX-License-Identifier: Apache-2.0
// A face of a file may have become several sides of hexahedra: where cells were split into hexahedra, a curved cell into
// smaller ones, a polygon into triangles first. Whatever was done, each new point lies on a corner, an edge, a face or in the
// middle of a cell of the file, and the file's points of that entity carry it. So a side of a hexahedron lies on a face of the
// file if the points that carry its four corners are all points of the face:
//
//     a───m───b      the corners of the side (a, m, c, n) are carried by a, by a and b, by a, b, d and e, and by a and d:
//     │   │   │      together by a, b, d and e, which are points of the face a b e d
//     n───c───┤
//     │   │   │
//     d───┴───e
#include "file_sets.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/counted_rows.h"

namespace subvol::detail {

namespace {

/// All faces of all patches, by the points of the file.
class PatchFaces {
public:
    PatchFaces(const std::vector<FilePatch>& patches, std::size_t file_points) : patches_(patches) {
        for (std::size_t k = 0; k < patches.size(); ++k) {
            for (std::size_t f = 0; f < patches[k].size(); ++f) faces_.push_back({k, f});
            for (const Index p : patches[k].corners) file_points = std::max(file_points, std::size_t{p} + 1);
        }
        at_points_ = counted_rows<std::size_t>(file_points, [&](const auto& put) {
            for (std::size_t i = 0; i < faces_.size(); ++i) {
                for (const Index p : points_of(faces_[i])) put(p, i);
            }
        });
    }

    [[nodiscard]] bool has(Index p) const { return p < at_points_.size() && !at_points_[p].empty(); }

    /// Calls call(patch, number of the face among those of all patches) once for each patch with a face that has all these
    /// points. Looks at the faces of the point that has the fewest: thousands may meet on an axis.
    template <class Call>
    void each_patch_with(std::span<const Index> points, const Call& call) const {
        const Index point = *std::ranges::min_element(points, {}, [&](Index p) { return at_points_[p].size(); });
        std::size_t last = patches_.size();  // faces at a point come in the order of their patches
        for (const std::size_t i : at_points_[point]) {
            const Face& face = faces_[i];
            if (face.patch == last) continue;
            const auto of_face = points_of(face);
            if (!std::ranges::all_of(points, [&](Index p) { return std::ranges::find(of_face, p) != of_face.end(); })) continue;
            last = face.patch;
            call(face.patch, static_cast<Index>(i));
        }
    }

private:
    struct Face {
        std::size_t patch, face;
    };
    [[nodiscard]] std::span<const Index> points_of(const Face& face) const { return patches_[face.patch].face(face.face); }

    const std::vector<FilePatch>& patches_;
    std::vector<Face> faces_;
    Rows<std::size_t> at_points_;  // faces
};

/// Which points of the file carry a point of the mesh.
struct Carriers {
    const IndexRows* sources;
    const IndexRows& of_curved;

    template <class Call>
    void each(Index p, const Call& call) const {
        const auto of_source = [&](Index q) {
            if (of_curved.size() == 0) return call(q);
            for (const Index r : of_curved[q]) call(r);
        };
        if (sources == nullptr) return of_source(p);
        for (const Index q : (*sources)[p]) of_source(q);
    }
};

std::vector<Patch> patches_of_mesh(const HexMesh& mesh, const MeshFile& found, const IndexRows* sources,
                                   std::vector<ValuesOnPatches::Side>& on_faces, ReadResult& read) {
    if (found.patches.empty()) return {};
    const PatchFaces faces(found.patches, found.points.size());
    const Carriers carriers{sources, found.carriers};
    std::vector<std::uint8_t> on_patch(mesh.points.size(), 0);
    for (Index p = 0; p < on_patch.size(); ++p) {
        bool all = true;
        carriers.each(p, [&](Index q) { all = all && faces.has(q); });
        on_patch[p] = all;
    }
    struct Side {
        CellSide side;
        std::vector<std::size_t> patches;
        Index face = 0;
        bool inside = false;
    };
    std::map<std::array<Index, 4>, Side> sides;
    std::vector<Index> points;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (std::uint8_t side = 0; side < 6; ++side) {
            std::array<Index, 4> key;
            for (std::size_t k = 0; k < 4; ++k) key[k] = mesh.cells[c][kCellFaces[side][k]];
            if (!std::ranges::all_of(key, [&](Index p) { return on_patch[p] != 0; })) continue;
            points.clear();
            for (const Index p : key) carriers.each(p, [&](Index q) { points.push_back(q); });
            std::ranges::sort(points);
            points.erase(std::unique(points.begin(), points.end()), points.end());
            std::vector<std::size_t> patches;
            Index first = kNone;
            faces.each_patch_with(points, [&](std::size_t patch, Index face) {
                patches.push_back(patch);
                first = std::min(first, face);
            });
            if (patches.empty()) continue;
            std::ranges::sort(key);
            const auto [at, is_new] = sides.try_emplace(key, Side{{c, side}, std::move(patches), first});
            at->second.inside = !is_new;
        }
    }
    std::vector<std::uint8_t> inside(found.patches.size(), 0);
    std::vector<Patch> result;
    for (const FilePatch& patch : found.patches) result.push_back({patch.name, {}});
    for (const auto& [key, side] : sides) {
        for (const std::size_t patch : side.patches) inside[patch] |= side.inside ? 1 : 0;
        if (side.inside) continue;
        for (const std::size_t patch : side.patches) result[patch].sides.push_back(side.side);
        on_faces.push_back({side.side, side.face});
    }
    std::ranges::sort(on_faces, {}, [](const auto& on) { return std::pair(on.side.cell, on.side.side); });
    for (Patch& patch : result) {
        std::ranges::sort(patch.sides, {}, [](const CellSide& side) { return std::pair(side.cell, side.side); });
    }
    LeftOut left_out;
    for (std::size_t k = 0; k < result.size(); ++k) {
        if (!result[k].sides.empty()) continue;
        if (inside[k]) {
            left_out.add(result[k].name, "its faces lie between cells");
        } else {
            read.ignored.push_back({"patch", result[k].name, 1, "no side of a cell belongs to it"});
        }
    }
    left_out.report("patch", "patches", read.warnings, read.ignored);
    std::erase_if(result, [](const Patch& patch) { return patch.sides.empty(); });
    return result;
}

/// The sets of nodes: the points that are carried by nodes of a set alone, by the cells that have them.
std::vector<NodeSet> node_sets_of_mesh(const HexMesh& mesh, const MeshFile& found, const IndexRows* sources, ReadResult& read) {
    std::vector<NodeSet> result;
    if (found.node_sets.empty()) return result;
    const Carriers carriers{sources, found.carriers};
    const auto none = static_cast<Index>(mesh.points.size());
    std::size_t nodes = found.points.size();
    std::vector<Index> first(mesh.points.size(), none);  // of the nodes that carry each point
    for (Index p = 0; p < mesh.points.size(); ++p) {
        carriers.each(p, [&](Index q) {
            if (first[p] == none) first[p] = q;
            nodes = std::max(nodes, std::size_t{q} + 1);
        });
    }
    for (const FileSet& set : found.node_sets) {
        for (const Index q : set.numbers) nodes = std::max(nodes, std::size_t{q} + 1);
    }
    const auto carried = counted_rows<Index>(nodes, [&](const auto& put) {
        for (Index p = 0; p < mesh.points.size(); ++p) {
            if (first[p] != none) put(first[p], p);
        }
    });
    const auto cells_at = lists_at_points(mesh.cells, mesh.points.size());
    std::vector<std::uint8_t> in_set(nodes, 0), corners(mesh.cells.size(), 0);
    std::vector<Index> cells;
    const auto take = [&](Index p) {
        for (const Index c : cells_at[p]) {
            if (corners[c] == 0) cells.push_back(c);
            for (std::size_t k = 0; k < 8; ++k) {
                if (mesh.cells[c][k] == p) corners[c] = static_cast<std::uint8_t>(corners[c] | 1U << k);
            }
        }
    };
    LeftOut left_out;
    for (const FileSet& set : found.node_sets) {
        for (const Index q : set.numbers) in_set[q] = 1;
        for (const Index q : set.numbers) {
            for (const Index p : carried[q]) {
                bool all = true;
                carriers.each(p, [&](Index carrier) { all = all && in_set[carrier] != 0; });
                if (all) take(p);
            }
        }
        for (const Index q : set.numbers) in_set[q] = 0;
        std::ranges::sort(cells);
        NodeSet of_mesh{set.name, {}};
        for (const Index c : cells) of_mesh.cells.push_back({c, std::exchange(corners[c], std::uint8_t{0})});
        cells.clear();
        if (of_mesh.cells.empty()) {
            left_out.add(set.name, "no node of it is a corner of a cell");
        } else {
            result.push_back(std::move(of_mesh));
        }
    }
    left_out.report("set of nodes", "sets of nodes", read.warnings, read.ignored);
    return result;
}

}  // namespace

FileSetsOfMesh sets_of_mesh(const HexMesh& mesh, const MeshFile& found, std::span<const Index> cell_numbers,
                            const IndexRows* sources, ReadResult& read) {
    FileSetsOfMesh result;
    MeshSets& sets = result.sets;
    sets.patches = patches_of_mesh(mesh, found, sources, result.sides, read);
    sets.nodes = node_sets_of_mesh(mesh, found, sources, read);
    if (found.sets.empty()) return result;
    const auto number = [&](Index c) { return cell_numbers.empty() ? c : cell_numbers[c]; };
    std::vector<Index> by_number(mesh.cells.size());
    std::iota(by_number.begin(), by_number.end(), Index{0});
    std::ranges::stable_sort(by_number, {}, number);
    for (const FileSet& set : found.sets) {
        CellSet of_mesh{set.name, {}};
        for (const Index wanted : set.numbers) {
            const auto first = std::ranges::lower_bound(by_number, wanted, {}, number);
            const auto last = std::ranges::upper_bound(by_number, wanted, {}, number);
            of_mesh.cells.insert(of_mesh.cells.end(), first, last);
        }
        std::ranges::sort(of_mesh.cells);
        of_mesh.cells.erase(std::unique(of_mesh.cells.begin(), of_mesh.cells.end()), of_mesh.cells.end());
        if (of_mesh.cells.empty()) {
            read.ignored.push_back({"set", set.name, 1, "no cell belongs to it"});
        } else {
            sets.sets.push_back(std::move(of_mesh));
        }
    }
    return result;
}

}  // namespace subvol::detail
