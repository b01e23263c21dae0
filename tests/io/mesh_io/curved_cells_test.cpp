// SPDX-License-Identifier: Apache-2.0
// Curved hexahedra: a quarter of a tube, radii 1 and 2, height 1, in the node orders of all formats.

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "lib/temp_folder.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace curved_cells_test {

using testing::Contains;
using testing::HasSubstr;
using Place = std::array<int, 3>;

constexpr double kVolume = 3 * std::numbers::pi / 4;

// The place in the tube of a place in its unit cube: radius, angle, height.
Vec3 in_tube(const Vec3& u) {
    const double r = 1 + u.x, angle = std::numbers::pi / 2 * u.y;
    return {r * std::cos(angle), r * std::sin(angle), u.z};
}

double field(const Vec3& x) {
    return x.x * x.y + x.z * x.z - x.x / 2;
}

constexpr std::array<Place, 8> kCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
constexpr std::array<Place, 12> kVtkEdges{{{1, 0, 0},
                                           {2, 1, 0},
                                           {1, 2, 0},
                                           {0, 1, 0},
                                           {1, 0, 2},
                                           {2, 1, 2},
                                           {1, 2, 2},
                                           {0, 1, 2},
                                           {0, 0, 1},
                                           {2, 0, 1},
                                           {2, 2, 1},
                                           {0, 2, 1}}};
constexpr std::array<Place, 6> kFaces{{{0, 1, 1}, {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}}};

std::vector<Place> corners(int p, int q, int r) {
    std::vector<Place> places;
    for (const Place& c : kCorners) places.push_back({c[0] * p, c[1] * q, c[2] * r});
    return places;
}

template <class List>
void append(std::vector<Place>& to, const List& list) {
    to.insert(to.end(), list.begin(), list.end());
}

// VTK's quadratic hexahedra, from its documentation.
std::vector<Place> quadratic(std::size_t nodes) {
    std::vector<Place> places = corners(2, 2, 2);
    append(places, kVtkEdges);
    append(places, kFaces);
    places.push_back({1, 1, 1});
    if (nodes == 24) places.erase(places.begin() + 24, places.end());
    if (nodes == 20) places.resize(20);
    return places;
}

// VTK's vtkHigherOrderHexahedron::PointIndexFromIJK, the other way round. old: before VTK 9
std::vector<Place> lagrange(int p, int q, int r, bool old = false) {
    std::vector<Place> places = corners(p, q, r);
    for (const int k : {0, r}) {
        for (int i = 1; i < p; ++i) places.push_back({i, 0, k});
        for (int j = 1; j < q; ++j) places.push_back({p, j, k});
        for (int i = 1; i < p; ++i) places.push_back({i, q, k});
        for (int j = 1; j < q; ++j) places.push_back({0, j, k});
    }
    std::array<Place, 4> standing{{{0, 0, 0}, {p, 0, 0}, {p, q, 0}, {0, q, 0}}};
    if (old) std::swap(standing[2], standing[3]);
    for (const Place& at : standing) {
        for (int k = 1; k < r; ++k) places.push_back({at[0], at[1], k});
    }
    for (int k = 1; k < r; ++k) {
        for (int j = 1; j < q; ++j) places.push_back({0, j, k});
    }
    for (int k = 1; k < r; ++k) {
        for (int j = 1; j < q; ++j) places.push_back({p, j, k});
    }
    for (const int j : {0, q}) {
        for (int k = 1; k < r; ++k) {
            for (int i = 1; i < p; ++i) places.push_back({i, j, k});
        }
    }
    for (const int k : {0, r}) {
        for (int j = 1; j < q; ++j) {
            for (int i = 1; i < p; ++i) places.push_back({i, j, k});
        }
    }
    for (int k = 1; k < r; ++k) {
        for (int j = 1; j < q; ++j) {
            for (int i = 1; i < p; ++i) places.push_back({i, j, k});
        }
    }
    return places;
}

// A tube of `around` cells in each quarter. Neighbours share the nodes that are at the same place.
struct Tube {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> cells;
    std::vector<double> values;

    Tube(const std::vector<Place>& places, int around, Place degrees, const std::function<Vec3(const Vec3&)>& shape = in_tube) {
        std::map<Place, std::size_t> known;
        for (int c = 0; c < around; ++c) {
            auto& cell = cells.emplace_back();
            for (const Place& place : places) {
                const Place at{place[0], place[1] + c * degrees[1], place[2]};
                const auto [node, is_new] = known.try_emplace(at, points.size());
                if (is_new) {
                    points.push_back(
                        shape({at[0] / static_cast<double>(degrees[0]), at[1] / static_cast<double>(degrees[1] * around),
                               at[2] / static_cast<double>(degrees[2])}));
                    values.push_back(field(points.back()));
                }
                cell.push_back(node->second);
            }
        }
    }
};

template <class Value>
std::string array(const std::string& type, const std::string& attributes, const std::vector<Value>& values) {
    std::string text = "<DataArray type=\"" + type + "\" " + attributes + " format=\"ascii\">";
    for (const auto& value : values) text += number(static_cast<double>(value)) + " ";
    return text + "</DataArray>";
}

// version: of the file; degrees: in an array, if given
std::string vtu(const Tube& tube, int type, const std::string& version, const std::vector<int>& degrees = {},
                const std::string& point_data = "") {
    std::vector<double> coordinates;
    for (const Vec3& x : tube.points) coordinates.insert(coordinates.end(), {x.x, x.y, x.z});
    std::vector<std::size_t> connectivity, offsets;
    for (const auto& cell : tube.cells) {
        connectivity.insert(connectivity.end(), cell.begin(), cell.end());
        offsets.push_back(connectivity.size());
    }
    std::vector<int> all_degrees;
    for (std::size_t c = 0; c < tube.cells.size(); ++c) all_degrees.insert(all_degrees.end(), degrees.begin(), degrees.end());
    const std::string cell_data =
        degrees.empty() ? "" : array("Float64", "Name=\"HigherOrderDegrees\" NumberOfComponents=\"3\"", all_degrees);
    return "<VTKFile type=\"UnstructuredGrid\" version=\"" + version + "\"><UnstructuredGrid><Piece NumberOfPoints=\"" +
           std::to_string(tube.points.size()) + "\" NumberOfCells=\"" + std::to_string(tube.cells.size()) + "\"><Points>" +
           array("Float64", "NumberOfComponents=\"3\"", coordinates) + "</Points><Cells>" +
           array("Int64", "Name=\"connectivity\"", connectivity) + array("Int64", "Name=\"offsets\"", offsets) +
           array("UInt8", "Name=\"types\"", std::vector<int>(tube.cells.size(), type)) + "</Cells><PointData>" +
           array("Float64", "Name=\"f\"", tube.values) + point_data + "</PointData><CellData>" + cell_data +
           "</CellData></Piece></UnstructuredGrid></VTKFile>";
}

std::string gmsh(const Tube& tube, int type) {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(tube.points.size()) + "\n", data;
    for (std::size_t p = 0; p < tube.points.size(); ++p) {
        const Vec3 x = tube.points[p];
        text += std::to_string(p + 1) + " " + number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
        data += std::to_string(p + 1) + " " + number(tube.values[p]) + "\n";
    }
    text += "$EndNodes\n$Elements\n" + std::to_string(tube.cells.size()) + "\n";
    for (std::size_t c = 0; c < tube.cells.size(); ++c) {
        text += std::to_string(c + 1) + " " + std::to_string(type) + " 0";
        for (const std::size_t p : tube.cells[c]) text += " " + std::to_string(p + 1);
        text += "\n";
    }
    return text + "$EndElements\n$NodeData\n1\nf\n0\n3\n0\n1\n" + std::to_string(tube.points.size()) + "\n" + data +
           "$EndNodeData\n";
}

// How far the polynomial of a degree through equidistant points in an interval is from a function whose next derivative is 1.
double interpolation_error(int degree, double length) {
    double largest = 0, factorial = 1;
    for (int k = 1; k <= degree + 1; ++k) factorial *= k;
    for (int i = 0; i <= 1000; ++i) {
        double product = 1;
        for (int node = 0; node <= degree; ++node) product *= length * (i / 1000. - node / static_cast<double>(degree));
        largest = std::max(largest, std::abs(product));
    }
    return largest / factorial;
}

constexpr double kSixteenth = std::numbers::pi / 8, kEighth = std::numbers::pi / 4;  // of a circle

class CurvedCells : public TempFolder {
protected:
    // Expects the tube with its field. degree: of the nodes' polynomials along the arc; angle: of a cell; faces: whether there
    // are nodes in the middle of faces and cells
    void expect_tube(const std::string& name, const std::string& text, int degree, double angle, bool faces = true) const {
        constexpr double kTolerance = 1e-4;
        // A polynomial through equidistant nodes on the arc is off by the next derivative of the coordinates, 2 at most; the
        // field r²/2 sin 2θ + … also by its own, and by its gradient, less than 3, times the error of the place. Without nodes
        // in the middle of faces the field's term r²θ², whose factor is 1, is off by up to angle²/16.
        const double shape_error = 2 * interpolation_error(degree, angle);
        const double field_error = 2 * std::pow(2, degree + 1) * interpolation_error(degree, angle) + 3 * shape_error +
                                   (faces ? 0 : angle * angle / 16);
        const ReadResult result = read_mesh(write(name, text), {.curved_tolerance = kTolerance});
        const MeshReport report = inspect(result.mesh);
        EXPECT_EQ(report.inverted_cells, 0u) << result.warnings[0];
        EXPECT_EQ(report.points_used, report.points);
        // Chords lie within the tolerance times the diagonal, 3, on a boundary of 3π/2 · 1.
        EXPECT_NEAR(report.volume, kVolume, 3 * kTolerance * 4.8 + 3 * shape_error);  // two arcs, 3π/2 long
        const Attribute* f = result.mesh.find_attribute("f");
        ASSERT_NE(f, nullptr);
        std::set<std::array<double, 3>> places;
        for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
            const Vec3 x = result.mesh.points[p];
            const double r = std::hypot(x.x, x.y);
            EXPECT_TRUE(r > 1 - shape_error && r < 2 + shape_error) << r;
            EXPECT_NEAR(f->values[p], field(x), field_error);
            places.insert({x.x, x.y, x.z});
        }
        EXPECT_EQ(places.size(), result.mesh.points.size());  // neighbours share their points
    }
};

TEST_F(CurvedCells, QuadraticOnesOfVtk) {
    for (const auto& [nodes, type] :
         std::vector<std::pair<std::size_t, int>>{{20, 25}, {24, 33}, {27, 29}, {20, 12}, {27, 12}}) {
        expect_tube("a.vtu", vtu(Tube(quadratic(nodes), 4, {2, 2, 2}), type, "0.1"), 2, kSixteenth, nodes == 27);
    }
    expect_tube("a.vtu", vtu(Tube(quadratic(27), 4, {2, 2, 2}), 72, "2.2"), 2, kSixteenth);
}

TEST_F(CurvedCells, LagrangeOnesOfAllDegreesAndVersions) {
    for (const bool old : {false, true}) {
        for (const Place degrees : {Place{2, 3, 3}, Place{4, 4, 4}, Place{3, 5, 2}}) {
            const auto places = lagrange(degrees[0], degrees[1], degrees[2], old);
            const Tube tube(places, 2, degrees);
            const std::vector<int> list(degrees.begin(), degrees.end());
            for (const std::string version : old ? std::vector{"0.1", "1.0", "2.0"} : std::vector{"2.1", "2.2", "2.3"}) {
                expect_tube("a.vtu", vtu(tube, 72, version, list), degrees[1], kEighth);
            }
        }
    }
}

// In u and w the tube is straight; the rational arc is a circle, and a field of equal control values along it is the radius.
TEST_F(CurvedCells, RationalBezierOnesAreExact) {
    const auto places = lagrange(1, 2, 1);
    const double half = std::numbers::pi / 8;
    Tube tube(places, 2, {1, 2, 1}, [&](const Vec3& u) {
        const Vec3 x = in_tube(u);
        const bool middle = std::abs(std::remainder(u.y - .25, .5)) < 1e-9;
        return middle ? Vec3(x.x / std::cos(half), x.y / std::cos(half), x.z) : x;
    });
    std::vector<double> weights, radius;
    for (const Vec3& x : tube.points) {
        const double r = std::hypot(x.x, x.y);
        const bool middle = std::abs(r - std::round(r)) > 1e-9;
        weights.push_back(middle ? std::cos(half) : 1);
        radius.push_back(middle ? r * std::cos(half) : r);
    }
    tube.values = radius;
    const std::string text = vtu(tube, 79, "2.2", {1, 2, 1}, array("Float64", "Name=\"RationalWeights\"", weights));
    const ReadResult result = read_mesh(write("a.vtu", text));
    EXPECT_NEAR(inspect(result.mesh).volume, kVolume, 1e-5);
    ASSERT_EQ(result.mesh.attributes.size(), 1u);
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
        const Vec3 x = result.mesh.points[p];
        EXPECT_NEAR(std::hypot(x.x, x.y), result.mesh.attributes[0].values[p], 1e-14);
    }
    weights[3] = -1;
    const std::string negative = vtu(tube, 79, "2.2", {1, 2, 1}, array("Float64", "Name=\"RationalWeights\"", weights));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(write("a.vtu", negative))); }),
                HasSubstr("the rational weight of point 3 is -1 (a positive number)"));
}

// Gmsh's documentation draws the quadratic ones; in higher orders the inside of a face or cell is again one of lower order.
TEST_F(CurvedCells, OfGmsh) {
    std::vector<Place> places = corners(2, 2, 2);
    append(places, std::vector<Place>{{1, 0, 0},
                                      {0, 1, 0},
                                      {0, 0, 1},
                                      {2, 1, 0},
                                      {2, 0, 1},
                                      {1, 2, 0},
                                      {2, 2, 1},
                                      {0, 2, 1},
                                      {1, 0, 2},
                                      {0, 1, 2},
                                      {2, 1, 2},
                                      {1, 2, 2}});
    expect_tube("a.msh", gmsh(Tube(places, 4, {2, 2, 2}), 17), 2, kSixteenth, false);
    append(places, std::vector<Place>{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}, {1, 1, 1}});
    expect_tube("a.msh", gmsh(Tube(places, 4, {2, 2, 2}), 12), 2, kSixteenth);
    places = corners(3, 3, 3);
    const std::vector<std::array<Place, 2>> edges{
        {{{0, 0, 0}, {1, 0, 0}}}, {{{0, 0, 0}, {0, 1, 0}}},  {{{0, 0, 0}, {0, 0, 1}}}, {{{3, 0, 0}, {0, 1, 0}}},
        {{{3, 0, 0}, {0, 0, 1}}}, {{{3, 3, 0}, {-1, 0, 0}}}, {{{3, 3, 0}, {0, 0, 1}}}, {{{0, 3, 0}, {0, 0, 1}}},
        {{{0, 0, 3}, {1, 0, 0}}}, {{{0, 0, 3}, {0, 1, 0}}},  {{{3, 0, 3}, {0, 1, 0}}}, {{{3, 3, 3}, {-1, 0, 0}}}};
    for (const auto& [from, step] : edges) {
        for (int t = 1; t < 3; ++t) {
            places.push_back({from[0] + t * step[0], from[1] + t * step[1], from[2] + t * step[2]});
        }
    }
    append(places, std::vector<Place>{{1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 0, 1}, {2, 0, 1}, {2, 0, 2}, {1, 0, 2},
                                      {0, 1, 1}, {0, 1, 2}, {0, 2, 2}, {0, 2, 1}, {3, 1, 1}, {3, 2, 1}, {3, 2, 2}, {3, 1, 2},
                                      {2, 3, 1}, {1, 3, 1}, {1, 3, 2}, {2, 3, 2}, {1, 1, 3}, {2, 1, 3}, {2, 2, 3}, {1, 2, 3}});
    for (const Place& c : kCorners) places.push_back({1 + c[0], 1 + c[1], 1 + c[2]});
    expect_tube("a.msh", gmsh(Tube(places, 2, {3, 3, 3}), 92), 3, kEighth);
}

TEST_F(CurvedCells, TheErrorIsSaidAndFallsWithTheTolerance) {
    const std::string text = vtu(Tube(quadratic(27), 4, {2, 2, 2}), 29, "0.1");
    std::size_t before = 0;
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
        const ReadResult result = read_mesh(write("a.vtu", text), {.curved_tolerance = tolerance});
        EXPECT_GT(result.mesh.cells.size(), before);
        before = result.mesh.cells.size();
        ASSERT_THAT(result.warnings[0], HasSubstr("4 curved cells split into"));
        const std::size_t at = result.warnings[0].find("is within ");
        EXPECT_LE(std::stod(result.warnings[0].substr(at + 10)), 1.01 * tolerance);
    }
    const ReadResult most = read_mesh(write("a.vtu", text), {.curved_tolerance = 1e-12});
    EXPECT_LE(most.mesh.cells.size(), std::size_t{1} << 16);
    EXPECT_GT(most.mesh.cells.size(), std::size_t{1} << 15);
    EXPECT_THAT(most.warnings[0], HasSubstr("for a tolerance of 1.0e-12 there would be more than 65536"));
    const ReadResult corners = read_mesh(write("a.vtu", text), {.curved_tolerance = std::nullopt});
    EXPECT_EQ(corners.mesh.cells.size(), 4u);
    for (const double tolerance : {0., -1.}) {
        EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.vtu"), {.curved_tolerance = tolerance})); }),
                    HasSubstr("curved cells cannot be followed to within"));
    }
}

TEST_F(CurvedCells, OfWrongDegreesAreRefused) {
    const Tube tube(lagrange(2, 3, 2), 1, {2, 3, 2});
    const auto error = [&](const std::vector<int>& degrees) {
        return error_of([&] { static_cast<void>(read_mesh(write("a.vtu", vtu(tube, 72, "2.2", degrees)))); });
    };
    EXPECT_THAT(error({}), HasSubstr("cell 0 has 36 points, and there is no array \"HigherOrderDegrees\""));
    EXPECT_THAT(error({2, 2, 2}), HasSubstr("cell 0 has 36 points, but the degrees 2 2 2 in \"HigherOrderDegrees\""));
    EXPECT_THAT(error({0, 3, 2}), HasSubstr("but the degrees 0 3 2"));
    EXPECT_THAT(error({-4, 1000000000, 2}), HasSubstr("but the degrees -4"));
    EXPECT_EQ(error({2, 3, 2}), "no error");
}

TEST_F(CurvedCells, BesideOtherCellsGiveTheirCorners) {
    Tube tube(quadratic(20), 1, {2, 2, 2});
    std::string text = vtu(tube, 25, "0.1");
    const auto with = [&](const std::string& from, const std::string& to) { text.replace(text.find(from), from.size(), to); };
    with("NumberOfCells=\"1\"", "NumberOfCells=\"2\"");
    with(" </DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">20 ",
         " 0 1 2 8 </DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">20 24 ");
    with("format=\"ascii\">25 ", "format=\"ascii\">25 10 ");
    EXPECT_THAT(read_mesh(write("a.vtu", text)).warnings,
                Contains("1 curved cell beside cells of other kinds: only the corners are used"));
}

}  // namespace curved_cells_test

}  // namespace subvol::test
