// SPDX-License-Identifier: Apache-2.0
// What `split` may replace and remove: its own files, and nothing of anybody else.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>

#include "lib/temp_folder.h"
#include "subvol/bricks.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol {
namespace brick_folder_test {

namespace fs = std::filesystem;

using test::error_of;
using test::read_bytes;

class BrickFolder : public test::TempFolder {
protected:
    std::string split(const std::string& name = "t.bricks", std::size_t bricks = 2) const {
        return error_of([&] { (void)split_mesh(path(name), mesh_, {.bricks = bricks}); });
    }

    /// Everything in the folder of the test: names, and the bytes of files or the targets of links.
    [[nodiscard]] std::map<std::string, std::string> everything() const {
        std::map<std::string, std::string> all;
        for (const auto& entry : fs::recursive_directory_iterator(path("."))) {
            const std::string name = entry.path().lexically_relative(path(".")).string();
            all[name] = entry.is_symlink()        ? fs::read_symlink(entry.path()).string()
                        : entry.is_regular_file() ? read_bytes(entry.path())
                                                  : "a folder";
        }
        return all;
    }

    /// A split is refused, and nothing has changed.
    void expect_refused(const std::string& said, const std::string& name = "t.bricks") const {
        const auto before = everything();
        const std::string sentence = split(name);
        EXPECT_NE(sentence.find(said), std::string::npos) << sentence;
        EXPECT_EQ(std::ranges::count(sentence, '\n'), 0);
        EXPECT_TRUE(everything() == before) << "something was changed: " << sentence;
    }

    [[nodiscard]] std::string index() const { return read_bytes(path("t.bricks/index.json")); }

    /// A folder of bricks whose index names another file than the first brick.
    void put_name(const std::string& name) const {
        std::string text = index();
        const std::string first = "brick_00000.vtu";
        text.replace(text.find(first), first.size(), name);
        (void)write("t.bricks/index.json", text);
    }

    HexMesh mesh_ = make_model("twist", 4);
};

TEST_F(BrickFolder, AnotherFolderWithAnIndexIsNotReplaced) {
    fs::create_directories(path("t.bricks/src"));
    (void)write("t.bricks/index.html", "<html>");
    (void)write("t.bricks/src/main.js", "main()");
    for (const char* text : {R"({"name": "my site"})", "", "[]", R"({"format": "OpenSubVol bricks"})"}) {
        (void)write("t.bricks/index.json", text);
        expect_refused("is not a folder of bricks");
    }
    fs::remove(path("t.bricks/index.json"));
    expect_refused("is not a folder of bricks");
    fs::create_directory(path("empty"));
    expect_refused("is not a folder of bricks", "empty");
    (void)write("file", "text");
    expect_refused("is not a folder of bricks", "file");
    EXPECT_NE(error_of([&] { (void)split_mesh("", mesh_, {.bricks = 2}); }).find("has no name"), std::string::npos);
    EXPECT_FALSE(fs::exists(".unfinished"));
}

TEST_F(BrickFolder, WhatIsNoneOfItsBricksStaysAndIsNamed) {
    ASSERT_EQ(split(), "no error");
    for (const char* name : {"notes.txt", ".hidden", "brick_00007.vtu", "brick_00001.vtu.bak", "progress.json"}) {
        (void)write("t.bricks/" + std::string(name), "mine");
        expect_refused("holds \"" + std::string(name) + "\", which is none of its bricks");
        fs::remove(path("t.bricks") / name);
    }
    fs::create_directories(path("t.bricks/pictures"));
    expect_refused("holds \"pictures\"");
    fs::remove(path("t.bricks/pictures"));
    // A folder or a link with the name of a brick is no brick.
    fs::rename(path("t.bricks/brick_00001.vtu"), path("elsewhere.vtu"));
    fs::create_directory(path("t.bricks/brick_00001.vtu"));
    expect_refused("holds \"brick_00001.vtu\"");
    fs::remove(path("t.bricks/brick_00001.vtu"));
    fs::create_symlink("../elsewhere.vtu", path("t.bricks/brick_00001.vtu"));
    expect_refused("holds \"brick_00001.vtu\"");
    fs::remove(path("t.bricks/brick_00001.vtu"));
    EXPECT_EQ(split("t.bricks", 3), "no error") << "a folder of bricks with a brick missing is replaced";
    fs::rename(path("t.bricks/index.json"), path("index.json"));
    fs::create_symlink("../index.json", path("t.bricks/index.json"));
    expect_refused("is not a folder of bricks");
}

TEST_F(BrickFolder, AnIndexCannotNameOtherFiles) {
    ASSERT_EQ(split(), "no error");
    (void)write("x", "mine");
    const std::string sound = index();
    for (const std::string name :
         {"../x", "x", "..", ".", "", "index.json", "/etc/passwd", "brick_00001.vtu", "brick_1.vtu", "brick_00000.vtu\\u0000",
          "brick_00000.vtu/../../x", "brick_-0001.vtu", "brick_000001.vtu"}) {
        put_name(name);
        expect_refused("is not a folder of bricks");
        const std::string wrong =
            name == "brick_00001.vtu" ? "names the brick brick_00001.vtu twice" : "is not an index of bricks";
        EXPECT_NE(error_of([&] { (void)open_bricks(path("t.bricks")); }).find(wrong), std::string::npos) << name;
        (void)write("t.bricks/index.json", sound);
    }
    EXPECT_EQ(split("t.bricks", 3), "no error");
    EXPECT_EQ(read_bytes(path("x")), "mine");
    EXPECT_EQ(file_count(), 2U);
}

TEST_F(BrickFolder, AnUnfinishedFolderOfSomebodyElseStays) {
    fs::create_directory(path("t.bricks.unfinished"));
    (void)write("t.bricks.unfinished/thesis.txt", "two years");
    expect_refused("is not an unfinished folder of bricks");
    for (const char* text : {R"({"steps": 3})", "", "{"}) {
        (void)write("t.bricks.unfinished/progress.json", text);
        expect_refused("it holds \"thesis.txt\"");
    }
    fs::remove(path("t.bricks.unfinished/thesis.txt"));
    expect_refused("is not an unfinished folder of bricks");  // its progress is none of ours
    fs::remove(path("t.bricks.unfinished/progress.json"));
    (void)write("t.bricks.unfinished/brick_00000.vtu", "mine");
    expect_refused("is not an unfinished folder of bricks");
    fs::remove(path("t.bricks.unfinished/brick_00000.vtu"));
    fs::remove(path("t.bricks.unfinished"));
    (void)write("t.bricks.unfinished", "");
    expect_refused("is not an unfinished folder of bricks");
    fs::remove(path("t.bricks.unfinished"));
    fs::create_directory(path("there"));
    fs::create_symlink("there", path("t.bricks.unfinished"));
    expect_refused("is not an unfinished folder of bricks");
}

TEST_F(BrickFolder, WhatSomebodyPutIntoAnUnfinishedFolderStays) {
    ASSERT_EQ(split("o.bricks", 3), "no error");
    ASSERT_EQ(split(), "no error");
    fs::rename(path("t.bricks"), path("t.bricks.unfinished"));  // as after a run that ended before the folder had its name
    for (const std::string name : {"notes.txt", ".hidden", "brick_00009.vtu"}) {
        (void)write("t.bricks.unfinished/" + name, "mine");
        expect_refused("it holds \"" + name + "\"");
        fs::remove(path("t.bricks.unfinished") / name);
    }
    fs::copy(path("o.bricks/brick_00002.vtu"), path("t.bricks.unfinished/brick_00002.vtu"));
    expect_refused("of another mesh");
    fs::remove(path("t.bricks.unfinished/brick_00002.vtu"));
    // What a run of ours that was killed leaves is no obstacle, and is gone afterwards.
    (void)write("t.bricks.unfinished/.subvol-0123456789abcdef.json", "half");
    (void)write("t.bricks.unfinished/progress.json", read_bytes(path("t.bricks.unfinished/index.json")));
    EXPECT_EQ(split_mesh(path("t.bricks"), mesh_, {.bricks = 2}).kept, 2U);
    EXPECT_EQ(std::distance(fs::directory_iterator(path("t.bricks")), fs::directory_iterator()), 3);
    EXPECT_FALSE(fs::exists(path("t.bricks.unfinished")));
}

TEST_F(BrickFolder, BricksOfAnotherMeshAreMadeAnew) {
    ASSERT_EQ(split("t.bricks", 5), "no error");
    fs::rename(path("t.bricks"), path("t.bricks.unfinished"));
    fs::rename(path("t.bricks.unfinished/index.json"), path("t.bricks.unfinished/progress.json"));
    const SplitResult made = split_mesh(path("t.bricks"), mesh_, {.bricks = 2});
    EXPECT_EQ(made.kept, 0U);
    EXPECT_EQ(made.written, 2U);
    EXPECT_EQ(std::distance(fs::directory_iterator(path("t.bricks")), fs::directory_iterator()), 3);
    EXPECT_EQ(file_count(), 1U);
}

TEST_F(BrickFolder, ALinkStaysALink) {
    fs::create_directory(path("disk"));
    fs::create_symlink("disk/real.bricks", path("t.bricks"));
    for (const std::size_t bricks :
         {std::size_t{2}, std::size_t{3}}) {  // where there is nothing yet, and where there are bricks
        EXPECT_EQ(split_mesh(path("t.bricks"), mesh_, {.bricks = bricks}).bricks.path, path("t.bricks"));
        EXPECT_EQ(fs::read_symlink(path("t.bricks")), "disk/real.bricks");
        EXPECT_FALSE(fs::is_symlink(path("disk/real.bricks")));
        EXPECT_EQ(open_bricks(path("disk/real.bricks")).bricks.size(), bricks);
    }
    (void)write("disk/real.bricks/notes.txt", "mine");
    expect_refused("holds \"notes.txt\"");
}

TEST_F(BrickFolder, AReplacedFolderKeepsItsPermissions) {
    ASSERT_EQ(split("t.bricks/"), "no error");
    ASSERT_EQ(::chmod(path("t.bricks").c_str(), 02750), 0);
    ASSERT_EQ(::chmod(path("t.bricks/brick_00000.vtu").c_str(), 0600), 0);
    ASSERT_EQ(::chmod(path("t.bricks/index.json").c_str(), 0640), 0);
    ASSERT_EQ(split("t.bricks", 3), "no error");
    const std::map<std::string, mode_t> wanted{{".", 02750},
                                               {"brick_00000.vtu", 0600},
                                               {"brick_00002.vtu", 0640},  // a new one has those of the index
                                               {"index.json", 0640}};
    for (const auto& [name, mode] : wanted) {
        struct stat now {};
        ASSERT_EQ(::stat((path("t.bricks") / name).c_str(), &now), 0);
        EXPECT_EQ(now.st_mode & 07777, mode) << name;
    }
    EXPECT_EQ(file_count(), 1U);
}

}  // namespace brick_folder_test
}  // namespace subvol
