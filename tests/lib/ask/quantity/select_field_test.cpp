// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/quantity.h"

namespace subvol {
namespace select_field_test {

/// A cube whose vector field at point p is (p, 10 p, 100 p).
HexMesh mesh_with_vector() {
    HexMesh mesh = test::make_box(1, 1, 1);
    std::vector<double> values;
    for (const double p : {0, 1, 2, 3, 4, 5, 6, 7}) values.insert(values.end(), {p, 10 * p, 100 * p});
    mesh.attributes = {{"v", 3, values}};
    return mesh;
}

TEST(SelectField, TakesAChannelOfAVector) {
    const HexMesh mesh = mesh_with_vector();
    for (int c = 0; c < 3; ++c) {
        const SelectedField field = select_field(mesh, "v." + std::to_string(c));
        EXPECT_EQ(field.scalar.name, "v." + std::to_string(c));
        for (std::size_t p = 0; p < 8; ++p) EXPECT_EQ(field.scalar.values[p], std::pow(10, c) * static_cast<double>(p));
    }
    EXPECT_NEAR(select_field(mesh, "v").scalar.values[1], std::sqrt(10101), 1e-12);  // the length
}

TEST(SelectField, RefusesWhatIsNoChannel) {
    const HexMesh mesh = mesh_with_vector();
    for (const char* name : {"v.3", "v.", "v.w", "v.1abc", "v.1.0", "v. 1", "v.99999999999", "w.1"}) {
        test::expect_error(ErrorCode::InvalidInput, std::string("there is no field \"") + name + "\"",
                           [&] { (void)select_field(mesh, name); });
    }
}

/// A cube with scalars and vectors whose values differ from point to point, in this order.
HexMesh mesh_with(const std::vector<std::pair<std::string, int>>& fields) {
    HexMesh mesh = test::make_box(1, 1, 1);
    for (const auto& [name, channels] : fields) {
        Attribute field{name, channels, {}};
        for (int i = 0; i < 8 * channels; ++i) field.values.push_back(i);
        mesh.attributes.push_back(field);
    }
    return mesh;
}

TEST(SelectField, PassesOverIdentifiersAndFlags) {
    EXPECT_EQ(select_field(mesh_with({{"GlobalNodeId", 1}, {"PedigreeNodeId", 1}, {"DISPL", 3}, {"EQPS", 1}}), {}).scalar.name,
              "EQPS");
    EXPECT_EQ(
        select_field(mesh_with({{"IBlank", 1}, {"vtkOriginalPointIds", 1}, {"vtkGhostType", 1}, {"a", 1}}), {}).scalar.name,
        "a");
    EXPECT_EQ(select_field(mesh_with({{"node_id", 1}, {"Solid", 1}}), {}).scalar.name, "Solid") << "not an identifier";
    const SelectedField none = select_field(mesh_with({{"CellIds", 1}}), {});
    EXPECT_EQ(none.scalar.name, "density");
    EXPECT_NE(none.warning.find("CellIds"), std::string::npos);
    EXPECT_EQ(select_field(mesh_with({{"CellIds", 1}}), "CellIds").scalar.name, "CellIds") << "if it is asked for";
}

TEST(SelectField, PrefersPhysicalNamesThenScalarsThenVectors) {
    EXPECT_EQ(select_field(mesh_with({{"V", 3}, {"a", 1}, {"Temp", 1}, {"Pres", 1}}), {}).scalar.name, "Temp");
    EXPECT_EQ(select_field(mesh_with({{"Velocity", 3}, {"a", 1}}), {}).scalar.name, "a");
    EXPECT_EQ(select_field(mesh_with({{"Velocity", 3}}), {}).scalar.name, "Velocity");
}

TEST(SelectField, TakesAConstantOnlyIfThereIsNothingElse) {
    HexMesh mesh = mesh_with({{"density", 1}, {"a", 1}});
    mesh.attributes[0].values.assign(8, 1.0);
    EXPECT_EQ(select_field(mesh, {}).scalar.name, "a");
    mesh.attributes.pop_back();
    EXPECT_EQ(select_field(mesh, {}).scalar.name, "density");
}

TEST(SelectField, NamesTheNearestField) {
    const auto message = [](const char* name) {
        try {
            (void)select_field(mesh_with({{"Temp", 1}, {"Pres", 1}}), name);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(message("temp").find("did you mean Temp?"), std::string::npos);
    EXPECT_NE(message("Prse").find("did you mean Pres?"), std::string::npos);
    EXPECT_EQ(message("humidity").find("did you mean"), std::string::npos);
}

}  // namespace select_field_test
}  // namespace subvol
