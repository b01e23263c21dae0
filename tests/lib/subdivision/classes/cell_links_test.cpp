// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/cell_links.h"

#include <gtest/gtest.h>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/topology.h"

namespace subvol {
namespace cell_links_test {

using detail::build_links;
using detail::CellLinks;

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

// Neighbours are found without the faces of a topology: they are those of the topology, with the same turns.
TEST(CellLinks, AreThoseOfTheTopology) {
    for (const HexMesh& mesh :
         {make_model("ball", 4), make_model("fan", 9), test::make_nested_cubes(3), make_model("pawn", 2)}) {
        const CellLinks links = build_links(mesh), expected = build_links(mesh, build_topology(mesh));
        EXPECT_TRUE(links.neighbors == expected.neighbors);
        EXPECT_TRUE(links.turns == expected.turns);
        EXPECT_EQ(links.regular, expected.regular);
        EXPECT_EQ(links.colors, expected.colors);
        EXPECT_EQ(links.cells_at, expected.cells_at);
    }
}

// What is wrong with a mesh is said as by the topology.
TEST(CellLinks, RefuseFacesOfThreeCellsAndTwins) {
    HexMesh three = make_model("twist", 2), twins = three;
    three.cells.push_back(three.cells[0]);
    for (const std::size_t k : {4U, 5U, 6U, 7U}) {
        three.points.push_back(three.points[three.cells[0][k]] + Vec3(0, 0, 9));
        three.cells.back()[k] = static_cast<Index>(three.points.size() - 1);
    }
    three.cells.push_back(three.cells.back());
    for (const std::size_t k : {4U, 5U, 6U, 7U}) {
        three.points.push_back(three.points[three.cells[0][k]] + Vec3(0, 0, 12));
        three.cells.back()[k] = static_cast<Index>(three.points.size() - 1);
    }
    twins.cells = {twins.cells[0], twins.cells[0]};
    for (HexMesh* mesh : {&three, &twins}) {
        mesh->attributes.clear();
        const std::string said = message_of([&] { (void)build_links(*mesh); });
        EXPECT_FALSE(said.empty());
        EXPECT_EQ(said, message_of([&] { (void)build_topology(*mesh); }));
    }
}

}  // namespace cell_links_test
}  // namespace subvol
