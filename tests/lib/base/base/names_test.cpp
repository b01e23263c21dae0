// SPDX-License-Identifier: Apache-2.0
#include "subvol/names.h"

#include <gtest/gtest.h>

#include "subvol/error.h"

namespace subvol {

enum class Fruit { Apple, Pear };

template <>
struct NameTable<Fruit> {
    static constexpr Name<Fruit> rows[] = {{Fruit::Apple, "apple"}, {Fruit::Pear, "pear"}};
};

namespace {

TEST(Names, OfAnEnumAreReadBack) {
    for (const Fruit fruit : {Fruit::Apple, Fruit::Pear}) EXPECT_EQ(named<Fruit>(name_of(fruit), "--fruit"), fruit);
    EXPECT_EQ(names_of<Fruit>(), (std::vector<std::string>{"apple", "pear"}));
}

TEST(Names, OfNoEnumeratorAreRefusedWithTheNearest) {
    try {
        (void)named<Fruit>("peer", "--fruit");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
        EXPECT_STREQ(error.what(), "--fruit: 'peer' is unknown: did you mean pear? (supported: apple, pear)");
    }
}

}  // namespace
}  // namespace subvol
