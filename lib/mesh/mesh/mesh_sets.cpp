// SPDX-License-Identifier: Apache-2.0
// Named parts of a mesh go along when cells are left out, refined or split. All rules look at one cell alone: sides of a patch
// and corners of a set of nodes belong to a cell, so a part of the cell has those of its own sides and corners that lie on
// them. A new corner belongs to a set of nodes if all corners of the edge, the face or the cell that it lies on do.
#include "subvol/mesh_sets.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol {
namespace {

template <class Named>
const Named& find(const std::vector<Named>& all, std::string_view name, const std::string& kind, const std::string& kinds) {
    const auto found = std::ranges::find(all, name, &Named::name);
    if (found != all.end()) return *found;
    std::vector<std::string> known;
    for (const Named& one : all) known.push_back(one.name);
    throw Error(ErrorCode::InvalidInput, "there is no " + kind + " \"" + std::string(name) + "\"", {},
                known.empty() ? "the mesh has no " + kinds : "the mesh has: " + detail::listed(known));
}

template <class Named>
std::string counted_names(const std::vector<Named>& all, std::string_view one, std::string_view many) {
    if (all.empty()) return {};
    constexpr std::size_t kNamed = 6;
    std::string list = std::to_string(all.size()) + " " + std::string(all.size() == 1 ? one : many) + " (";
    for (std::size_t k = 0; k < std::min(kNamed, all.size()); ++k)
        list += (k == 0 ? "" : ", ") + detail::printable(all[k].name);
    return list + (all.size() > kNamed ? ", …)" : ")");
}

/// Corners of a part of a cell that belong to a set which has some corners of the cell: where all corners of the edge, the face
/// or the cell that they lie on belong to it.
///
/// lower, upper: of the part, in the parameters of the cell
std::uint8_t corners_of_part(std::uint8_t of_cell, const Vec3& lower, const Vec3& upper) {
    std::uint8_t result = 0;
    for (std::size_t k = 0; k < kCornerParameters.size(); ++k) {
        bool all = true;
        for (std::size_t c = 0; c < kCornerParameters.size() && all; ++c) {
            bool near = true;  // the corner is one of those of the edge, face or cell
            for (std::size_t a = 0; a < 3; ++a) {
                const double at = kCornerParameters[k][a] == 0 ? lower[static_cast<int>(a)] : upper[static_cast<int>(a)];
                near = near && !(kCornerParameters[c][a] == 0 ? at == 1 : at == 0);
            }
            all = !near || (of_cell >> c & 1U) != 0;
        }
        if (all) result = static_cast<std::uint8_t>(result | 1U << k);
    }
    return result;
}

/// The first item that is there more than once; nothing if each is there once.
template <class Item, class Key>
std::optional<Item> repeated(const std::vector<Item>& items, const Key& key) {
    const auto not_ascending = [&](const Item& a, const Item& b) { return !(key(a) < key(b)); };
    if (std::ranges::adjacent_find(items, not_ascending) == items.end()) return std::nullopt;  // as most are
    std::vector<Item> sorted = items;
    std::ranges::sort(sorted, {}, key);
    const auto same = [&](const Item& a, const Item& b) { return key(a) == key(b); };
    const auto found = std::ranges::adjacent_find(sorted, same);
    return found == sorted.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

void validate(const MeshSets& sets, const HexMesh& mesh) {
    const auto check = [&](const std::string& kind, const std::string& name, const std::string& entity, std::size_t number,
                           std::size_t count) {
        if (number < count) return;
        throw Error(ErrorCode::InvalidInput,
                    kind + " " + detail::in_quotes(name) + " has " + entity + " " + std::to_string(number), {},
                    "less than " + std::to_string(count));
    };
    const auto check_names = [](const std::string& kind, const auto& all) {
        std::unordered_set<std::string_view> names;
        for (const auto& one : all) {
            if (!names.insert(one.name).second)
                throw Error(ErrorCode::InvalidInput, "two " + kind + " have the name " + detail::in_quotes(one.name), {},
                            "a name for each");
        }
    };
    for (const Patch& patch : sets.patches) {
        for (const CellSide& side : patch.sides) {
            check("patch", patch.name, "a side of cell", side.cell, mesh.cells.size());
            check("patch", patch.name, "side", side.side, kCellFaces.size());
        }
        const auto twice = repeated(patch.sides, [](const CellSide& side) { return std::pair(side.cell, side.side); });
        if (!twice) continue;
        throw Error(ErrorCode::InvalidInput,
                    "patch " + detail::in_quotes(patch.name) + " has side " + std::to_string(twice->side) + " of cell " +
                        std::to_string(twice->cell) + " more than once",
                    {}, "once");
    }
    for (const CellSet& set : sets.sets) {
        for (const Index cell : set.cells) check("set", set.name, "cell", cell, mesh.cells.size());
        const auto twice = repeated(set.cells, [](Index cell) { return cell; });
        if (!twice) continue;
        throw Error(ErrorCode::InvalidInput,
                    "set " + detail::in_quotes(set.name) + " has cell " + std::to_string(*twice) + " more than once", {},
                    "once");
    }
    for (const NodeSet& set : sets.nodes) {
        for (const CellCorners& at : set.cells) check("set of nodes", set.name, "cell", at.cell, mesh.cells.size());
        const auto twice = repeated(set.cells, [](const CellCorners& at) { return at.cell; });
        if (!twice) continue;
        throw Error(
            ErrorCode::InvalidInput,
            "set of nodes " + detail::in_quotes(set.name) + " has cell " + std::to_string(twice->cell) + " more than once", {},
            "once");
    }
    check_names("patches", sets.patches);
    check_names("sets of cells", sets.sets);
    check_names("sets of nodes", sets.nodes);
}

std::string list_of(const MeshSets& sets) {
    const std::string patches = counted_names(sets.patches, "patch", "patches");
    const std::string cells = counted_names(sets.sets, "set of cells", "sets of cells");
    const std::string nodes = counted_names(sets.nodes, "set of nodes", "sets of nodes");
    const std::string first = patches + (patches.empty() || cells.empty() ? "" : nodes.empty() ? " and " : ", ") + cells;
    return first + (first.empty() || nodes.empty() ? "" : " and ") + nodes;
}

const Patch& find_patch(const MeshSets& sets, std::string_view name) {
    return find(sets.patches, name, "patch", "patches");
}

const CellSet& find_set(const MeshSets& sets, std::string_view name) {
    return find(sets.sets, name, "set", "sets of cells");
}

const NodeSet& find_node_set(const MeshSets& sets, std::string_view name) {
    return find(sets.nodes, name, "set of nodes", "sets of nodes");
}

std::vector<Index> points_of(const HexMesh& mesh, const NodeSet& set) {
    std::vector<Index> points;
    for (const auto& [cell, corners] : set.cells) {
        for (std::size_t k = 0; k < 8; ++k) {
            if ((corners >> k & 1U) != 0) points.push_back(mesh.cells[cell][k]);
        }
    }
    std::ranges::sort(points);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

NodeSet node_set_of(const HexMesh& mesh, std::string name, std::span<const Index> points) {
    std::vector<std::uint8_t> chosen(mesh.points.size(), 0);
    for (const Index p : points) {
        if (p >= chosen.size()) {
            throw Error(ErrorCode::InvalidInput, "set of nodes " + detail::in_quotes(name) + " has point " + std::to_string(p),
                        {}, "less than " + std::to_string(chosen.size()));
        }
        chosen[p] = 1;
    }
    NodeSet set{std::move(name), {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        std::uint8_t corners = 0;
        for (std::size_t k = 0; k < 8; ++k) {
            if (chosen[mesh.cells[c][k]] != 0) corners |= static_cast<std::uint8_t>(1U << k);
        }
        if (corners != 0) set.cells.push_back({c, corners});
    }
    return set;
}

Patch boundary_of(const HexMesh& mesh, const NodeSet& set) {
    // All cells at these points are in the set: a side without another cell of them beside it is on the boundary.
    CellSet cells{set.name, {}};
    for (const CellCorners& at : set.cells) cells.cells.push_back(at.cell);
    Patch patch = hull_of(mesh, cells);
    std::erase_if(patch.sides, [&](const CellSide& side) {
        const auto at = std::ranges::lower_bound(set.cells, side.cell, {}, &CellCorners::cell);
        return !std::ranges::all_of(kCellFaces[side.side], [&](std::size_t k) { return (at->corners >> k & 1U) != 0; });
    });
    return patch;
}

Patch hull_of(const HexMesh& mesh, const CellSet& set) {
    struct Side {
        std::array<Index, 4> corners;  // ascending: the same for both cells at a face
        CellSide side;
    };
    std::vector<Side> sides;
    for (const Index cell : set.cells) {
        for (std::uint8_t side = 0; side < kCellFaces.size(); ++side) {
            Side one{{}, {cell, side}};
            for (std::size_t k = 0; k < 4; ++k) one.corners[k] = mesh.cells[cell][kCellFaces[side][k]];
            std::ranges::sort(one.corners);
            sides.push_back(one);
        }
    }
    std::ranges::stable_sort(sides, {}, &Side::corners);
    Patch hull{set.name, {}};
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const bool before = i > 0 && sides[i - 1].corners == sides[i].corners;
        const bool after = i + 1 < sides.size() && sides[i + 1].corners == sides[i].corners;
        if (!before && !after) hull.sides.push_back(sides[i].side);
    }
    std::ranges::sort(hull.sides, {}, [](const CellSide& side) { return std::pair(side.cell, side.side); });
    return hull;
}

std::vector<Patch> chosen_patches(const HexMesh& mesh, const MeshSets& sets, std::span<const std::string> names) {
    constexpr std::string_view kSet = "set:", kNodes = "nodes:";
    std::vector<Patch> patches;
    for (const std::string& name : names) {
        const bool known = std::ranges::find(sets.patches, name, &Patch::name) != sets.patches.end();
        if (!known && name == "all" && !sets.patches.empty()) {
            std::ranges::copy_if(sets.patches, std::back_inserter(patches), [](const Patch& p) { return !p.sides.empty(); });
            continue;
        }
        const bool is_set = !known && name.starts_with(kSet);
        if (!known && name.starts_with(kNodes)) {
            patches.push_back(boundary_of(mesh, find_node_set(sets, name.substr(kNodes.size()))));
        } else {
            patches.push_back(is_set ? hull_of(mesh, find_set(sets, name.substr(kSet.size()))) : find_patch(sets, name));
        }
        if (patches.back().sides.empty())
            throw Error(ErrorCode::InvalidInput, "no face of patch \"" + name + "\" is left", {}, "a patch with faces");
    }
    return patches;
}

MeshSets sets_of_cells(MeshSets sets, std::span<const std::uint8_t> kept) {
    std::vector<Index> numbers(kept.size(), kNone);
    Index next = 0;
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (kept[c]) numbers[c] = next++;
    }
    for (Patch& patch : sets.patches) {
        std::erase_if(patch.sides, [&](const CellSide& side) { return numbers[side.cell] == kNone; });
        for (CellSide& side : patch.sides) side.cell = numbers[side.cell];
    }
    for (CellSet& set : sets.sets) {
        std::erase_if(set.cells, [&](Index c) { return numbers[c] == kNone; });
        for (Index& c : set.cells) c = numbers[c];
    }
    for (NodeSet& set : sets.nodes) {
        std::erase_if(set.cells, [&](const CellCorners& at) { return numbers[at.cell] == kNone; });
        for (CellCorners& at : set.cells) at.cell = numbers[at.cell];
    }
    return sets;
}

MeshSets sets_of_children(MeshSets sets, int levels) {
    for (; levels > 0; --levels) {
        for (Patch& patch : sets.patches) {
            std::vector<CellSide> sides;
            for (const auto& [cell, side] : patch.sides) {
                for (const std::size_t k : kCellFaces[side]) sides.push_back({static_cast<Index>(8 * cell + k), side});
            }
            patch.sides = std::move(sides);
        }
        for (CellSet& set : sets.sets) {
            std::vector<Index> cells;
            for (const Index cell : set.cells) {
                for (Index k = 0; k < 8; ++k) cells.push_back(8 * cell + k);
            }
            set.cells = std::move(cells);
        }
        for (NodeSet& set : sets.nodes) {
            std::vector<CellCorners> cells;
            for (const auto& [cell, corners] : set.cells) {
                for (std::size_t k = 0; k < 8; ++k) {
                    Vec3 lower;
                    for (std::size_t a = 0; a < 3; ++a) lower[static_cast<int>(a)] = kCornerParameters[k][a] == 0 ? 0 : .5;
                    const std::uint8_t of_child = corners_of_part(corners, lower, lower + Vec3(.5));
                    if (of_child != 0) cells.push_back({static_cast<Index>(8 * cell + k), of_child});
                }
            }
            set.cells = std::move(cells);
        }
    }
    return sets;
}

MeshSets sets_of_parts(MeshSets sets, std::span<const PartOfCell> parts) {
    Index parents = 0;
    for (const PartOfCell& part : parts) parents = std::max(parents, part.parent + 1);
    std::vector<std::vector<Index>> children(parents);
    for (std::size_t c = 0; c < parts.size(); ++c) children[parts[c].parent].push_back(static_cast<Index>(c));
    for (Patch& patch : sets.patches) {
        std::vector<CellSide> sides;
        for (const auto& [cell, side] : patch.sides) {
            const int axis = side / 2;
            for (const Index child : children[cell]) {
                const double lower = parts[child].lower[axis], upper = lower + parts[child].size[axis];
                if (side % 2 == 0 ? lower == 0 : upper == 1) sides.push_back({child, side});
            }
        }
        patch.sides = std::move(sides);
    }
    for (CellSet& set : sets.sets) {
        std::vector<Index> cells;
        for (const Index cell : set.cells) cells.insert(cells.end(), children[cell].begin(), children[cell].end());
        std::ranges::sort(cells);
        set.cells = std::move(cells);
    }
    for (NodeSet& set : sets.nodes) {
        std::vector<CellCorners> cells;
        for (const auto& [cell, corners] : set.cells) {
            for (const Index child : children[cell]) {
                const std::uint8_t of_child =
                    corners_of_part(corners, parts[child].lower, parts[child].lower + parts[child].size);
                if (of_child != 0) cells.push_back({child, of_child});
            }
        }
        std::ranges::sort(cells, {}, &CellCorners::cell);
        set.cells = std::move(cells);
    }
    return sets;
}

std::array<double, 3> place_on_side(std::uint8_t side, double s, double t) {
    const auto& corners = kCellFaces[side];
    std::array<double, 3> place{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double from = kCornerParameters[corners[0]][a];
        place[a] = from + s * (kCornerParameters[corners[1]][a] - from) + t * (kCornerParameters[corners[3]][a] - from);
    }
    return place;
}

}  // namespace subvol
