// SPDX-License-Identifier: Apache-2.0
#include "subvol/option.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "subvol/error.h"
#include "subvol/fit_kernel.h"
#include "subvol/limit_slice.h"
#include "subvol/limit_surface.h"
#include "subvol/points_io.h"
#include "subvol/reduce.h"
#include "subvol/sample.h"
#include "subvol/wavelet_file.h"

namespace subvol {

namespace option_test {

enum class Fruit { Apple, Pear };

}  // namespace option_test

template <>
struct NameTable<option_test::Fruit> {
    static constexpr Name<option_test::Fruit> rows[] = {{option_test::Fruit::Apple, "apple"},
                                                        {option_test::Fruit::Pear, "pear"}};
};

namespace option_test {

struct Basket {
    int count = 1;
    double weight = 0;
    double share = 0.5;
    bool ripe = false;
    Fruit fruit = Fruit::Apple;
    std::optional<double> price{};
    std::uint64_t room = 0;
    std::uint64_t seed = 0;
};

std::vector<Option> options_of(Basket& basket) {
    return {Option("count", basket.count).between(1, 64).help("N", "how many"),
            Option("net-weight", basket.weight).positive().or_none().help("KG", "how heavy"),
            Option("share", basket.share).between(0, 1).help("S", "for you").not_with("net-weight"),
            Option("ripe", basket.ripe).help("to be eaten"),
            Option("fruit", basket.fruit).help("NAME", "which"),
            Option("price", basket.price).not_negative().help("P", "of one").only_with("fruit", {"pear"}).or_with("ripe"),
            Option("room", basket.room).bytes().help("BYTES", "needed"),
            Option("seed", basket.seed)
                .help("N", "of chance, instead of --net-weight; see `shop --seeds`")
                .instead_of({"net-weight"})};
}

std::string refusal(const char* name, const std::string& text) {
    Basket basket;
    for (const Option& option : options_of(basket)) {
        if (option.name != name) continue;
        try {
            option.read(text, "--" + option.name);
        } catch (const Error& error) {
            return error.what();
        }
    }
    return {};
}

Basket basket_of(const char* name, const std::string& text) {
    Basket basket;
    for (const Option& option : options_of(basket)) {
        if (option.name == name) option.read(text, name);
    }
    return basket;
}

TEST(Option, TextBecomesTheValueOfTheMember) {
    EXPECT_EQ(basket_of("count", "+7").count, 7);
    EXPECT_EQ(basket_of("count", "6e1").count, 60);
    EXPECT_EQ(basket_of("net-weight", "1.5").weight, 1.5);
    EXPECT_EQ(basket_of("fruit", "pear").fruit, Fruit::Pear);
    EXPECT_EQ(basket_of("price", "0").price, 0.0);
    EXPECT_EQ(basket_of("room", "2k").room, 2048U);
    EXPECT_EQ(basket_of("seed", "18446744073709551615").seed, 18446744073709551615U);
}

TEST(Option, ARefusalSaysWhatIsWrongWhereAndWhatWouldBeRight) {
    EXPECT_EQ(refusal("count", "65"), "--count: '65' is out of range (1 to 64)");
    EXPECT_EQ(refusal("count", "1.5"), "--count: '1.5' is not a whole number (1 to 64)");
    EXPECT_EQ(refusal("net-weight", "0"), "--net-weight: '0' is out of range (more than 0)");
    EXPECT_EQ(refusal("share", "two"), "--share: 'two' is not a number (0 to 1)");
    EXPECT_EQ(refusal("price", "-1"), "--price: '-1' is out of range (0 or more)");
    EXPECT_EQ(refusal("room", "5 apples"),
              "--room: '5 apples' is not a number of bytes (a number of bytes from 0 to 1024P, such as 500M or 2G)");
    EXPECT_NE(refusal("fruit", "peer").find("did you mean pear?"), std::string::npos);
    for (const char* text : {"nan", "inf", "1e999", "", " 1", "0x10"}) {
        for (const char* name : {"count", "net-weight", "share", "price", "room", "seed"})
            EXPECT_NE(refusal(name, text), "") << name << " " << text;
    }
}

TEST(Option, ValuesThatCodeHasSetAreCheckedByTheSameRule) {
    EXPECT_NO_THROW(check_options(Basket{}));  // a weight of 0 is none
    Basket basket;
    basket.count = 0;
    try {
        check_options(basket);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "count: 0 is out of range (1 to 64)");
    }
    EXPECT_THROW(check_options(Basket{.weight = NAN}), Error);
    EXPECT_THROW(check_options(Basket{.weight = -1}), Error);
    EXPECT_THROW(check_options(Basket{.price = INFINITY}), Error);
}

std::string need_refusal(const std::set<std::pair<std::string, std::string>>& words, OptionNames names) {
    Basket basket;
    const GivenOptions given = [&](std::string_view name) -> std::optional<std::string> {
        for (const auto& [option, value] : words) {
            if (option == name) return value;
        }
        return std::nullopt;
    };
    try {
        check_needs(options_of(basket), given, names);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Option, AnOptionWithoutEffectIsRefusedBySentencesThatDifferInTheNamesAlone) {
    using enum OptionNames;
    EXPECT_EQ(need_refusal({{"price", "1"}, {"fruit", "pear"}}, Flags), "");
    EXPECT_EQ(need_refusal({{"price", "1"}}, Flags), "--price: has no effect without --fruit pear");  // the default is apple
    EXPECT_EQ(need_refusal({{"price", "1"}}, Keywords), "price: has no effect without fruit='pear'");
    EXPECT_EQ(need_refusal({{"price", "1"}, {"ripe", "true"}}, Keywords), "");  // which makes up for it
    EXPECT_EQ(need_refusal({{"share", ".1"}, {"net-weight", "2"}}, Keywords),
              "share: has no effect with net_weight (leave one of them out)");
    EXPECT_EQ(need_refusal({{"seed", "1"}, {"net-weight", "2"}}, Flags), "--net-weight: cannot be given together with --seed");
}

TEST(Option, HelpNamesOtherOptionsAsItsReadersWriteThem) {
    Basket basket;
    const Option seed = options_of(basket).back();
    EXPECT_EQ(seed.meaning(OptionNames::Flags), "of chance, instead of --net-weight; see `shop --seeds`");
    EXPECT_EQ(seed.meaning(OptionNames::Keywords), "of chance, instead of net_weight; see `shop --seeds`");
    EXPECT_EQ(options_of(basket)[0].range_text(), "1 to 64");
    EXPECT_EQ(options_of(basket)[1].range_text(), "more than 0");
    EXPECT_EQ(options_of(basket)[5].range_text(), "0 or more");
    EXPECT_EQ(seed.range_text(), "");
}

TEST(Option, ANumberIsSetByItsKey) {
    Basket basket;
    const std::vector<Option> options = options_of(basket);
    EXPECT_EQ(options[1].key(), "net_weight");
    options[1].set(2, "net_weight");
    EXPECT_EQ(basket.weight, 2);
    EXPECT_THROW(options[0].set(1.5, "count"), Error);
    EXPECT_EQ(options[0].text(), "1");
    EXPECT_EQ(options[5].text(), "");  // not given
}

template <class Options>
void expect_sound() {
    EXPECT_NO_THROW(check_options(Options{}));
    Options options;
    for (const Option& option : options_of(options)) {
        const std::string before = option.text();
        EXPECT_FALSE(option.sentence.empty()) << option.name;
        if (before.empty() || before == "0" || std::holds_alternative<bool*>(option.value)) continue;
        option.read(before, option.name);
        EXPECT_EQ(option.text(), before) << option.name;
    }
}

TEST(Option, DefaultsOfTheLibraryAreAllowedAndReadBack) {
    expect_sound<SchemeOptions>();
    expect_sound<RefineOptions>();
    expect_sound<SampleOptions>();
    expect_sound<ReduceOptions>();
    expect_sound<FitOptions>();
    expect_sound<WaveletFileOptions>();
    expect_sound<SurfaceOptions>();
    expect_sound<SliceOptions>();
    expect_sound<PointsWriteOptions>();
    SampleOptions options;
    for (const Option& option : options_of(options)) {
        if (option.name == "value-kernel") {
            EXPECT_EQ(option.text(), "paper_bc");
        }
    }
}

}  // namespace option_test
}  // namespace subvol
