// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "lib/rbf_volumes.h"
#include "lib/temp_folder.h"
#include "subvol/points_io.h"

namespace subvol::test {

namespace points_text_test {

using testing::HasSubstr;

class PointsText : public TempFolder {
protected:
    /// The error message for a file with this text.
    std::string error_of_text(const std::string& name, const std::string& text) const {
        const auto file = write(name, text);
        return error_of([&] { static_cast<void>(read_points(file)); });
    }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// A file that our writer would not write: the properties in another order, unknown ones and an unknown list among them,
// big-endian.
TEST_F(PointsText, PlyOfOtherMakers) {
    const std::string properties =
        "property uchar red\nproperty float syy\nproperty double z\nproperty float sxx\nproperty float sxy\n"
        "property list uchar int neighbours\nproperty double x\nproperty float sxz\nproperty float syz\nproperty float szz\n"
        "property short value\nproperty double y\n";
    const auto text = [&](const std::string& format) {
        return "ply\r\nformat " + format +
               " 1.0\r\ncomment kernel {\"type\": \"compact\", \"radius\": 1.5}\ncomment by somebody else\nobj_info none\n" +
               "element camera 1\nproperty float view\nelement vertex 2\n" + properties +
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    };
    const auto expect = [&](const RbfVolume& read) {
        EXPECT_EQ(read.centers, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
        EXPECT_EQ(read.frames[1], (Symmetric3{4, 1, .5f, 9, .25f, 16}));
        EXPECT_EQ(read.channels[0].values, (std::vector<float>{-7, 8}));
        EXPECT_EQ(read.channels[0].gradients[1], (std::array<float, 3>{}));
        EXPECT_TRUE(read.channels[0].hessians.empty());
        EXPECT_EQ(support_radius(read.kernel), 1.5);
        EXPECT_TRUE(read.boundary.triangles.empty());
    };
    expect(read_points(write(
        "a.ply", text("ascii") + "0.5\n255 9 3 4 1 2 10 11 1 .5 .25 16 -7 2\n0 9 6 4 1 0 4 .5 .25 16 8 5\n" + "3 0 1 0\n")));

    std::string binary;
    const auto put = [&](auto number) {
        std::array<char, sizeof number> bytes;
        std::memcpy(bytes.data(), &number, sizeof number);
        std::reverse(bytes.begin(), bytes.end());
        binary.append(bytes.data(), bytes.size());
    };
    put(0.5f);
    for (int i = 0; i < 2; ++i) {
        put(std::uint8_t{255});
        put(9.f);
        put(3.0 + 3 * i);
        put(4.f);
        put(1.f);
        put(static_cast<std::uint8_t>(i));
        for (int n = 0; n < i; ++n) put(std::int32_t{77});
        put(1.0 + 3 * i);
        put(.5f);
        put(.25f);
        put(16.f);
        put(static_cast<std::int16_t>(i == 0 ? -7 : 8));
        put(2.0 + 3 * i);
    }
    put(std::uint8_t{0});
    expect(read_points(write("b.ply", text("binary_big_endian") + binary)));
}

TEST_F(PointsText, PlyThatIsWrong) {
    write_points(path("a.ply"), random_points(3, 1), {.ascii = true});
    const std::string good = read_bytes(path("a.ply"));
    const std::size_t data = good.find("end_header\n") + 11;
    const std::string first_number = good.substr(data, good.find(' ', data) - data);
    const std::vector<std::array<std::string, 3>> mistakes{
        {"ply\n", "pla\n", "line 1: not a PLY file"},
        {"format ascii", "format ebcdic", "line 2: format \"ebcdic\" is unknown"},
        {"comment kernel ", "comment ", "no comment with the kernel"},
        {"1.43", "-1.43", "'radius' is -1.43"},
        {"\"compact\"", "\"wide\"", "there is no type 'wide'"},
        {"comment kernel {", "comment kernel ", "not JSON"},
        {"element vertex 3", "element vertex 1000000000000", "there is room for"},
        {"element vertex 3", "element vertex 99999999999999999999999", "is not a count"},
        {"element vertex 3", "element vertex -3", "is not a count"},
        {"element vertex 3", "element vertex 4", "line "},
        {"element vertex 3", "element corner 3", "there is no element vertex"},
        {"property double x\n", "property quad x\n", "\"quad\" is not a type"},
        {"property float sxy\n", "property float other\n", "has no property \"sxy\""},
        {"property float sxy\n", "property float sxx\n", "\"sxx\" is not one number a row"},
        {"property float value\n", "property list uchar float value\n", "\"vertex\" "},
        {"end_header\n", "end\n", "\"end\" is not a key"},
        {first_number, "1e999", "point 0: a coordinate is not finite"},
        {"end_header\n", "end_header\nx ", "\"vertex\" 0 of 3: a number is expected, not \"x\""},
        {"3 0 2 1", "4 0 2 1 1", "does not have 3 corners"},
        {"3 0 2 1", "3 0 4 1", "triangle 0 has the corner 4"},
        {"3 0 2 1", "3 0 -1 1", "triangle 0 has the corner -1"},
        {"3 0 2 1", "1e18 0 2 1", "a list goes beyond the end of the file"},
    };
    for (const auto& [from, to, message] : mistakes) {
        const std::string said = error_of_text("b.ply", replaced(good, from, to));
        EXPECT_THAT(said, HasSubstr(message)) << from << " -> " << to;
        EXPECT_THAT(said, HasSubstr("b.ply")) << from << " -> " << to;
    }
    EXPECT_THAT(error_of_text("b.ply", ""), HasSubstr("not a PLY file"));
    // Without properties the rows take no bytes, so the file size does not limit their number.
    EXPECT_THAT(error_of_text("b.ply",
                              "ply\nformat ascii 1.0\ncomment kernel {\"type\":\"compact\"}\nelement vertex 1000000000000\n"
                              "end_header\n"),
                HasSubstr("has no property"));
}

TEST_F(PointsText, VtpThatIsWrong) {
    RbfVolume volume = random_points(3, 2);
    volume.channels[1].name = "t";
    write_points(path("a.vtp"), volume);
    const std::string good = read_bytes(path("a.vtp"));
    const std::vector<std::array<std::string, 3>> mistakes{
        {"type=\"PolyData\"", "type=\"ImageData\"", "\"ImageData\" is not a PolyData"},
        {"<PolyData>", "<Poly>", "not well-formed XML"},
        {"NumberOfPoints=\"3\"", "NumberOfPoints=\"4000000000\"", "values"},
        {"NumberOfPoints=\"3\"", "NumberOfPoints=\"many\"", "NumberOfPoints is missing or not a count"},
        {"Name=\"frame\"", "Name=\"other\"", "no array \"frame\""},
        {"Name=\"density.moment\"", "Name=\"other\"", "no array \"density.moment\""},
        {"Name=\"kernel\"", "Name=\"other\"", "no array \"kernel\""},
        {"<FieldData>", "<Other>", "not well-formed XML"},
        {"123 34", "91 34", "not JSON"},
        {"Name=\"t.hessian\" NumberOfComponents=\"6\" format=\"binary\">",
         "Name=\"t.hessian\" NumberOfComponents=\"6\" format=\"ascii\">1</DataArray><DataArray>", "18 are needed: 6 a point"},
        {"format=\"binary\"", "format=\"appended\"", "there are no appended data"},
        {"\nAQ", "\n/w", "compressed blocks go beyond the end of the data"},
    };
    for (const auto& [from, to, message] : mistakes) {
        const std::string said = error_of_text("b.vtp", replaced(good, from, to));
        EXPECT_THAT(said, HasSubstr(message)) << from << " -> " << to;
        EXPECT_THAT(said, HasSubstr("b.vtp"));
    }
}

}  // namespace points_text_test

}  // namespace subvol::test
