// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace {

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
    for (const char* name : {"v.3", "v.-1", "v.", "v.x", "v.1abc", "v.1.0", "v.1 ", "v. 1", "v.99999999999", "w.1"}) {
        test::expect_error(ErrorCode::InvalidInput, std::string("there is no field \"") + name + "\"",
                           [&] { (void)select_field(mesh, name); });
    }
}

}  // namespace
}  // namespace subvol
