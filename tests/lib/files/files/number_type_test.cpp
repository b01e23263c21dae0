// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/number_type.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string_view>

namespace subvol::detail {
namespace number_type_test {

using testing::ElementsAre;

TEST(NumberTypes, HaveTheNumbersOfTheirRange) {
    using Type = NumberType;
    struct Case {
        Type type;
        double least, most;
    };
    for (const auto& [type, least, most] : {Case{Type::Int8, -128, 127},
                                            {Type::UInt8, 0, 255},
                                            {Type::Int16, -32768, 32767},
                                            {Type::UInt16, 0, 65535},
                                            {Type::Int32, -0x1p31, 0x1p31 - 1},
                                            {Type::UInt32, 0, 0x1p32 - 1}}) {
        const std::string_view name = name_of(type);
        EXPECT_TRUE(can_be(least, type) && can_be(most, type)) << name;
        EXPECT_FALSE(can_be(least - 1, type) || can_be(most + 1, type) || can_be(0.5, type) || can_be(std::nan(""), type))
            << name;
        EXPECT_EQ(size_of(type), static_cast<std::size_t>(std::lround(std::log2(most - least + 1))) / 8) << name;
        EXPECT_TRUE(is_integer(type));
    }
    EXPECT_TRUE(can_be(0x1p63, Type::Int64)) << "the nearest double of the largest one";
    EXPECT_FALSE(can_be(0x1.00001p63, Type::Int64));
    EXPECT_FALSE(can_be(1e300, Type::Float32) || is_integer(Type::Float64));
    EXPECT_TRUE(can_be(HUGE_VAL, Type::Float32) && can_be(3e38, Type::Float32) && can_be(1e300, Type::Float64));
}

TEST(NumberTypes, AreReadInEitherOrder) {
    const std::string bytes("\x01\x02\x03\x84\x05\x06\x07\x08", 8);
    const auto integer = [&](NumberType type, std::endian order) { return integer_from(bytes, type, order); };
    EXPECT_EQ(integer(NumberType::Int8, std::endian::big), 1);
    EXPECT_EQ(integer(NumberType::UInt16, std::endian::big), 0x0102);
    EXPECT_EQ(integer(NumberType::UInt16, std::endian::little), 0x0201);
    EXPECT_EQ(integer(NumberType::Int32, std::endian::big), 0x01020384);
    EXPECT_EQ(integer(NumberType::Int32, std::endian::little), 0x84030201LL - (1LL << 32)) << "the sign bit is set";
    EXPECT_EQ(integer(NumberType::Int64, std::endian::big), 0x0102038405060708LL);
    EXPECT_THAT(integers_from(bytes, NumberType::UInt32, std::endian::big), ElementsAre(0x01020384, 0x05060708));
    EXPECT_THAT(reals_from(std::string_view("\x3f\x80\0\0\xc0\0\0\0", 8), NumberType::Float32, std::endian::big),
                ElementsAre(1, -2));
    EXPECT_EQ(real_from(std::string_view("\0\0\0\0\0\0\xf0\x3f", 8), NumberType::Float64, std::endian::little), 1);
}

}  // namespace number_type_test
}  // namespace subvol::detail
