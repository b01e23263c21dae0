// SPDX-License-Identifier: Apache-2.0
// The stencils of one MCQ-G step against those of independent prototypes.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "lib/stencil_rows.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/refine.h"

namespace subvol {
namespace stencil_test {

using Key = std::pair<char, std::vector<Index>>;
using Rows = std::map<Key, std::map<Index, double>>;

Rows read_rows(const std::filesystem::path& path) {
    Rows rows;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        char kind = 0;
        in >> kind;
        std::vector<Index> points;
        for (std::string word; in >> word && word != ":";) points.push_back(static_cast<Index>(std::stoul(word)));
        auto& row = rows[{kind, points}];
        Index p = 0;
        double w = 0;
        while (in >> p >> w) row[p] = w;
    }
    return rows;
}

template <std::size_t N>
std::vector<Index> sorted(const std::array<Index, N>& points) {
    std::vector<Index> result(points.begin(), points.end());
    std::sort(result.begin(), result.end());
    return result;
}

Rows our_rows(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    const auto stencil_rows = test::stencils(topology);
    Rows rows;
    const auto put = [&](char kind, std::vector<Index> points, std::size_t i) {
        for (const auto& [p, w] : stencil_rows[i]) rows[{kind, points}][p] = w;
    };
    const std::size_t edges = topology.point_count, faces = edges + topology.edges.size(),
                      cells = faces + topology.faces.size();
    for (std::size_t e = 0; e < topology.edges.size(); ++e) put('e', sorted(topology.edges[e]), edges + e);
    for (std::size_t f = 0; f < topology.faces.size(); ++f) put('f', sorted(topology.faces[f]), faces + f);
    for (std::size_t c = 0; c < topology.cells.size(); ++c)
        put('c', sorted(topology.cells[c]), cells + topology.cell_ordinal[c]);
    return rows;
}

void expect_equal(const Rows& ours, const Rows& known) {
    ASSERT_EQ(ours.size(), known.size());
    for (const auto& [key, row] : known) {
        std::string name(1, key.first);
        for (const Index p : key.second) name += ' ' + std::to_string(p);
        ASSERT_TRUE(ours.contains(key)) << name;
        std::map<Index, double> difference = row;
        for (const auto& [p, w] : ours.at(key)) difference[p] -= w;
        for (const auto& [p, d] : difference) EXPECT_NEAR(d, 0, 1e-10) << name << " at point " << p;
    }
}

class KnownStencils : public testing::TestWithParam<const char*> {};

TEST_P(KnownStencils, Agree) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    const auto shared = data->parent_path();
    const std::filesystem::path mesh_path = shared / GetParam();
    const auto known = read_rows(shared / "expected" / (mesh_path.stem().string() + ".txt"));
    ASSERT_FALSE(known.empty());
    expect_equal(our_rows(read_mesh(mesh_path, {.crease_angle_deg = 0}).mesh), known);
}

INSTANTIATE_TEST_SUITE_P(Meshes, KnownStencils,
                         testing::Values("bad/09_irregular3_ok.mesh", "data/amanzi_hexes_192.mesh",
                                         "expected/corner_3creases_3smooth.mesh", "expected/dart_5octants.mesh",
                                         "expected/L_2layers.mesh", "expected/fan5_1layer.mesh"));

TEST(KnownStencilsOfBox, Agree) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    expect_equal(our_rows(test::make_box(4, 4, 4)), read_rows(data->parent_path() / "expected" / "box4.txt"));
}

}  // namespace stencil_test
}  // namespace subvol
