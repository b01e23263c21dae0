// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/gzip.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <random>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace gzip_test {

using test::error_of;
using testing::HasSubstr;

std::string gzipped(const std::string& text) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::string packed(deflateBound(&stream, text.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

using PackedFiles = test::TempFolder;

TEST_F(PackedFiles, AreReadByTheirNameWithoutTheEnding) {
    std::mt19937 random(4);
    std::string text(3'000'000, '\0');
    for (char& c : text) c = static_cast<char>('a' + random() % 4);
    const auto read = [&](std::size_t most) { return read_maybe_gzipped(path("a"), [=](std::string_view) { return most; }); };
    write("a.gz", gzipped(text.substr(0, 2'000'000)) + gzipped("") + gzipped(text.substr(2'000'000)));
    EXPECT_TRUE(read(text.size()) == text) << "in all members";
    EXPECT_TRUE(start_of_maybe_gzipped(path("a"), 1000) == text.substr(0, 1000));
    write("a", "plain");
    EXPECT_EQ(read(0), "plain") << "the file itself comes first";
    EXPECT_EQ(start_of_maybe_gzipped(path("a"), 3), "pla");
    std::filesystem::remove(path("a"));
    const std::string packed = gzipped(text);
    for (const std::string& damaged :
         {packed.substr(0, packed.size() - 1), packed + "x", std::string("no gzip"), std::string()}) {
        write("a.gz", damaged);
        EXPECT_THAT(error_of([&] { static_cast<void>(read(text.size())); }), HasSubstr("a.gz: not a whole gzip file"))
            << damaged.size();
    }
    write("a.gz", gzipped(std::string(std::size_t{80} << 20, ' ')));
    EXPECT_THAT(error_of([&] { static_cast<void>(read(1)); }), HasSubstr("at most 67108864 bytes"));
    EXPECT_EQ(read(std::size_t{80} << 20).size(), std::size_t{80} << 20);
}

}  // namespace gzip_test
}  // namespace subvol::detail
