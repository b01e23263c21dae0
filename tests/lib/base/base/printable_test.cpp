// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/printable.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "subvol/detail/text_codes.h"
#include "subvol/detail/text_scanner.h"

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

// Marks of direction, ends of lines, what is not seen and what is no character: U+200F, U+202E, U+2066, U+061C, U+2028, U+200B,
// U+FEFF, U+FFFE, U+FFFF, U+FDD0, U+1FFFE, U+E0041.
TEST(Printable, WhatHidesOrTurnsTextIsWrittenAsBytes) {
    for (const auto& [text, shown] : {std::pair{"a\u200Fb", "a\\xe2\\x80\\x8fb"},
                                      {"a\u202Eb", "a\\xe2\\x80\\xaeb"},
                                      {"\u2066", "\\xe2\\x81\\xa6"},
                                      {"\u061C", "\\xd8\\x9c"},
                                      {"\u2028", "\\xe2\\x80\\xa8"},
                                      {"\u200B", "\\xe2\\x80\\x8b"},
                                      {"\uFEFF", "\\xef\\xbb\\xbf"},
                                      {"\uFFFE", "\\xef\\xbf\\xbe"},
                                      {"\uFFFF", "\\xef\\xbf\\xbf"},
                                      {"\uFDD0", "\\xef\\xb7\\x90"},
                                      {"\U0001FFFE", "\\xf0\\x9f\\xbf\\xbe"},
                                      {"\U000E0041", "\\xf3\\xa0\\x81\\x81"}}) {
        EXPECT_EQ(printable(text), shown);
        EXPECT_FALSE(is_printable(text)) << shown;
    }
    EXPECT_TRUE(is_printable("\u2026"));
    EXPECT_EQ(printable("می\u200Cشود"), "می\u200Cشود") << "a joiner that Persian is written with";
    EXPECT_FALSE(is_printable("ab")) << "two characters";
}

TEST(Printable, WhatAMessageQuotesIsCutAtEightyCharacters) {
    const std::string most(80, 'x'), more = most + "x";
    EXPECT_EQ(printable_message("field \"" + most + "\": is not there"), "field \"" + most + "\": is not there");
    EXPECT_EQ(printable_message("field \"" + more + "\": is not there"), "field \"" + most + "…\": is not there");
    EXPECT_EQ(printable_message("'" + more + "' is unknown ('" + most + "' is not)"),
              "'" + most + "…' is unknown ('" + most + "' is not)");
    std::string greek, start;
    for (int i = 0; i < 90; ++i) (i < 80 ? start : greek) += "σ";
    EXPECT_EQ(printable_message("\"" + start + greek + "\""), "\"" + start + "…\"") << "characters, not bytes";
    const std::string apostrophes = "the mesh's file " + more + " isn't the user's";
    EXPECT_EQ(printable_message(apostrophes), apostrophes) << "apostrophes quote nothing";
    EXPECT_EQ(printable_message("a\x1b \"b"), "a\\x1b \"b");
}

// XML 1.0 cannot hold controls, even as the numbers of characters; a page's paragraphs have lines.
TEST(Printable, XmlHoldsWhatIsWrittenIntoIt) {
    EXPECT_EQ(xml_escaped(std::string("a\0<\x1b>\uFFFE&\"\u202E", 13)),
              "a\\x00&lt;\\x1b&gt;\\xef\\xbf\\xbe&amp;&quot;\\xe2\\x80\\xae");
    EXPECT_EQ(xml_escaped("one\n\ttwo σ"), "one\n\ttwo σ");
    EXPECT_EQ(without_controls(std::string("a\0\u202E\xFFσ", 8)), "a___σ");
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

TEST(Printable, AParserIsNotQuotedButForThePlaceAndTheFault) {
    const auto message_of = [](const char* text) -> std::string {
        try {
            const auto read = nlohmann::json::parse(text);
        } catch (const nlohmann::json::exception& error) {
            return parser_message(error.what());
        }
        return "no error";
    };
    EXPECT_EQ(message_of("{\"eye\": [1,2,"), "line 1, column 14: unexpected end of input");
    EXPECT_EQ(message_of("{\n\"eye\": 1x2}"), "line 2, column 9: invalid literal; last read: \"1x\"");
}

TEST(Printable, WhatAParserExpectsStays) {
    EXPECT_EQ(parser_message("invalid literal; last read: '1.4\xff'; expected '}'"),
              "invalid literal; last read: \"1.4\\xff\"; expected '}'");
    EXPECT_EQ(parser_message("last read: '"), "last read: \"\"");
}

}  // namespace printable_test

}  // namespace subvol::test
