// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "assemble.h"
#include "subvol/cell.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Hex = std::array<Index, 8>;
using Tet = std::array<Index, 4>;

template <std::size_t N>
bool all_different(const std::array<Index, N>& corners) {
    for (std::size_t k = 1; k < N; ++k) {
        if (std::find(corners.begin(), corners.begin() + k, corners[k]) != corners.begin() + k) return false;
    }
    return true;
}

// The corners of each kind of cell as those of a hexahedron whose collapsed edges make it that kind.
Hex as_hex(const Hex& c) {
    return c;
}
Hex as_hex(const std::array<Index, 4>& c) {
    return {c[0], c[1], c[2], c[2], c[3], c[3], c[3], c[3]};
}
Hex as_hex(const std::array<Index, 6>& c) {
    return {c[0], c[1], c[2], c[2], c[3], c[4], c[5], c[5]};
}
Hex as_hex(const std::array<Index, 5>& c) {
    return {c[0], c[1], c[2], c[3], c[4], c[4], c[4], c[4]};
}

// A point that occurs at two corners which no chain of collapsed edges joins; kNone if there is none.
Index torn_point(const Hex& hex) {
    std::array<std::size_t, 8> root{0, 1, 2, 3, 4, 5, 6, 7};
    for (int round = 0; round < 3; ++round) {  // a chain of collapsed edges has at most three
        for (const auto& [i, j] : kCellEdges) {
            if (hex[i] == hex[j]) root[i] = root[j] = std::min(root[i], root[j]);
        }
    }
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (hex[i] == hex[j] && root[i] != root[j]) return hex[i];
        }
    }
    return kNone;
}

// Sorts the cells with repeated points into the kinds that they look like.
class Collapse {
public:
    Collapse(MeshFile& found, std::string_view file, const EntityNames& names) : found_(found), file_(file), names_(names) {}

    bool run(OtherCells other_cells) {
        number_hexes();
        take_from(found_.hexes);
        take_from(found_.prisms);
        take_from(found_.pyramids);
        take_from(found_.tets);
        if (other_cells == OtherCells::Ignore) {
            if (collapsed_ > 0) {
                warn(collapsed_, " with repeated points ignored");
                found_.ignored.push_back({"cells", "with repeated points", collapsed_});
            }
        } else {
            append(found_.tets, tets_);
            append(found_.prisms, prisms_);
            append(found_.pyramids, pyramids_);
            if (collapsed_ > 0) warn(collapsed_, " with repeated points taken as " + list());
        }
        if (flat_ > 0) warn(flat_, " without volume (too few different points) left out");
        return cut_ > 0 && other_cells != OtherCells::Ignore;
    }

private:
    // Cells move and vanish, so arrays of cells need the numbers, which a file of hexahedra alone does without.
    void number_hexes() {
        auto& [corners, numbers] = found_.hexes;
        if (!numbers.empty() || std::ranges::all_of(corners, [](const Hex& hex) { return all_different(hex); })) return;
        const bool alone = found_.tets.corners.empty() && found_.prisms.corners.empty() && found_.pyramids.corners.empty();
        for (std::size_t c = 0; alone && c < corners.size(); ++c) numbers.push_back(static_cast<Index>(c));
    }

    template <std::size_t N>
    void take_from(FileCells<N>& cells) {
        auto& [corners, numbers] = cells;
        std::size_t kept = 0;
        for (std::size_t c = 0; c < corners.size(); ++c) {
            if (!all_different(corners[c])) {
                number_ = numbers.empty() ? kNone : numbers[c];
                take(as_hex(corners[c]), N == 8 || number_ != kNone ? names_.cell(numbers.empty() ? c : number_) : "a cell");
                continue;
            }
            corners[kept] = corners[c];
            if (!numbers.empty()) numbers[kept] = numbers[c];
            ++kept;
        }
        corners.resize(kept);
        if (!numbers.empty()) numbers.resize(kept);
    }

    void take(const Hex& hex, const std::string& name) {
        if (const Index torn = torn_point(hex); torn != kNone) {
            throw Error(ErrorCode::InvalidInput,
                        name + " has " + names_.point(torn) + " twice, at corners that no collapsed edge joins",
                        std::string(file_), "a cell may repeat a point only along its edges");
        }
        std::vector<Tet> tets;
        for (const Tet& tet : split_cell(hex)) {
            if (!all_different(tet)) continue;
            // Another one with the same corners is its mirror image: together they have no volume.
            const auto twin = std::ranges::find_if(
                tets, [&](const Tet& other) { return std::is_permutation(tet.begin(), tet.end(), other.begin()); });
            if (twin == tets.end()) {
                tets.push_back(tet);
            } else {
                tets.erase(twin);
            }
        }
        if (tets.empty()) {
            ++flat_;
            return;
        }
        ++collapsed_;
        if (take_prism(hex) || take_pyramid(hex)) return;
        // Its quads are cut as split_cell cuts them, so its neighbours have to be cut too.
        if (tets.size() > 1) ++cut_;
        for (const Tet& tet : tets) put(tets_, tet);
    }

    // Two opposite edges of a face are collapsed: the other two faces at them are triangles.
    bool take_prism(const Hex& hex) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t side = 0; side < 4; ++side) {
                // The corners around the axis, at its lower and its upper end; the edge from 0 to 1 is collapsed at both.
                static constexpr std::array<std::array<std::size_t, 8>, 3> kAround{
                    {{0, 3, 7, 4, 1, 2, 6, 5}, {0, 4, 5, 1, 3, 7, 6, 2}, {0, 1, 2, 3, 4, 5, 6, 7}}};
                const auto at = [&](std::size_t k, std::size_t end) { return hex[kAround[axis][4 * end + (side + k) % 4]]; };
                if (at(0, 0) != at(1, 0) || at(0, 1) != at(1, 1)) continue;
                const std::array<Index, 6> prism{at(1, 0), at(2, 0), at(3, 0), at(1, 1), at(2, 1), at(3, 1)};
                if (!all_different(prism)) continue;
                put(prisms_, prism);
                return true;
            }
        }
        return false;
    }

    // A face is collapsed to a point: the apex over the opposite face.
    bool take_pyramid(const Hex& hex) {
        for (std::size_t f = 0; f < 6; ++f) {
            const auto corner = [&](std::size_t face, std::size_t k) { return hex[kCellFaces[face][k]]; };
            const Index apex = corner(f, 0);
            if (corner(f, 1) != apex || corner(f, 2) != apex || corner(f, 3) != apex) continue;
            const std::size_t base = f ^ 1u;
            const std::array<Index, 5> pyramid{corner(base, 3), corner(base, 2), corner(base, 1), corner(base, 0), apex};
            if (!all_different(pyramid)) continue;
            put(pyramids_, pyramid);
            return true;
        }
        return false;
    }

    template <std::size_t N>
    void put(FileCells<N>& into, const std::array<Index, N>& corners) {
        into.corners.push_back(corners);
        if (number_ != kNone) into.numbers.push_back(number_);
    }

    template <std::size_t N>
    static void append(FileCells<N>& to, const FileCells<N>& from) {
        to.corners.insert(to.corners.end(), from.corners.begin(), from.corners.end());
        to.numbers.insert(to.numbers.end(), from.numbers.begin(), from.numbers.end());
    }

    [[nodiscard]] std::string list() const {
        std::string text;
        const auto add = [&](std::size_t count, std::string_view one, std::string_view many) {
            if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, one, many);
        };
        add(prisms_.corners.size(), "prism", "prisms");
        add(pyramids_.corners.size(), "pyramid", "pyramids");
        add(tets_.corners.size(), "tetrahedron", "tetrahedra");
        return text;
    }

    void warn(std::size_t count, const std::string& rest) { found_.warnings.push_back(counted(count, "cell", "cells") + rest); }

    MeshFile& found_;
    std::string_view file_;
    const EntityNames& names_;
    Index number_ = kNone;  // of the cell that is taken, where cells have numbers
    FileCells<4> tets_;
    FileCells<6> prisms_;
    FileCells<5> pyramids_;
    std::size_t collapsed_ = 0, flat_ = 0, cut_ = 0;
};

}  // namespace

bool take_collapsed(MeshFile& found, OtherCells other_cells, std::string_view file, const EntityNames& names) {
    return Collapse(found, file, names).run(other_cells);
}

}  // namespace subvol::detail
