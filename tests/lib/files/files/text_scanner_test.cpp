// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/text_scanner.h"

#include <gmock/gmock.h>

#include <cmath>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace text_scanner_test {

using test::error_of;
using testing::HasSubstr;

TEST(TextScanners, ErrorsNameTheirLine) {
    const std::string text = "\xEF\xBB\xBF one # two\n 3 +4.5\r\n1e999 99999999999999999999 -1 7\nx";
    TextScanner in(text, "a.txt", TextScanner::Comments::Hash);
    EXPECT_EQ(in.peek(), "one");
    EXPECT_EQ(in.word(), "one");
    EXPECT_EQ(in.count({"c"}), 3U);
    EXPECT_EQ(in.real({"r"}), 4.5);
    EXPECT_EQ(in.real({"r"}), HUGE_VAL);
    EXPECT_EQ(error_of([&] {
                  in.integer({"vertex", 12, 27});
              }),
              "a.txt, line 3: vertex 12 of 27: number out of range: \"99999999999999999999\"");
    EXPECT_THAT(error_of([&] { in.count({"c"}); }), HasSubstr("a.txt, line 3: c: negative count -1"));
    EXPECT_EQ(in.integer({"i"}), 7);
    EXPECT_EQ(error_of([&] { in.real({"r"}); }), "a.txt, line 4: r: a number is expected, not \"x\"");
    EXPECT_TRUE(in.at_end());
    EXPECT_EQ(error_of([&] { in.real({"r"}); }), "a.txt, line 4: r: unexpected end of file");
    TextScanner few("1000 1", "b.txt", TextScanner::Comments::None);
    EXPECT_THAT(error_of([&] { few.count({"c"}); }), HasSubstr("count out of range: 1000 (the file has 6 bytes)"));
    EXPECT_EQ(as_utf8("caf\xE9"), "café");
    EXPECT_EQ(as_utf8("café"), "café");
    EXPECT_EQ(without_controls("a\x01é\n"), "a_é_");
    EXPECT_EQ(trimmed(" \t a b\r\n"), "a b");
    EXPECT_EQ(trimmed(" \n"), "");
}

}  // namespace text_scanner_test
}  // namespace subvol::detail
