// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_expression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace field_expression_test {

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

TEST(FieldExpression, ComputesFromFieldsAndCoordinates) {
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

TEST(FieldExpression, ANameIsTheFieldItself) {
    const HexMesh mesh = mesh_with_fields();
    const Attribute v = field_of(mesh, "vel", "V"), odd = field_of(mesh, "stress", "von Mises");
    EXPECT_EQ(v.channels, 3) << "a vector stays one";
    EXPECT_EQ(v.values, mesh.attributes[1].values);
    EXPECT_EQ(odd.name, "stress");
    EXPECT_EQ(odd.values, mesh.attributes[2].values);
    EXPECT_EQ(field_of(mesh, "height", "z").values, mesh.attributes[2].values) << "a coordinate";
}

TEST(FieldExpression, NamesMayHaveDotsOrBeQuoted) {
    HexMesh mesh = mesh_with_fields();
    mesh.attributes[0].name = "alpha.water";
    const Attribute plain = field_of(mesh, "d", "1-alpha.water"),
                    quoted = field_of(mesh, "d", "1-'alpha.water' + 2*'von Mises'");
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_EQ(plain.values[p], 1 - mesh.attributes[0].values[p]);
        EXPECT_EQ(quoted.values[p], 1 - mesh.attributes[0].values[p] + 2 * mesh.attributes[2].values[p]);
    }
    test::expect_error(ErrorCode::InvalidInput, "alpha.water, V, 'von Mises'",
                       [&] { (void)field_of(mesh, "f", "1-von Mises"); });
}

TEST(FieldExpression, SaysWhatIsWrong) {
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
    refused("", "");
}

}  // namespace field_expression_test
}  // namespace subvol
