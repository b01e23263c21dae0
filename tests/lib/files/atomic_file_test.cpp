// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <future>
#include <string>

#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"

namespace subvol::detail {
namespace atomic_file_test {

namespace fs = std::filesystem;

using test::error_of;
using test::read_bytes;

using AtomicFiles = test::TempFolder;

/// The name of a file that another program opens: /dev/fd/N.
std::string name_of(int file) {
    return "/dev/fd/" + std::to_string(file);
}

/// All bytes that come out of a pipe until its other end is closed.
std::future<std::string> read_later(const fs::path& pipe) {
    return std::async(std::launch::async, [pipe] { return read_bytes(pipe); });
}

TEST_F(AtomicFiles, ReplacesAFileWhenItIsCommitted) {
    write("a.txt", "before");
    {
        AtomicFile file(path("a.txt"));
        std::ofstream(file.path()) << "half";
    }
    EXPECT_EQ(read_bytes(path("a.txt")), "before");
    write_text_file(path("a.txt"), "after");
    EXPECT_EQ(read_bytes(path("a.txt")), "after");
    EXPECT_EQ(file_count(), 1U);
}

TEST_F(AtomicFiles, WritesThroughALink) {
    fs::create_directory(path("there"));
    write("there/real.vtu", "before");
    fs::create_symlink("there/real.vtu", path("one.vtu"));
    fs::create_symlink(path("one.vtu"), path("two.vtu"));  // a link to a link
    {
        AtomicFile file(path("two.vtu"));
        EXPECT_EQ(file.path().parent_path(), path("there")) << "on the same file system as the file that it replaces";
        std::ofstream(file.path()) << "half";
    }
    EXPECT_EQ(read_bytes(path("there/real.vtu")), "before");
    (void)write_mesh(path("two.vtu"), make_model("ball", 2));
    EXPECT_TRUE(fs::is_symlink(path("one.vtu")) && fs::is_symlink(path("two.vtu")));
    EXPECT_FALSE(fs::is_symlink(path("there/real.vtu")));
    EXPECT_EQ(read_mesh(path("there/real.vtu")).mesh.cells.size(), make_model("ball", 2).cells.size());
    EXPECT_EQ(file_count(), 3U) << "nothing temporary is left";
}

TEST_F(AtomicFiles, TheNameOfTheLinkDecidesTheFormat) {
    fs::create_symlink("data", path("mesh.vtu"));
    EXPECT_EQ(AtomicFile(path("mesh.vtu")).path().extension(), ".vtu");
    (void)write_mesh(path("mesh.vtu"), make_model("ball", 2));  // where there is no file yet
    EXPECT_TRUE(fs::is_symlink(path("mesh.vtu")));
    EXPECT_EQ(read_bytes(path("data")), read_bytes(path("mesh.vtu")));
    EXPECT_NE(read_bytes(path("data")), "");
}

TEST_F(AtomicFiles, LinksThatLeadNowhereAreErrors) {
    fs::create_symlink("b", path("a"));
    fs::create_symlink("a", path("b"));
    EXPECT_NE(error_of([&] { write_text_file(path("a"), "text"); }, ErrorCode::Io).find("links"), std::string::npos);
    fs::create_symlink(path("no/file"), path("c"));
    EXPECT_NE(error_of([&] { write_text_file(path("c"), "text"); }, ErrorCode::Io).find("no\" does not exist"),
              std::string::npos);
    fs::create_symlink(".", path("d"));
    EXPECT_NE(error_of([&] { write_text_file(path("d"), "text"); }, ErrorCode::Io).find("is a folder"), std::string::npos);
}

TEST_F(AtomicFiles, APipeGetsTheWholeFile) {
    const fs::path pipe = path("pipe.vtu");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    // The writer goes back to fill in sizes, which a pipe does not allow.
    const HexMesh mesh = make_model("ball", 6);
    (void)write_mesh(path("file.vtu"), mesh);
    auto bytes = read_later(pipe);
    (void)write_mesh(pipe, mesh);
    EXPECT_EQ(bytes.get(), read_bytes(path("file.vtu")));
    EXPECT_TRUE(fs::is_fifo(pipe));
    EXPECT_EQ(file_count(), 2U);
}

TEST_F(AtomicFiles, AnOpenFileOfTheProcessGetsTheBytes) {
    // As /dev/stdout, which is a link to a link to a pipe, a terminal or a file.
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    EXPECT_TRUE(output_place(name_of(ends[1])).stream);
    write_text_file(name_of(ends[1]), "text");
    ::close(ends[1]);
    std::array<char, 16> got{};
    EXPECT_EQ(::read(ends[0], got.data(), got.size()), 4);
    EXPECT_STREQ(got.data(), "text");
    ::close(ends[0]);

    const int file = ::open(path("out").c_str(), O_CREAT | O_WRONLY, 0600);  // as > out
    write_text_file(name_of(file), "text");
    ::close(file);
    EXPECT_EQ(read_bytes(path("out")), "text");
}

TEST_F(AtomicFiles, ADeviceStaysADevice) {
    write_text_file("/dev/null", "text");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    EXPECT_NE(
        error_of([] { write_text_file("/dev/full", "text"); }, ErrorCode::Io).find("/dev/full: cannot be written: No space"),
        std::string::npos);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

}  // namespace atomic_file_test
}  // namespace subvol::detail
