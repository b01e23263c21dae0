// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/ply_table.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace ply_table_test {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPlyHeader =
    "element vertex 2\nproperty float x\nproperty uchar tag\nelement face 1\nproperty list uchar short corners\nend_header\n";

/// Its vertices and faces.
std::array<PlyTable, 2> tables_of(const std::string& text) {
    TextScanner in(text, "a.ply", TextScanner::Comments::None);
    const PlyHeader header = read_ply_header(in);
    EXPECT_EQ(header.elements.size(), 2U);
    std::array<PlyTable, 2> tables{read_ply_element(in, header, header.elements.at(0), {"x", "none"}),
                                   read_ply_element(in, header, header.elements.at(1), {"corners"})};
    expect_ply_end(in);
    return tables;
}

TEST(PlyTables, AreTheSameInEveryEncoding) {
    for (const std::string& rows :
         {"ascii 1.0\ncomment x\n" + kPlyHeader + "1.5 7\n-2 8\n3 0 1 258\n\n",
          "binary_little_endian 1.0\n" + kPlyHeader + std::string("\0\0\xc0\x3f\x07\0\0\0\xc0\x08\3\0\0\1\0\2\1", 17),
          "binary_big_endian 1.0\n" + kPlyHeader + std::string("\x3f\xc0\0\0\x07\xc0\0\0\0\x08\3\0\0\0\1\1\2", 17)}) {
        const auto [vertices, faces] = tables_of("ply\nformat " + rows);
        EXPECT_THAT(vertices.at("x").values, ElementsAre(1.5, -2));
        EXPECT_EQ(vertices.size(), 1U) << "only what is wanted";
        EXPECT_THAT(faces.at("corners").values, ElementsAre(0, 1, 258));
        EXPECT_THAT(faces.at("corners").lengths, ElementsAre(3));
    }
}

TEST(PlyTables, DamagedOnesAreRefused) {
    const auto refusal = [](const std::string& text) { return error_of([&] { static_cast<void>(tables_of(text)); }); };
    const std::string head = "ply\nformat ascii 1.0\n", rows = "1.5 7\n-2 8\n3 0 1 258\n";
    EXPECT_THAT(refusal("obj\n"), HasSubstr("a.ply, line 1: not a PLY file"));
    EXPECT_THAT(refusal("ply\nformat text 1.0\n"), HasSubstr("a.ply, line 2: format \"text\" is unknown"));
    EXPECT_THAT(refusal("ply\n" + kPlyHeader), HasSubstr("the header does not name a format"));
    EXPECT_THAT(refusal(head + "property float x\n"), HasSubstr("line 3: a property comes before the first element"));
    EXPECT_THAT(refusal(head + "element vertex -1\n"), HasSubstr("line 3: \"-1\" is not a count"));
    EXPECT_THAT(refusal(head + "element vertex 2\nproperty half x\n"), HasSubstr("line 4: \"half\" is not a type"));
    EXPECT_THAT(refusal(head + "element vertex 2\n"), HasSubstr("the header has no end_header"));
    EXPECT_THAT(refusal(head + kPlyHeader + "1.5 7 9\n-2 8\n3 0 1 258\n"),
                HasSubstr("line 9: \"vertex\" 0: its line has more numbers"));
    EXPECT_THAT(refusal(head + kPlyHeader + "1.5 7\n-2\n8 3 0 1 258\n"), HasSubstr("\"vertex\" 1: its line has fewer numbers"));
    EXPECT_THAT(refusal(head + kPlyHeader + "1.5 7\n-2 8.5\n"), HasSubstr("has the number 8.5, which is not whole"));
    EXPECT_THAT(refusal(head + kPlyHeader + rows + "4"), HasSubstr("there is more after the last element"));
    EXPECT_THAT(refusal("ply\nformat binary_little_endian 1.0\n" + kPlyHeader + "0123456"),
                HasSubstr("element \"vertex\" goes beyond the end of the file: it should have 2 rows (there is room for 1)"));
    EXPECT_THAT(refusal("ply\nformat binary_little_endian 1.0\n" + kPlyHeader + "0123456789\xff"),
                HasSubstr("\"face\" 0: a list goes beyond the end"));
    const TextScanner in("", "a.ply", TextScanner::Comments::None);
    EXPECT_EQ(ply_corner(in, 4, 5, "face", 2), 4U);
    for (const double wrong : {-1., 5., 0.5, std::nan("")}) {
        EXPECT_THAT(error_of([&] { static_cast<void>(ply_corner(in, wrong, 5, "face", 2)); }),
                    HasSubstr("face 2 has the corner"))
            << wrong;
    }
}

}  // namespace ply_table_test
}  // namespace subvol::detail
