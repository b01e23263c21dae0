// SPDX-License-Identifier: Apache-2.0
// CalculiX's results as text and in binary.

#include <gmock/gmock.h>

#include <cstdio>

#include "io/mesh_io/mesh_damage.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace frd_test {

using testing::ElementsAre;
using testing::HasSubstr;

template <class... Values>
std::string line(const char* format, Values... values) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    return std::string(text.data()) + "\n";
}

std::string nodes_of(const HexMesh& mesh, bool wide = true) {
    std::string text =
        line("    2C                  %12d                                     %d", static_cast<int>(mesh.points.size()), wide);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        text += line(wide ? " -1%10d%12.5E%12.5E%12.5E" : " -1%5d%12.5E%12.5E%12.5E", static_cast<int>(p + 1), x.x, x.y, x.z);
    }
    return text + " -3\n";
}

std::string elements_of(const HexMesh& mesh, bool wide = true) {
    std::string text =
        line("    3C                  %12d                                     %d", static_cast<int>(mesh.cells.size()), wide);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        text += line(wide ? " -1%10d%5d%5d%5d" : " -1%5d%5d%5d%5d", static_cast<int>(c + 1), 1, 0, 1) + " -2";
        for (const Index p : mesh.cells[c]) {
            std::string number = line(wide ? "%10d" : "%5d", static_cast<int>(p + 1));
            text += number.substr(0, number.size() - 1);
        }
        text += "\n";
    }
    return text + " -3\n";
}

// A result of so many components, and one that follows from them; the value is the node's number, times the factor.
std::string result_of(const std::string& name, std::size_t nodes, int components, double time, int step, double factor) {
    std::string text =
        line("    1PSTEP                %12d           1           1", step) +
        line("  100CL  101%12.5E%12d                     0%5d           1", time, static_cast<int>(nodes), step) +
        line(" -4  %-8s%5d%5d", name.c_str(), components + 1, 1);
    for (int c = 0; c < components; ++c) text += line(" -5  C%-7d%5d%5d%5d%5d", c, 1, 2, c, 0);
    text += line(" -5  ALL     %5d%5d%5d%5d%5dALL", 1, 2, 0, 0, 1);
    for (std::size_t n = 1; n <= nodes; ++n) {
        for (int c = 0; c < components; ++c) {
            std::string number = c == 0 ? line(" -1%10d", static_cast<int>(n)) : c % 6 == 0 ? line(" -2%10s", "") : "\n";
            if (c % 6 == 0 && c > 0) text += "\n";
            text += number.substr(0, number.size() - 1);
            number = line("%12.5E", -factor * static_cast<double>(n) - c);
            text += number.substr(0, number.size() - 1);
        }
        text += "\n";
    }
    return text + " -3\n";
}

class Frd : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text, const ReadOptions& options = {}) const {
        return read_mesh(write("a.frd", text + " 9999\n"), options);
    }
    [[nodiscard]] std::string error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

TEST_F(Frd, NodesElementsAndResultsOfEachStep) {
    const HexMesh mesh = make_box(2, 1, 1);
    for (const bool wide : {false, true}) {
        std::string text = "    1C\n    1UUSER\n" + nodes_of(mesh, wide) + elements_of(mesh, wide);
        EXPECT_EQ(read(text).mesh.cells, mesh.cells);
        for (int step = 1; step <= 3; ++step) {
            text += result_of("DISP", 12, 3, .5 * step, step, step) + result_of("STRESS", 12, 8, .5 * step, step, 10 * step);
        }
        const ReadResult last = read(text);
        EXPECT_EQ(last.mesh.points, mesh.points);
        EXPECT_THAT(last.warnings, ElementsAre("the file has 3 steps; the last one is read"));
        EXPECT_THAT(open_series(path("a.frd")).times, ElementsAre(.5, 1, 1.5));
        for (std::size_t k = 0; k < 3; ++k) {
            const ReadResult result = read(text, {.step = k});
            EXPECT_EQ(result.fields.size(), 2u);
            const Attribute& moved = *result.mesh.find_attribute("DISP");
            EXPECT_EQ(moved.channels, 3);
            EXPECT_EQ(moved.values[3 * 6 + 2], -7. * static_cast<double>(k + 1) - 2);
            const Attribute& stress = *result.mesh.find_attribute("STRESS");
            EXPECT_EQ(stress.channels, 8);
            EXPECT_EQ(stress.values[8 * 6 + 7], -70. * static_cast<double>(k + 1) - 7);  // on a second line
        }
    }
}

template <class Number>
void append_bytes(std::string& text, Number number) {
    text.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// The same in binary: the heads of lists stay text, records follow without an end.
std::string binary_mesh(const HexMesh& mesh, bool doubles) {
    std::string text = line("    2C                  %12d                                     %d",
                            static_cast<int>(mesh.points.size()), doubles ? 3 : 2);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        append_bytes(text, static_cast<std::int32_t>(p + 1));
        for (int k = 0; k < 3; ++k) {
            if (doubles) append_bytes(text, mesh.points[p][k]);
            if (!doubles) append_bytes(text, static_cast<float>(mesh.points[p][k]));
        }
    }
    text += line("    3C                  %12d                                     2", static_cast<int>(mesh.cells.size()));
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const int number : {static_cast<int>(c + 1), 1, 0, 1}) append_bytes(text, static_cast<std::int32_t>(number));
        for (const Index p : mesh.cells[c]) append_bytes(text, static_cast<std::int32_t>(p + 1));
    }
    return text;
}

std::string binary_result(const std::string& name, std::size_t nodes, int components, double time, int step) {
    std::string text =
        line("    1PSTEP                %12d           1           1", step) +
        line("  100CL  101%12.5E%12d                     0%5d           2", time, static_cast<int>(nodes), step) +
        line(" -4  %-8s%5d%5d", name.c_str(), components + 1, 1);
    for (int c = 0; c < components; ++c) text += line(" -5  C%-7d%5d%5d%5d%5d", c, 1, 2, c, 0);
    text += line(" -5  ALL     %5d%5d%5d%5d%5dALL", 1, 2, 0, 0, 1);
    for (std::size_t n = 1; n <= nodes; ++n) {
        append_bytes(text, static_cast<std::int32_t>(n));
        for (int c = 0; c < components; ++c) append_bytes(text, static_cast<float>(step * 100 + static_cast<int>(n) * 10 + c));
    }
    return text;
}

TEST_F(Frd, BinaryFilesOfFloatsAndDoubles) {
    const HexMesh mesh = make_box(2, 1, 1);
    for (const bool doubles : {false, true}) {
        std::string text = "    1C\n    1UUSER\n" + binary_mesh(mesh, doubles);
        for (int step = 1; step <= 2; ++step) {
            text += binary_result("DISP", 12, 3, .5 * step, step) + binary_result("STRESS", 12, 6, .5 * step, step);
        }
        EXPECT_THAT(open_series(write("a.frd", text + " 9999\n")).times, ElementsAre(.5, 1));
        for (std::size_t k = 0; k < 2; ++k) {
            const ReadResult result = read(text, {.step = k});
            EXPECT_EQ(result.mesh.points, mesh.points);
            EXPECT_EQ(result.mesh.cells, mesh.cells);
            EXPECT_EQ(result.mesh.find_attribute("DISP")->values[3 * 6 + 2], 100. * static_cast<double>(k + 1) + 72);
            EXPECT_EQ(result.mesh.find_attribute("STRESS")->values[6 * 11 + 5], 100. * static_cast<double>(k + 1) + 125);
        }
        EXPECT_THAT(error(text.substr(0, text.size() - 30)), HasSubstr("values: the file ends"));
        EXPECT_THAT(error(binary_mesh(mesh, doubles).substr(0, 200)), HasSubstr("a node: the file ends"));
    }
}

TEST_F(Frd, WrongFilesGetASentenceWithTheLine) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::string nodes = nodes_of(mesh), elements = elements_of(mesh);
    EXPECT_THAT(error("no results\n"), HasSubstr("not a file of CalculiX's results"));
    EXPECT_THAT(error(nodes), HasSubstr("a.frd: no hexahedra"));
    std::string bad = nodes + elements;
    EXPECT_THAT(error(bad.replace(bad.find(" -2         1"), 13, " -2         9")),
                HasSubstr("a.frd, line 13: element 1: there is no node 9"));
    bad = nodes + elements;
    EXPECT_THAT(error(bad.replace(bad.find(" -1         1    1"), 18, " -1         1   13")),
                HasSubstr("element 1 is of type 13 (types are 1 to 12)"));
    bad = nodes + elements;
    EXPECT_THAT(error(bad.replace(bad.find(" -1         1    1"), 18, " -1         1    4")),
                HasSubstr("element 1 of type he20 has 8 nodes (20 are needed)"));
    bad = nodes;
    EXPECT_THAT(error(bad.replace(bad.find("0.00000E+00"), 11, "     zero  ") + elements),
                HasSubstr("line 2: a coordinate is expected, not \"zero\""));
    bad = nodes;
    bad[bad.find('\n') - 1] = '4';
    EXPECT_THAT(error(bad), HasSubstr("line 1: the format of the list is \"4\" (0 and 1 are text, 2 and 3 are binary"));
    EXPECT_THAT(error(nodes + elements + result_of("T", 9, 1, 0, 1, 1)), HasSubstr("there is no node 9"));
    const ReadResult partial = read(nodes + elements + result_of("T", 7, 1, 0, 1, 1));
    EXPECT_THAT(partial.warnings,
                ElementsAre("field \"T\" has no value at 1 of 8 nodes, and no cell has it at all of its points"));
    EXPECT_EQ(partial.fields.at(0).min, -7);
}

// As *EL FILE, NSET=…: a result of the first nodes alone. Nodes are numbered along x, then y, then z.
TEST_F(Frd, ResultsAtSomeNodesAreThoseOfTheElementsThere) {
    const HexMesh mesh = make_box(1, 1, 3);
    const ReadResult result =
        read(nodes_of(mesh) + elements_of(mesh) + result_of("S", 12, 1, 0, 1, 1) + result_of("T", 16, 1, 0, 1, 2));
    ASSERT_EQ(result.mesh.attributes.size(), 1U);
    ASSERT_EQ(result.incomplete.size(), 1U);
    EXPECT_EQ(result.incomplete[0].name, "S");
    EXPECT_EQ(result.incomplete[0].values[11], -12);
    EXPECT_TRUE(std::isnan(result.incomplete[0].values[12]));
    EXPECT_THAT(result.warnings,
                ElementsAre("field \"S\" has no value at 4 of 16 nodes: asked for by its name, it is that of the "
                            "2 of 3 cells that have it; otherwise it is left out"));
}

using FrdFuzz = MeshFuzz;

TEST_F(Frd, ResultsWithoutNodesAreSaid) {
    write("a.frd", "    1C\n  100CL  101 5.00000E-01           8                     0    1           1\n");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.frd"))); }),
                testing::HasSubstr("it has results, but no nodes before them"));
}

TEST_F(FrdFuzz, WithResults) {
    const HexMesh mesh = make_box(1, 1, 1);
    expect_sound_or_refused(".frd", binary_mesh(mesh, true) + binary_result("DISP", 8, 3, 0, 1) + " 9999\n", 34);
    expect_sound_or_refused(".frd", nodes_of(mesh) + elements_of(mesh) + result_of("DISP", 8, 3, 0, 1, 1) + " 9999\n", 33);
}

// The deck of a beam of curved elements and its results are of one mesh.
TEST_F(Frd, RealFiles) {
    if (!beside_data("series/beamp.frd")) GTEST_SKIP() << "no series/beamp.frd beside the folder that SUBVOL_DATA names";
    const auto folder = *beside_data("series");
    const ReadResult beam = read_mesh(folder / "beamp.frd"), deck = read_mesh(folder / "beamp.inp");
    EXPECT_EQ(read_mesh(folder / "beamp.frd", {.curved_tolerance = std::nullopt}).mesh.cells.size(), deck.mesh.cells.size());
    EXPECT_NEAR(inspect(beam.mesh).volume, inspect(deck.mesh).volume, 1e-4 * inspect(deck.mesh).volume);
    EXPECT_EQ(beam.mesh.find_attribute("DISP")->channels, 3);
    const ReadResult forming = read_mesh(folder / "metalforming.frd"), of_deck = read_mesh(folder / "metalforming.inp");
    EXPECT_NEAR(inspect(forming.mesh).volume, inspect(of_deck.mesh).volume, 1e-4 * inspect(of_deck.mesh).volume);
}

}  // namespace frd_test

}  // namespace subvol::test
