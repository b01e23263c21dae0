// SPDX-License-Identifier: Apache-2.0
#include "subvol/quantity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace quantity_test {

HexMesh mesh_with_fields() {
    HexMesh mesh = test::make_box(2, 1, 1);
    Attribute temp{"Temp", 1, {}}, v{"V", 3, {}}, odd{"von Mises", 1, {}};
    for (const Vec3& p : mesh.points) {
        temp.values.push_back(293 + 620 * p.x / 2);
        v.values.insert(v.values.end(), {p.x, 2 * p.y, 3});
        odd.values.push_back(p.z);
    }
    mesh.attributes = {temp, v, odd};
    return mesh;
}

TEST(Quantity, ComputesFromFieldsAndCoordinates) {
    const HexMesh mesh = mesh_with_fields();
    const Attribute heat = field_of(mesh, "heat", "(Temp-293)/620");
    EXPECT_EQ(heat.name, "heat");
    const Attribute mixed = field_of(mesh, "m", "V.x + V.1*10 + length(V) + V + z");
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        EXPECT_NEAR(heat.values[p], x.x / 2, 1e-14);
        EXPECT_NEAR(mixed.values[p], x.x + 20 * x.y + 2 * std::hypot(x.x, 2 * x.y, 3) + x.z, 1e-13);
    }
}

TEST(Quantity, ANameIsTheFieldItself) {
    const HexMesh mesh = mesh_with_fields();
    const Attribute v = field_of(mesh, "vel", "V"), odd = field_of(mesh, "stress", "von Mises");
    EXPECT_EQ(v.channels, 3) << "a vector stays one";
    EXPECT_EQ(v.values, mesh.attributes[1].values);
    EXPECT_EQ(odd.name, "stress");
    EXPECT_EQ(odd.values, mesh.attributes[2].values);
    EXPECT_EQ(field_of(mesh, "height", "z").values, mesh.attributes[2].values) << "a coordinate";
}

/// A cube of 4³ cells, a little distorted inside, with a stress of made-up values, and linear and quadratic fields.
HexMesh mesh_with_tensors() {
    HexMesh mesh = test::make_box(4, 4, 4);
    Attribute stress{"STRESS", 6, {}}, full{"G", 9, {}}, linear{"T", 1, {}}, flow{"U", 3, {}}, odd{"alpha.water", 1, {}};
    for (const Vec3& p : mesh.points) {
        stress.values.insert(stress.values.end(), {p.x, 2 * p.y, 3, 4 * p.z, 5, p.x * p.y});
        full.values.insert(full.values.end(), {1, p.x, 2, p.y, 3, 4, 5, p.z, 6});
        linear.values.push_back(3 + 2 * p.x - p.y + 0.5 * p.z);
        flow.values.insert(flow.values.end(), {2 * p.y - p.z, p.x + 3 * p.y, 4 * p.z - p.x});
        odd.values.push_back(p.x / 4);
    }
    mesh.attributes = {stress, full, linear, flow, odd};
    return mesh;
}

TEST(Quantity, InvariantsOfTensors) {
    const HexMesh mesh = mesh_with_tensors();
    const auto at = [&](const std::string& source) { return field_of(mesh, "q", source).values; };
    const auto mises = at("mises(STRESS)"), trace = at("trace(STRESS)"), det = at("det(STRESS)"), norm = at("length(STRESS)");
    const auto p1 = at("principal1(STRESS)"), p2 = at("principal2(STRESS)"), p3 = at("principal3(STRESS)");
    const auto tresca = at("tresca(STRESS)"), hydrostatic = at("hydrostatic(STRESS)"), full = at("det(G)");
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double* s = &mesh.attributes[0].values[6 * p];
        EXPECT_NEAR(p1[p] + p2[p] + p3[p], trace[p], 1e-12);
        EXPECT_NEAR(trace[p], s[0] + s[1] + s[2], 1e-12);
        EXPECT_NEAR(p1[p] * p2[p] * p3[p], det[p], 1e-10);
        EXPECT_NEAR(p1[p] * p1[p] + p2[p] * p2[p] + p3[p] * p3[p], norm[p] * norm[p], 1e-10);
        EXPECT_GE(p1[p], p2[p]);
        EXPECT_GE(p2[p], p3[p]);
        EXPECT_NEAR(tresca[p], p1[p] - p3[p], 1e-12);
        EXPECT_NEAR(hydrostatic[p], trace[p] / 3, 1e-13);
        const double a = p1[p] - p2[p], b = p2[p] - p3[p], c = p3[p] - p1[p];
        EXPECT_NEAR(mises[p], std::sqrt((a * a + b * b + c * c) / 2), 1e-10);
        const Vec3& x = mesh.points[p];
        EXPECT_NEAR(full[p], 3 * 6 - 4 * x.z - x.x * (6 * x.y - 20) + 2 * (x.y * x.z - 15), 1e-10);
    }
}

TEST(Quantity, DerivativesOfLinearFieldsAreExact) {
    HexMesh mesh = mesh_with_tensors();
    const HexMesh straight = mesh;
    for (Vec3& p : mesh.points) p = {2 * p.x + 0.3 * p.y, p.y - 0.2 * p.z, 0.5 * p.z};  // the fields stay linear
    const auto at = [&](const std::string& source) { return field_of(mesh, "q", source); };
    const Attribute slope = field_of(straight, "q", "grad(T)"), rotation = field_of(straight, "q", "curl(U)");
    ASSERT_EQ(slope.channels, 3);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(slope.values[3 * p], 2, 1e-9);
        EXPECT_NEAR(slope.values[3 * p + 1], -1, 1e-9);
        EXPECT_NEAR(slope.values[3 * p + 2], 0.5, 1e-9);
        EXPECT_NEAR(rotation.values[3 * p], 0, 1e-9);
        EXPECT_NEAR(rotation.values[3 * p + 1], 0, 1e-9);
        EXPECT_NEAR(rotation.values[3 * p + 2], -1, 1e-9);
    }
    // Through a linear map A, the gradient becomes A⁻ᵀ of it.
    const Attribute moved = at("grad(T).z");
    for (const double value : moved.values) EXPECT_NEAR(value, (0.5 + (-1 - 2 * 0.3 / 2) * 0.2) / 0.5, 1e-9);
    const auto flow = [&](const std::string& source) { return field_of(straight, "q", source).values; };
    const auto divergence = flow("div(U)"), element = flow("grad(U).xy"), q = flow("qcriterion(U)");
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(divergence[p], 7, 1e-9);
        EXPECT_NEAR(element[p], 2, 1e-9) << "of U.x by y";
        EXPECT_NEAR(q[p], -(3. * 3 + 4 * 4) / 2 - (2 * 1 + 1), 1e-8);
    }
    EXPECT_EQ(flow("vorticity(U).z"), flow("curl(U).z"));
}

TEST(Quantity, NamesComponentsAndOddNames) {
    const HexMesh mesh = mesh_with_tensors();
    const auto at = [&](const std::string& source) { return field_of(mesh, "q", source).values; };
    EXPECT_EQ(at("STRESS.xz"), at("STRESS.5"));
    EXPECT_EQ(at("STRESS.zx"), at("STRESS.xz"));
    EXPECT_EQ(at("G.yz"), at("G.5"));
    EXPECT_EQ(at("alpha.water"), mesh.attributes[4].values);
    EXPECT_EQ(at("`alpha.water`"), mesh.attributes[4].values);
    const auto twice = at("alpha.water*2"), quoted = at("2*`alpha.water`"), nested = at("length(grad(alpha.water))*4");
    for (std::size_t p = 0; p < twice.size(); ++p) {
        EXPECT_EQ(twice[p], 2 * mesh.attributes[4].values[p]);
        EXPECT_NEAR(nested[p], 1, 1e-9);
    }
    EXPECT_EQ(twice, quoted);
    EXPECT_EQ(at("2*'alpha.water'"), twice);
    HexMesh step = mesh;
    step.time = 0.25;
    EXPECT_EQ(field_of(step, "q", "time*4+0*T").values, std::vector<double>(mesh.points.size(), 1.0));
    EXPECT_EQ(at("1e1*(T>=3)"), at("(T>=3)*10")) << "an exponent is no name";
    EXPECT_EQ(select_field(mesh, "STRESS").scalar.name, "mises(STRESS)");
    EXPECT_EQ(select_field(mesh, "STRESS").scalar.values, at("mises(STRESS)"));
    EXPECT_EQ(select_field(mesh, "grad(T)").scalar.values, at("length(grad(T))"));
    EXPECT_TRUE(has_derivatives("2*grad(T).x"));
    EXPECT_FALSE(has_derivatives("upgrad(T)+div"));
}

/// A box with scalars whose names say that they are components; tensor: the names of its six.
HexMesh mesh_of_scalars(const std::vector<std::string>& tensor) {
    HexMesh mesh = test::make_box(1, 1, 1);
    const std::vector<double> values{100, -50, 40, 30, 10, 20};  // xx, yy, zz, xy, yz, xz
    for (std::size_t c = 0; c < tensor.size(); ++c) {
        mesh.attributes.push_back({tensor[c], 1, std::vector<double>(mesh.points.size(), values[c])});
    }
    for (const char axis : {'z', 'x', 'y'}) {
        Attribute& component = mesh.attributes.emplace_back(Attribute{std::string("disp_") + axis, 1, {}});
        for (const Vec3& p : mesh.points) component.values.push_back(p[axis - 'x'] + 2);
    }
    return mesh;
}

TEST(Quantity, ScalarsMakeVectorsAndTensors) {
    // Invariants of the tensor by numpy.linalg.eigvalsh.
    constexpr double kMises = 145.945195193264, kFirst = 112.215769359, kThird = -56.168127154;
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"stress_xx", "stress_yy", "stress_zz", "stress_xy", "stress_yz", "stress_xz"},
          {"stressXX", "stressYY", "stressZZ", "stressXY", "stressYZ", "stressZX"},
          {"stress:xx", "stress:yy", "stress:zz", "stress:yx", "stress:zy", "stress:zx"}}) {
        const HexMesh mesh = mesh_of_scalars(names);
        const auto value = [&](const std::string& source) { return field_of(mesh, "q", source).values.back(); };
        EXPECT_NEAR(value("mises(stress)"), kMises, 1e-10) << names[0];
        EXPECT_NEAR(value("principal1(stress)"), kFirst, 1e-8);
        EXPECT_NEAR(value("principal3(stress) + 0"), kThird, 1e-8);
        EXPECT_EQ(value("stress.zy"), 10);
        std::string made = "tensor(";
        for (const std::string& name : names) made += (made.back() == '(' ? "`" : ", `") + name + "`";
        EXPECT_NEAR(value("mises(" + made + "))"), kMises, 1e-10);
        EXPECT_EQ(select_field(mesh, "stress").scalar.name, "mises(stress)");
    }
    const HexMesh mesh = mesh_of_scalars({});
    const Attribute group = field_of(mesh, "q", "disp"), made = field_of(mesh, "q", "vector(x+2, disp_y, max(z+2, 0))");
    ASSERT_EQ(group.channels, 3);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(group.values[3 * p + c], mesh.points[p][static_cast<int>(c)] + 2);
            EXPECT_EQ(made.values[3 * p + c], group.values[3 * p + c]);
        }
    }
    EXPECT_EQ(field_of(mesh, "q", "disp.z").values, mesh.attributes[0].values);
    // A vector that other programs call by its components.
    const HexMesh vectors = mesh_with_fields();
    EXPECT_EQ(field_of(vectors, "q", "V_X").values, field_of(vectors, "q", "V.x").values);
    const Attribute nine = field_of(mesh, "q", "tensor(1,2,3,4,5,6,7,8,10)");
    EXPECT_EQ(nine.channels, 9);
    EXPECT_NEAR(field_of(mesh, "q", "det(tensor(1,2,3,4,5,6,7,8,10))").values[0], -3, 1e-12);
}

TEST(Quantity, WordsOfOtherPrograms) {
    const HexMesh mesh = mesh_with_tensors();
    const auto at = [&](const std::string& source) { return field_of(mesh, "q", source).values; };
    EXPECT_EQ(at("mag(U)"), at("length(U)"));
    EXPECT_EQ(at("U.magnitude"), at("length(U)"));
    EXPECT_EQ(at("vonMises(STRESS)"), at("mises(STRESS)"));
    EXPECT_EQ(at("mises"), at("mises(STRESS)")) << "the one stress of the mesh, although G is a tensor, too";
    EXPECT_EQ(at("2*tresca"), at("2*tresca(STRESS)"));
    EXPECT_EQ(at("STRESS.Mises"), at("mises(STRESS)"));
    EXPECT_EQ(at("gradient(T).y"), at("grad(T).y"));
    EXPECT_TRUE(has_derivatives("divergence(U)"));
    HexMesh two = mesh;
    two.attributes[1] = {"sigma", 6, mesh.attributes[0].values};
    const auto refused = [](const HexMesh& of, const std::string& part, const std::string& source) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)field_of(of, "f", source); });
    };
    refused(two, "'mises' is a function, of a field in parentheses", "mises");
    refused(mesh, "'vorticity' is a function", "vorticity");
    refused(mesh, "there is no function misses: did you mean mises?", "misses(STRESS)");
    refused(mesh, "vector takes x, y, z, not 2 scalars", "vector(T,x)");
    refused(mesh, "vector takes scalars, not one with 3 components", "vector(T,U,x)");
    refused(mesh, "tensor takes xx, yy, zz, xy, yz, xz", "trace(tensor(1,2,3))");
    refused(mesh, "is empty", "vector(1,,2)");
}

TEST(Quantity, SaysWhatATensorFunctionTakes) {
    const HexMesh mesh = mesh_with_tensors();
    const auto refused = [&](const std::string& part, const std::string& source) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)field_of(mesh, "f", source); });
    };
    refused("mises takes a tensor with 6 or 9 components, not one with 3", "1+mises(U)");
    refused("position 2", "1+mises(U)");
    refused("xx, yy, zz, xy, yz, xz", "2*length(STRESS)+`STRESS`.w");
    refused("a scalar has no component .x", "trace(STRESS).x");
    refused("did you mean STRESS", "mises(STRES)");
    refused("no closing parenthesis", "mises(STRESS");
    refused("no second `", "2*`T");
    refused("no time", "2*time");
    refused("takes a vector", "div(T)");
    std::string deep = "T";
    for (int k = 0; k < 20000; ++k) deep.insert(0, "length(").append(")");
    refused("more than 64 calls", deep);
}

TEST(Quantity, SaysWhatIsWrong) {
    const HexMesh mesh = mesh_with_fields();
    const auto refused = [&](const std::string& part, const std::string& source) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)field_of(mesh, "f", source); });
    };
    refused("did you mean Temp?", "temp");
    refused("position 2", "1+temp");
    refused("did you mean Temp?", "1+temp");
    refused("x, y, z, Temp, V", "1+temp");
    refused("not finite at point 0", "1/(Temp-293)");
    refused("several values", "Temp,V");
    refused("==", "x=3");
    refused("V.3", "V.3");
    refused("there is no field", "2*V.w");
    refused("", "");
}

TEST(Quantity, QualityIsThatOfTheCells) {
    // Two cells side by side, of which the second is sheared: its edges along y are (1, 1, 0), and the others have length 1.
    HexMesh mesh = test::make_box(2, 1, 1);
    for (Vec3& p : mesh.points) {
        if (p.x == 2 && p.y == 1) p.x = 3;
        if (p.x == 1 && p.y == 1) p.x = 2;
    }
    const Attribute quality = field_of(mesh, "quality", "quality"), aspect = field_of(mesh, "a", "aspect");
    EXPECT_TRUE(quality.constant);
    ASSERT_EQ(quality.cells.size(), 2u);
    EXPECT_NEAR(quality.cells[1], 1 / std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(aspect.cells[1], std::sqrt(2.0), 1e-12);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {  // points between the two cells have their mean
        if (mesh.points[p].y > 0) continue;
        const double mean = (quality.cells[0] + quality.cells[1]) / 2;
        const double x = mesh.points[p].x;
        EXPECT_NEAR(quality.values[p], x == 0 ? quality.cells[0] : x == 2 ? quality.cells[1] : mean, 1e-12);
    }
    EXPECT_EQ(field_of(mesh, "q", "scaled_jacobian").cells, quality.cells);
    EXPECT_EQ(field_of(mesh, "q", "aspect_ratio").cells, aspect.cells);
    const Attribute worse = field_of(mesh, "w", "10*(1 - quality)");
    EXPECT_TRUE(worse.constant);
    EXPECT_NEAR(worse.cells[1], 10 - 10 / std::sqrt(2.0), 1e-12);
    // A field of that name is the field.
    mesh.attributes = {{"quality", 1, std::vector<double>(mesh.points.size(), 7.0)}};
    EXPECT_FALSE(field_of(mesh, "q", "quality").constant);
    EXPECT_EQ(field_of(mesh, "q", "quality").values[0], 7);
    // An edge without length.
    mesh.points[mesh.cells[0][1]] = mesh.points[mesh.cells[0][0]];
    EXPECT_EQ(field_of(mesh, "a", "aspect").cells[0], 1e9);
}

}  // namespace quantity_test
}  // namespace subvol
