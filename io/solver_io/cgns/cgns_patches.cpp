// SPDX-License-Identifier: Apache-2.0
// A boundary condition (BC_t) lists vertices or faces:
//
//     GridLocation     of the list in an unstructured zone        in a structured zone
//     Vertex           vertices                                   vertices: i, j, k of each
//     FaceCenter       elements: triangles, quads, polygons       cells' i, j, k in the plane of the range
//     IFaceCenter, …                                              the face at lower i of cell i, j, k
//
// as PointRange (the first and the last) or PointList; ElementRange and ElementList name elements whatever the location. Of
// vertices the condition has each face of a cell whose corners are all among them; those inside the body are dropped with
// those of all formats.
#include "cgns_patches.h"

#include <algorithm>
#include <array>

#include "subvol/cell.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::array<std::array<std::size_t, 4>, 5> kPrismSides{
    {{0, 2, 1, 1}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
constexpr std::array<std::array<std::size_t, 4>, 5> kPyramidSides{
    {{0, 3, 2, 1}, {0, 1, 4, 4}, {1, 2, 4, 4}, {2, 3, 4, 4}, {3, 0, 4, 4}}};
constexpr std::array<std::array<std::size_t, 4>, 4> kTetSides{{{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {2, 0, 3, 3}}};

using Triple = std::array<std::int64_t, 3>;

class Conditions {
public:
    Conditions(const CgnsTree& tree, const StructuredGrid* grid, const CgnsFaces& faces, MeshFile& into)
        : tree_(tree), grid_(grid), faces_(faces), into_(into), patches_(into.patches), node_sets_(into.node_sets) {}

    void read(const std::string& node) {
        std::string location =
            tree_.child(node, "GridLocation_t") ? tree_.text(*tree_.child(node, "GridLocation_t")) : "Vertex";
        if (location == "CellCenter") tree_.file().fail("node " + in_quotes(node) + " is at cells");
        const std::size_t width = grid_ ? 3 : 1;
        bool range = false;
        std::vector<std::int64_t> numbers;
        for (const std::string name : {"PointRange", "PointList", "ElementRange", "ElementList"}) {
            if (!tree_.has_data(node + "/" + name)) continue;
            numbers = tree_.integers(node + "/" + name);
            range = name.ends_with("Range");
            if (name.starts_with("Element")) location = "FaceCenter";
            break;
        }
        if (numbers.empty() || numbers.size() % width != 0 || (range && numbers.size() != 2 * width))
            tree_.file().fail("node " + in_quotes(node) + " does not list its points");
        new_faces_.clear();
        new_vertices_.clear();
        if (grid_) {
            add_structured(node, location, numbers, range);
        } else if (location == "Vertex") {
            std::vector<std::uint8_t> chosen(into_.points.size(), 0);
            each_number(numbers, range, into_.points.size(), node,
                        [&](std::int64_t n) { chosen[static_cast<std::size_t>(n - 1)] = 1; });
            add_faces_of(chosen);
        } else {
            constexpr std::size_t kAnyNumber = std::size_t{1} << 40;
            each_number(numbers, range && numbers[1] - numbers[0] < 4 * static_cast<std::int64_t>(faces_.size()), kAnyNumber,
                        node, [&](std::int64_t n) { add_element(n, node); });
        }
        const auto family = tree_.child(node, "FamilyName_t");
        const std::string of_family = family ? tree_.text(*family) : std::string();
        const std::string name = as_utf8(of_family.empty() ? CgnsTree::name_of(node) : of_family);
        if (new_faces_.empty() && !new_vertices_.empty()) {  // on an edge, or at single vertices
            FileSet& set = node_sets_[name];
            set.numbers.insert(set.numbers.end(), new_vertices_.begin(), new_vertices_.end());
            return;
        }
        FilePatch& patch = patches_[name];
        for (const auto& face : new_faces_) patch.add(face);
    }

private:
    /// Calls call(number) for each of a list or a range of numbers from 1.
    template <class Call>
    void each_number(const std::vector<std::int64_t>& numbers, bool range, std::size_t most, const std::string& node,
                     const Call& call) const {
        const auto check = [&](std::int64_t n) {
            if (n < 1 || static_cast<std::uint64_t>(n) > most)
                tree_.file().fail("node " + in_quotes(node) + " names number " + std::to_string(n),
                                  "1 to " + std::to_string(most));
        };
        for (const std::int64_t n : numbers) check(n);
        if (!range) {
            for (const std::int64_t n : numbers) call(n);
        } else {
            for (std::int64_t n = numbers[0]; n <= numbers[1]; ++n) call(n);
        }
    }

    void add_element(std::int64_t number, const std::string& node) {
        const auto face = faces_.find(number);
        if (face == faces_.end())
            tree_.file().fail("node " + in_quotes(node) + ": element " + std::to_string(number) + " is not a face");
        auto& corners = new_faces_.emplace_back();
        for (const std::int64_t v : face->second) {
            if (v < 1 || static_cast<std::uint64_t>(v) > into_.points.size())
                tree_.file().fail("face " + std::to_string(number) + ": there is no vertex " + std::to_string(v));
            corners.push_back(static_cast<Index>(v - 1));
        }
    }

    /// The faces of cells whose corners are all chosen.
    void add_faces_of(const std::vector<std::uint8_t>& chosen) {
        for (Index p = 0; p < chosen.size(); ++p) {
            if (chosen[p] != 0) new_vertices_.push_back(p);
        }
        const auto add = [&](const auto& cells, const auto& sides) {
            for (const auto& cell : cells.corners) {
                for (const auto& side : sides) {
                    if (!std::ranges::all_of(side, [&](std::size_t k) { return chosen[cell[k]] != 0; })) continue;
                    auto& corners = new_faces_.emplace_back();
                    for (std::size_t k = 0; k < side.size(); ++k) {
                        if (k == 0 || side[k] != side[k - 1]) corners.push_back(cell[side[k]]);
                    }
                }
            }
        };
        add(into_.hexes, kCellFaces);
        add(into_.tets, kTetSides);
        add(into_.prisms, kPrismSides);
        add(into_.pyramids, kPyramidSides);
    }

    void add_structured(const std::string& node, const std::string& location, const std::vector<std::int64_t>& numbers,
                        bool range) {
        const bool vertices = location == "Vertex";
        std::size_t axis = 3;  // of the faces' normals
        for (std::size_t a = 0; a < 3; ++a) {
            if (location == std::string(1, "IJK"[a]) + "FaceCenter") axis = a;
            if (location == "FaceCenter" && range && numbers[a] == numbers[a + 3] && axis == 3) axis = a;
        }
        if (!vertices && axis == 3) tree_.file().fail("node " + in_quotes(node) + " does not say the direction of its faces");
        Triple most{};
        for (std::size_t a = 0; a < 3; ++a)
            most[a] = static_cast<std::int64_t>(grid_->points[a]) - (vertices || a == axis ? 0 : 1);
        std::vector<std::uint8_t> chosen(vertices ? into_.points.size() : 0, 0);
        each_triple(numbers, range, most, node, [&](const Triple& at) {
            if (vertices) {
                chosen[point(at)] = 1;
                return;
            }
            auto& corners = new_faces_.emplace_back();
            for (const auto& [s, t] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
                Triple corner = at;
                corner[(axis + 1) % 3] += s;
                corner[(axis + 2) % 3] += t;
                corners.push_back(point(corner));
            }
        });
        if (vertices) add_faces_of(chosen);
    }

    template <class Call>
    void each_triple(const std::vector<std::int64_t>& numbers, bool range, const Triple& most, const std::string& node,
                     const Call& call) const {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (numbers[i] >= 1 && numbers[i] <= most[i % 3]) continue;
            tree_.file().fail("node " + in_quotes(node) + " names index " + std::to_string(numbers[i]),
                              "1 to " + std::to_string(most[i % 3]));
        }
        if (!range) {
            for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) call(Triple{numbers[i], numbers[i + 1], numbers[i + 2]});
            return;
        }
        for (std::int64_t k = numbers[2]; k <= numbers[5]; ++k) {
            for (std::int64_t j = numbers[1]; j <= numbers[4]; ++j) {
                for (std::int64_t i = numbers[0]; i <= numbers[3]; ++i) call(Triple{i, j, k});
            }
        }
    }

    [[nodiscard]] Index point(const Triple& at) const {
        const auto [i, j, k] = at;
        const auto ni = static_cast<std::int64_t>(grid_->points[0]), nj = static_cast<std::int64_t>(grid_->points[1]);
        return static_cast<Index>(i - 1 + ni * (j - 1 + nj * (k - 1)));
    }

    const CgnsTree& tree_;
    const StructuredGrid* grid_;
    const CgnsFaces& faces_;
    MeshFile& into_;
    ByName<FilePatch> patches_;
    ByName<FileSet> node_sets_;
    std::vector<std::vector<Index>> new_faces_;  // of the condition at hand
    std::vector<Index> new_vertices_;
};

}  // namespace

bool has_boundary_conditions(const CgnsTree& tree, const std::string& zone) {
    return tree.child(zone, "ZoneBC_t").has_value();
}

void read_boundary_conditions(const CgnsTree& tree, const std::string& zone, const StructuredGrid* grid, const CgnsFaces& faces,
                              MeshFile& into, LeftOut& left_out) {
    const auto all = tree.child(zone, "ZoneBC_t");
    if (!all) return;
    Conditions conditions(tree, grid, faces, into);
    for (const std::string& node : tree.children(*all, "BC_t")) {
        try {
            conditions.read(node);
        } catch (const Error& error) {
            left_out.add(CgnsTree::name_of(node), error.what());
        }
    }
}

}  // namespace subvol::detail
