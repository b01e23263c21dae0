// SPDX-License-Identifier: Apache-2.0
// Files that other files name: in a circle, again and again, and those that are no regular files.
#include "subvol/detail/named_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "lib/temp_folder.h"
#include "subvol/detail/read_file.h"

namespace subvol::detail {
namespace named_files_test {

using test::error_of;
using testing::HasSubstr;

using NamedInFiles = test::TempFolder;

TEST_F(NamedInFiles, CirclesDepthAndRepetitionAreRefused) {
    const auto place = [] { return std::string("list.pvd, line 3"); };
    write("a", "12345678");
    std::filesystem::create_symlink("a", path("b"));
    EXPECT_EQ(NamedFiles::identity(path("a")), NamedFiles::identity(path("b")));
    NamedFiles files(3);
    {
        const auto open = files.open(path("a"), place);
        EXPECT_EQ(error_of([&] { static_cast<void>(files.open(path("b"), place)); }),
                  "list.pvd, line 3: names itself, by a > b");
    }
    const auto again = files.open(path("b"), place);  // it is open no longer
    for (int k = 0; k < 3; ++k) files.count(place);
    EXPECT_THAT(error_of([&] { files.count(place); }), HasSubstr("list.pvd, line 3: more than 3 files are named"));
    NamedFiles deep;
    std::vector<NamedFiles::Open> open;
    for (std::size_t k = 0; k < NamedFiles::kDeepest; ++k) open.push_back(deep.open(path("f" + std::to_string(k)), place));
    EXPECT_THAT(error_of([&] { open.push_back(deep.open(path("g"), place)); }), HasSubstr("more than 16 deep"));
    // 16 times what is there, and 16 MiB.
    NamedFiles bytes;
    constexpr std::size_t kThere = 1'000'000;
    bytes.take("s", kThere, NamedFiles::kFewBytes + 16 * kThere, place);
    bytes.take("s", kThere, 15, place);
    EXPECT_THAT(error_of([&] { bytes.take("s", kThere, 16 * kThere, place); }), HasSubstr("again and again"));
    bytes.take("t", 10 * kThere, 0, place);  // something new is there
    bytes.take("s", kThere, 16 * kThere, place);
}

TEST_F(NamedInFiles, OnlyRegularFilesAreRead) {
    const auto place = [] { return std::string("a.case, line 1"); };
    write("there", "text");
    write("empty", "");
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_EQ(named_file(path(""), "there", place), path("") / "there");
    EXPECT_EQ(read_regular(named_file(path(""), "empty", place)), "");
    for (const auto& [name, said] : {std::pair{std::string(), "no file is named"},
                                     {std::string("not there"), "there is no file \"not there\""},
                                     {std::string("pipe"), "\"pipe\" is not a regular file"},
                                     {std::string("a\0b", 3), "has a zero byte"},
                                     {std::string("."), "is not a regular file"}}) {
        const std::string error = error_of([&, text = name] { static_cast<void>(named_file(path(""), text, place)); });
        EXPECT_THAT(error, HasSubstr("a.case, line 1: ")) << name;
        EXPECT_THAT(error, HasSubstr(said));
    }
    EXPECT_THAT(error_of([&] { static_cast<void>(read_regular("/dev/zero")); }), HasSubstr("is not a regular file"));
    EXPECT_EQ(read_range(path("there"), 1, 2), "ex");
    EXPECT_EQ(read_range(path("there"), 2, 9), "xt");
    EXPECT_EQ(read_range(path("there"), 9, 9), "");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_range(path("not there"), 0, 1)); }, ErrorCode::Io),
                HasSubstr("cannot be read"));
}

}  // namespace named_files_test
}  // namespace subvol::detail
