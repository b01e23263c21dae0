// SPDX-License-Identifier: Apache-2.0
#include "subvol/facts.h"

#include <gtest/gtest.h>

#include <array>

#include "subvol/error.h"

namespace subvol {
namespace {

double seconds_of(const Facts& facts, const char* stage) {
    return std::get<double>(std::get<Facts>(facts.find("seconds")->value).find(stage)->value);
}

std::vector<std::string> warnings_of(const Facts& facts) {
    std::vector<std::string> sentences;
    for (const FactValue& one : std::get<FactValue::List>(facts.find("warnings")->value))
        sentences.push_back(std::get<std::string>(one.value));
    return sentences;
}

TEST(Facts, KeepTheOrderInWhichNamesWereFirstSet) {
    Facts facts;
    facts["cells"] = std::size_t{192};
    facts["volume"] = 1.5;
    facts["cells"] = std::size_t{8};
    ASSERT_EQ(facts.all().size(), 2U);
    EXPECT_EQ(facts.all()[0].name, "cells");
    EXPECT_EQ(std::get<std::uint64_t>(facts.find("cells")->value), 8U);
    EXPECT_EQ(facts.find("points"), nullptr);
}

TEST(Facts, HoldListsAndGroups) {
    Facts facts;
    facts["bounds"] = std::array{0.0, 1.0};
    facts["names"] = std::vector<std::string>{"a", "b"};
    facts.group("field")["name"] = "density";
    EXPECT_EQ(std::get<double>(std::get<FactValue::List>(facts.find("bounds")->value)[1].value), 1.0);
    EXPECT_EQ(std::get<std::string>(std::get<FactValue::List>(facts.find("names")->value)[0].value), "a");
    EXPECT_EQ(std::get<std::string>(std::get<Facts>(facts.find("field")->value).find("name")->value), "density");
}

TEST(Facts, OfAResultAreMergedWhenItsValueIsTaken) {
    WithFacts<std::string> made{"picture"};
    made.facts["pixels"] = 4;
    made.facts.note("small");
    made.facts.note("small");
    Facts whole;
    whole.note("drawn");
    EXPECT_EQ(whole.unpack(std::move(made)), "picture");
    EXPECT_EQ(std::get<std::int64_t>(whole.find("pixels")->value), 4);
    EXPECT_EQ(std::get<FactValue::List>(whole.find("notes")->value).size(), 2U);
    EXPECT_EQ(whole.find("warnings"), nullptr);
}

TEST(Facts, OfTwoCallsAddSecondsAndWarnings) {
    Facts whole, part;
    whole["levels"] = 1;
    whole.add_seconds("read", 1);
    whole.warn("thin");
    part["levels"] = 2;
    part.add_seconds("read", 2);
    part.add_seconds("draw", 4);
    part.warn("thin");
    part.warn("open");
    whole.merge(part);
    EXPECT_EQ(std::get<std::int64_t>(whole.find("levels")->value), 2);
    EXPECT_EQ(seconds_of(whole, "read"), 3);
    EXPECT_EQ(seconds_of(whole, "draw"), 4);
    EXPECT_EQ(warnings_of(whole), (std::vector<std::string>{"thin", "open"}));
}

TEST(Facts, TimeAStageWhateverItReturns) {
    Facts facts;
    EXPECT_EQ(facts.timed(nullptr, "count", [] { return 7; }), 7);
    EXPECT_GE(seconds_of(facts, "count"), 0);
    EXPECT_THROW(facts.timed(nullptr, "fail", [] { throw Error(ErrorCode::Io, "no room"); }), Error);
    EXPECT_GE(seconds_of(facts, "fail"), 0);
}

}  // namespace
}  // namespace subvol
