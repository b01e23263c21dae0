// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/netcdf_source.h"

#include <gmock/gmock.h>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace netcdf_source_test {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

/// A classic netCDF file, number by number.
class Netcdf {
public:
    Netcdf& word(std::uint32_t number) {
        for (int shift = 24; shift >= 0; shift -= 8) text_ += static_cast<char>(number >> shift & 255);
        return *this;
    }
    Netcdf& name(const std::string& name) {
        word(static_cast<std::uint32_t>(name.size()));
        return bytes(name + std::string((4 - name.size() % 4) % 4, '\0'));
    }
    Netcdf& bytes(const std::string& bytes) {
        text_ += bytes;
        return *this;
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_ = "CDF\1";
};

/// Two records of a variable of three shorts, and of another one beside it that makes records padded to four bytes.
std::string records(bool two, std::uint32_t announced = 2) {
    Netcdf file;
    file.word(announced).word(10).word(2).name("time").word(0).name("x").word(3).word(0).word(0).word(11).word(two ? 2 : 1);
    const std::uint32_t begin = two ? 156 : 120;
    file.name("v").word(2).word(0).word(1).word(12).word(1).name("units").word(2).word(3).bytes(std::string("m/s\0", 4));
    file.word(3).word(8).word(begin);
    if (two) file.name("w").word(1).word(0).word(0).word(0).word(4).word(4).word(begin + 8);
    EXPECT_EQ(file.text().size(), begin);
    for (char record = 0; record < 2; ++record) {
        file.bytes({0, static_cast<char>(10 * record + 1), 0, static_cast<char>(10 * record + 2), 0,
                    static_cast<char>(10 * record + 3)});
        if (two) file.bytes(std::string(2, '\0')).word(static_cast<std::uint32_t>(record + 7));
    }
    return file.text();
}

TEST(ClassicNetcdf, RecordsArePaddedUnlessThereIsOneVariable) {
    for (const bool two : {false, true}) {
        for (const std::uint32_t announced :
             {2U, 0xffffffffU}) {  // a file that was written as a stream does not know their number
            const std::string text = records(two, announced);
            const auto source = open_classic_netcdf(text, "a.nc");
            EXPECT_EQ(source->dimensions.at("time"), 2U);
            EXPECT_EQ(source->dimensions.at("x"), 3U);
            EXPECT_THAT(source->variables.at("v").lengths, ElementsAre(2, 3));
            EXPECT_EQ(source->attribute("v", "units"), "m/s");
            EXPECT_EQ(source->attribute("v", "long_name"), "");
            const std::vector<std::size_t> second{1}, last{1, 2};
            EXPECT_THAT(integers_from(source->values("v", second), NumberType::Int16, std::endian::native),
                        ElementsAre(11, 12, 13));
            EXPECT_THAT(integers_from(source->values("v", last), NumberType::Int16, std::endian::native), ElementsAre(13));
            if (two) {
                EXPECT_THAT(integers_from(source->values("w", second), NumberType::Int32, std::endian::native), ElementsAre(8));
            }
            const std::string cut = text.substr(0, text.size() - (two ? 8 : 1));
            const auto damaged = open_classic_netcdf(cut, "a.nc");
            if (damaged->variables.at("v").lengths[0] < 2) continue;
            EXPECT_THAT(error_of([&] { static_cast<void>(damaged->values("v", second)); }),
                        HasSubstr("a.nc, byte " + std::to_string(two ? 156 : 120) + ": values go beyond the end"));
        }
    }
    const std::string text = records(true);
    for (std::size_t length = 4; length < 156; ++length) {
        EXPECT_THAT(error_of([&] { static_cast<void>(open_classic_netcdf(std::string_view(text).substr(0, length), "a.nc")); }),
                    HasSubstr("a.nc, byte "))
            << length;
    }
}

}  // namespace netcdf_source_test
}  // namespace subvol::detail
