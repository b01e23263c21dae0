// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/error_text.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "subvol/detail/distinct_names.h"

namespace subvol::test {

namespace error_text_test {

using detail::DistinctNames;
using detail::error_sentence;
using detail::listed;

std::vector<std::string> numbers(std::size_t count) {
    std::vector<std::string> all;
    for (std::size_t k = 0; k < count; ++k) all.push_back(std::to_string(k));
    return all;
}

TEST(ErrorText, ListsSayHowManyMoreThereAre) {
    EXPECT_EQ(listed({}), "");
    EXPECT_EQ(listed(numbers(1)), "0");
    EXPECT_EQ(listed(numbers(10)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9");
    EXPECT_EQ(listed(numbers(11)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 1 more");
    EXPECT_EQ(listed(numbers(2006)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 1,996 more");
    EXPECT_EQ(listed(numbers(1234577)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 1,234,567 more");
}

TEST(ErrorText, NamesOfListsAreShortAndPrintable) {
    const std::vector<std::string> names(10, std::string(5000, 'a') + "\n");
    EXPECT_EQ(listed(std::vector<std::string>{"a\x1b\n"}), "a\\x1b\\x0a");
    EXPECT_LT(listed(names).size(), 250u);
    EXPECT_NE(listed(names).find("more"), std::string::npos);
}

TEST(ErrorText, SentencesAreCut) {
    EXPECT_EQ(error_sentence("", "wrong", ""), "wrong");
    EXPECT_EQ(error_sentence("a.vtu", "wrong", "right"), "a.vtu: wrong (right)");
    const std::string path = "/" + std::string(6000, 'd') + "/part.vtu, line 7", sentence = error_sentence(path, "wrong", "");
    EXPECT_EQ(sentence.size(), 200 + std::string("…: wrong").size());
    EXPECT_TRUE(sentence.ends_with("dd/part.vtu, line 7: wrong"));
    EXPECT_EQ(error_sentence("", std::string(5000, 'x'), ""), std::string(300, 'x') + "…");
    // Characters of several bytes stay whole at either cut.
    std::string letters;
    for (int k = 0; k < 1000; ++k) letters += "ä";
    EXPECT_EQ(error_sentence(letters, "", ""), "…" + letters.substr(0, 200) + ": ");
    EXPECT_EQ(error_sentence("x" + letters, letters, ""), "…" + letters.substr(0, 200) + ": " + letters.substr(0, 600) + "…");
}

TEST(DistinctNames, EachIsAnother) {
    DistinctNames names;
    std::vector<std::string> made;
    for (const char* name : {"a", "a_2", "a", "a", "b", "a_2"}) made.push_back(names.take(name));
    EXPECT_EQ(made, (std::vector<std::string>{"a", "a_2", "a_3", "a_4", "b", "a_2_2"}));
}

/// A search through all names or numbers would take minutes.
TEST(DistinctNames, TakeTimeInProportion) {
    DistinctNames names;
    std::set<std::string> made;
    constexpr std::size_t kNames = 200000;
    for (std::size_t k = 0; k < kNames; ++k) made.insert(names.take(k % 2 == 0 ? "x" : "x_" + std::to_string(k)));
    EXPECT_EQ(made.size(), kNames);
}

}  // namespace error_text_test

}  // namespace subvol::test
