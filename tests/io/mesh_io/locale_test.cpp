// SPDX-License-Identifier: Apache-2.0
// Hosts such as Qt's or Blender's may set a locale with a decimal comma: files mean the same.

#include <gmock/gmock.h>

#include "io/mesh_io/mesh_texts.h"
#include "lib/comma_locale.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/camera.h"
#include "subvol/expression.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace locale_test {

using testing::ElementsAre;
using testing::HasSubstr;

class DecimalComma : public TempFolder {
protected:
    // A cube with a value, moved along the x axis.
    [[nodiscard]] static HexMesh cube(double value) {
        HexMesh mesh = make_box(1, 1, 1);
        for (Vec3& x : mesh.points) x.x += value / 2 + .125;
        mesh.attributes = {{"f", 1, std::vector<double>(8, value)}};
        return mesh;
    }

    BuiltLocale built_;
};

TEST_F(DecimalComma, TimesAndValuesAreRead) {
    const HexMesh mesh = cube(2.5);
    const CommaLocale comma;
    if (!CommaLocale::of_numbers()) GTEST_SKIP() << "no locale with a comma: localedef and Debian's package locales make one";
    static_cast<void>(write_mesh(path("t0.vtu"), cube(.25)));
    static_cast<void>(write_mesh(path("t1.vtu"), cube(.5)));
    write("a.pvd",
          "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0.25\" file=\"t0.vtu\"/>"
          "<DataSet timestep=\" 5e-1\" file=\"t1.vtu\"/></Collection></VTKFile>");
    write("a.vtu.series", R"({"files": [{"name": "t0.vtu", "time": 0.25}, {"name": "t1.vtu", "time": 0.5}]})");
    const std::string grid =
        "<Topology TopologyType=\"Hexahedron\" BaseOffset=\"1.0\"><DataItem>1 2 4 3 5 6 8 7</DataItem></Topology>"
        "<Geometry><DataItem>0 0 0 1.5 0 0 0 1 0 1.5 1 0 0 0 1 1.5 0 1 0 1 1 1.5 1 1</DataItem></Geometry>"
        "<Attribute Name=\"f\"><DataItem>.5 .5 .5 .5 .5 .5 .5 .5</DataItem></Attribute>";
    write("a.xdmf", "<Xdmf><Domain><Grid GridType=\"Collection\" CollectionType=\"Temporal\"><Grid><Time Value=\"0.25\"/>" +
                        grid + "</Grid><Grid><Time Value=\"0.5\"/>" + grid + "</Grid></Grid></Domain></Xdmf>");
    for (const std::string name : {"a.pvd", "a.vtu.series", "a.xdmf"}) {
        EXPECT_THAT(open_series(path(name)).times, ElementsAre(.25, .5)) << name;
        const ReadResult last = read_mesh(path(name));
        EXPECT_EQ(last.mesh.cells.size(), 1u) << name;
        EXPECT_EQ(last.mesh.attributes.at(0).values[0], .5) << name;
    }
    EXPECT_NEAR(inspect(read_mesh(path("a.xdmf")).mesh).volume, 1.5, 1e-12);
    write("a.vtk",
          vtk_text(mesh) + "POINT_DATA 8\nSCALARS f double 1\nLOOKUP_TABLE default\n2.5 2.5 2.5 2.5 2.5 2.5 2.5 2.5\n");
    write("a.msh", gmsh_text(mesh, "2 1 1"));
    write("a.mesh", medit_text(mesh));
    for (const std::string name : {"a.vtk", "a.msh", "a.mesh"}) {
        EXPECT_EQ(read_mesh(path(name)).mesh.points, mesh.points) << name;
    }
    EXPECT_EQ(read_mesh(path("a.vtk")).mesh.attributes.at(0).values[3], 2.5);
    write("a.json", R"({"eye": [1.5, 2, 3], "target": [0, 0.25, 0], "fovy_deg": 30.5})");
    const Camera camera = parse_camera(path("a.json").string(), Box());
    EXPECT_EQ(camera.eye, Vec3(1.5, 2, 3));
    EXPECT_EQ(camera.fovy_deg, 30.5);
    EXPECT_THAT(evaluate_expression("1.5*x + 0.25", std::vector{Vec3(2, 0, 0)}), ElementsAre(3.25));
}

TEST_F(DecimalComma, FilesAreWrittenWithThePoint) {
    const HexMesh mesh = cube(.25);
    static_cast<void>(write_mesh(path("point.vtu"), mesh));
    static_cast<void>(write_mesh(path("point.mesh"), mesh));
    const CommaLocale comma;
    static_cast<void>(write_mesh(path("comma.vtu"), mesh));
    static_cast<void>(write_mesh(path("comma.mesh"), mesh));
    EXPECT_EQ(read_bytes(path("comma.vtu")), read_bytes(path("point.vtu")));
    EXPECT_EQ(read_bytes(path("comma.mesh")), read_bytes(path("point.mesh")));
    if (!CommaLocale::of_numbers()) GTEST_SKIP() << "no locale with a comma: localedef and Debian's package locales make one";
}

TEST_F(DecimalComma, ATimeThatIsNoNumberIsAnError) {
    static_cast<void>(write_mesh(path("t.vtu"), cube(1)));
    for (const std::string time : {"0,25", "now", "", "nan", "1e999", "0x1"}) {
        write("a.pvd", "<VTKFile type=\"Collection\"><Collection>\n<DataSet timestep=\"" + time +
                           "\" file=\"t.vtu\"/></Collection></VTKFile>");
        EXPECT_THAT(error_of([&] { static_cast<void>(open_series(path("a.pvd"))); }),
                    HasSubstr("a.pvd, line 2: its timestep is not a number"))
            << time;
        write("a.xdmf", "<Xdmf><Domain><Grid GridType=\"Collection\" CollectionType=\"Temporal\">\n<Grid><Time Value=\"" +
                            time + "\"/></Grid></Grid></Domain></Xdmf>");
        EXPECT_THAT(error_of([&] { static_cast<void>(open_series(path("a.xdmf"))); }),
                    HasSubstr("a.xdmf, line 2: its value is not a number"))
            << time;
    }
}

}  // namespace locale_test

}  // namespace subvol::test
