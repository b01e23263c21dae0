// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <future>
#include <string>
#include <vector>

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

mode_t mode_of(const fs::path& file) {
    struct stat about {};
    EXPECT_EQ(::stat(file.c_str(), &about), 0) << file;
    return about.st_mode & 07777;
}

TEST_F(AtomicFiles, AReplacedFileKeepsItsPermissions) {
    for (const mode_t mode : {0600U, 0640U, 0664U, 0755U, 0200U}) {
        write("a.txt", "before");
        ASSERT_EQ(::chmod(path("a.txt").c_str(), mode), 0);
        AtomicFile file(path("a.txt"));
        EXPECT_EQ(mode_of(file.path()) & 0077U, 0U) << "nobody else may read what replaces a private file";
        std::ofstream(file.path()) << "after";
        file.commit();
        EXPECT_EQ(mode_of(path("a.txt")), mode);
        EXPECT_EQ(::chmod(path("a.txt").c_str(), 0600), 0);
        EXPECT_EQ(read_bytes(path("a.txt")), "after");
    }
    const mode_t mask = ::umask(027);
    write_text_file(path("new.txt"), "text");
    ::umask(mask);
    EXPECT_EQ(mode_of(path("new.txt")), 0640U) << "a new file has the permissions that the user gives to new files";
}

TEST_F(AtomicFiles, AWriterMayPutAnotherFileThere) {
    write("a.txt", "before");
    ASSERT_EQ(::chmod(path("a.txt").c_str(), 0600), 0);
    AtomicFile file(path("a.txt"));
    write("b.txt", "after");  // as libraries that have temporary files of their own
    fs::rename(path("b.txt"), file.path());
    file.commit();
    EXPECT_EQ(read_bytes(path("a.txt")), "after");
    EXPECT_EQ(mode_of(path("a.txt")), 0600U);
}

TEST_F(AtomicFiles, LongNamesAreWritten) {
    for (const std::size_t length : {100U, 250U, 251U, 255U}) {
        for (const std::string extension : {"", ".vtu", ".an extension that is longer than any of a format"}) {
            const std::string name = std::string(length - extension.size(), 'n') + extension;
            write_text_file(path(name), name);
            write_text_file(path(name), name + "!");
            EXPECT_EQ(read_bytes(path(name)), name + "!");
        }
    }
    EXPECT_EQ(file_count(), 12U);
    const std::string dots = "." + std::string(254, 'n');  // a name without an extension
    write_text_file(path(dots), "text");
    EXPECT_EQ(read_bytes(path(dots)), "text");
    EXPECT_NE(error_of([&] { AtomicFile file(path(std::string(256, 'n'))); }, ErrorCode::Io).find("too long"),
              std::string::npos)
        << "before anything is computed";
}

TEST_F(AtomicFiles, ThreadsMayWriteOneFile) {
    const auto content = [](int thread) { return std::string(200'000, static_cast<char>('a' + thread)); };
    std::vector<std::future<void>> threads;
    for (int t = 0; t < 8; ++t) {
        threads.push_back(std::async(std::launch::async, [&, t] {
            for (int k = 0; k < 5; ++k) write_text_file(path("a.txt"), content(t));
        }));
    }
    for (auto& thread : threads) thread.get();
    const std::string last = read_bytes(path("a.txt"));
    ASSERT_EQ(last.size(), 200'000U);
    EXPECT_EQ(last, content(last.front() - 'a')) << "of one thread alone";
    EXPECT_EQ(file_count(), 1U);
}

TEST_F(AtomicFiles, TheTemporaryFileIsItsOwn) {
    write("victim", "before");
    {
        AtomicFile one(path("a.vtu")), two(path("a.vtu"));
        EXPECT_NE(one.path(), two.path());
        EXPECT_TRUE(fs::is_regular_file(one.path())) << "it exists from the beginning, so that nobody else can make it";
        EXPECT_TRUE(is_temporary_name(one.path().filename().string()));
        // Somebody who may write to the folder puts a link there.
        fs::remove(one.path());
        fs::create_symlink(path("victim"), one.path());
        EXPECT_NE(error_of([&] { (void)one.open(); }, ErrorCode::Io).find("cannot be written"), std::string::npos);
        EXPECT_NE(error_of([&] { one.commit(); }, ErrorCode::Io).find("cannot be written"), std::string::npos);
    }
    EXPECT_EQ(read_bytes(path("victim")), "before");
    EXPECT_EQ(file_count(), 1U);
    for (const char* name : {"subvol-0123456789abcdef", ".subvol-", ".subvol-0123456789abcde", ".subvol-0123456789abcdeg",
                             ".subvol-0123456789abcdef0", ".subvol-notes.txt", ""}) {
        EXPECT_FALSE(is_temporary_name(name)) << name;
    }
}

TEST_F(AtomicFiles, AReadOnlyFileIsNotReplaced) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write to every file";
    write("a.txt", "before");
    ASSERT_EQ(::chmod(path("a.txt").c_str(), 0444), 0);
    EXPECT_NE(error_of([&] { write_text_file(path("a.txt"), "after"); }, ErrorCode::Io).find("is read-only"),
              std::string::npos);
    EXPECT_EQ(read_bytes(path("a.txt")), "before");
    fs::create_directory(path("closed"));
    ASSERT_EQ(::chmod(path("closed").c_str(), 0555), 0);
    EXPECT_NE(error_of([&] { write_text_file(path("closed/a.txt"), "text"); }, ErrorCode::Io).find("no file can be made"),
              std::string::npos);
    ASSERT_EQ(::chmod(path("closed").c_str(), 0755), 0);
}

TEST_F(AtomicFiles, OtherNamesOfAReplacedFileKeepTheOldContent) {
    write("a.txt", "before");
    fs::create_hard_link(path("a.txt"), path("b.txt"));
    write_text_file(path("a.txt"), "after");
    EXPECT_EQ(read_bytes(path("a.txt")), "after");
    EXPECT_EQ(read_bytes(path("b.txt")), "before");
}

TEST_F(AtomicFiles, AllUnfinishedFilesAreRemoved) {
    std::deque<AtomicFile> many;  // more than one block of places
    for (int k = 0; k < 200; ++k) many.emplace_back(path("part" + std::to_string(k)));
    EXPECT_EQ(file_count(), 200U);
    remove_unfinished_files();  // as the handler of a signal
    EXPECT_EQ(file_count(), 0U);
}

}  // namespace atomic_file_test
}  // namespace subvol::detail
