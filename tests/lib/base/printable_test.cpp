// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/printable.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace subvol::test {

namespace printable_test {

using namespace detail;

TEST(Printable, LettersOfAllLanguagesStay) {
    for (const std::string text : {"", "Temp", "naïve", "温度", "σ²", "😀", "a \"b\" \\ 'c'"}) EXPECT_EQ(printable(text), text);
}

TEST(Printable, WhatTerminalsObeyIsWrittenAsBytes) {
    EXPECT_EQ(printable("\x1b[31mred\n"), "\\x1b[31mred\\x0a");
    EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
    EXPECT_EQ(printable("\x7f"), "\\x7f");
    EXPECT_EQ(printable("\xC2\x9b"
                        "31m"),
              "\\xc2\\x9b31m")
        << "a control sequence of one character";
}

TEST(Printable, WhatIsNotUtf8IsWrittenAsBytes) {
    EXPECT_EQ(printable("caf\xE9"), "caf\\xe9");
    EXPECT_EQ(printable("\xC3"), "\\xc3") << "cut off";
    EXPECT_EQ(printable("\xC0\xAF"), "\\xc0\\xaf") << "longer than needed";
    EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "half of a pair of UTF-16";
    EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond the last code";
}

// JSON accepts every text that has become printable.
TEST(Printable, AnyBytesBecomeJson) {
    std::string all;
    for (int i = 0; i < 1 << 16; ++i) all += {static_cast<char>(i), static_cast<char>(i >> 8)};
    EXPECT_NO_THROW(static_cast<void>(nlohmann::json(printable(all)).dump()));
    EXPECT_EQ(printable(printable(all)), printable(all));
}

TEST(Printable, QuotesAreCutAtFortyCharacters) {
    EXPECT_EQ(in_quotes(std::string(40, 'x')), "\"" + std::string(40, 'x') + "\"");
    EXPECT_EQ(in_quotes(std::string(41, 'x')), "\"" + std::string(40, 'x') + "…\"");
    std::string greek, start;
    for (int i = 0; i < 50; ++i) (i < 40 ? start : greek) += "σ";
    EXPECT_EQ(in_quotes(start + greek), "\"" + start + "…\"") << "characters, not bytes";
}

TEST(Printable, WhatAParserQuotesIsCut) {
    try {
        const auto read = nlohmann::json::parse("{\"a\": \"\xff" + std::string(5000, 'x') + "\"}");
        FAIL() << "no error";
    } catch (const nlohmann::json::exception& error) {
        const std::string message = parser_message(error.what());
        EXPECT_LT(message.size(), 250U) << message;
        EXPECT_EQ(printable(message), message);
        EXPECT_NE(message.find("line 1, column"), std::string::npos);
    }
}

TEST(Printable, WhatAParserExpectsStays) {
    EXPECT_EQ(parser_message("invalid literal; last read: '1.4\xff'; expected '}'"),
              "invalid literal; last read: \"1.4\\xff\"; expected '}'");
    EXPECT_EQ(parser_message("last read: '"), "last read: \"\"");
}

}  // namespace printable_test

}  // namespace subvol::test
