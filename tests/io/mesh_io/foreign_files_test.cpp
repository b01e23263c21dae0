// SPDX-License-Identifier: Apache-2.0
// Files of other programs: their names, and how what they are converted to is read. Conversions by Python:
// tests/python/convert_test.py.
#include "subvol/foreign_files.h"

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace foreign_files_test {

using testing::ElementsAre;
using testing::HasSubstr;

class ForeignFiles : public TempFolder {
protected:
    ~ForeignFiles() override { read_foreign_files({}); }
    [[nodiscard]] std::string vtu(const HexMesh& mesh) const {
        write_mesh(path("made.vtu"), mesh);
        return read_bytes(path("made.vtu"));
    }
};

TEST_F(ForeignFiles, NamesDecideWhoseFilesTheyAre) {
    EXPECT_EQ(foreign_format("a.bdf")->program, "Nastran");
    EXPECT_EQ(foreign_format("folder/A.NAS")->by, "meshio");
    EXPECT_EQ(foreign_format("run/d3plot")->program, "LS-DYNA");
    EXPECT_TRUE(foreign_format("run.d3plot")->steps);
    EXPECT_EQ(foreign_format("a.tec")->by, "meshio or VTK");
    EXPECT_EQ(foreign_format("a.med")->packages, "python3-meshio, python3-h5py");
    EXPECT_EQ(foreign_format("a.vtu"), nullptr);
    EXPECT_EQ(foreign_format("bdf"), nullptr);
    for (const ForeignFormat& format : foreign_formats()) EXPECT_FALSE(format.endings.empty() || format.by.empty());
    EXPECT_THAT(std::string(foreign_program()), testing::EndsWith("sys.exit(main())\n"));
}

TEST_F(ForeignFiles, GuessesOfTheFirstBytesComeAfterTheName) {
    for (const char* name : {"a.med", "a.h5m", "a.hmf"}) {
        write(name, std::string("\x89HDF\r\n\x1a\n", 8) + std::string(200, '\0'));
        EXPECT_FALSE(is_mesh_file(path(name)));
        read_foreign_files([](const std::filesystem::path&, const ForeignRequest&) -> ForeignFile {
            throw Error(ErrorCode::InvalidInput, "asked");
        });
        EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path(name))); }), HasSubstr("asked"));
        read_foreign_files({});
    }
}

TEST_F(ForeignFiles, AreReadOnceAReaderIsThere) {
    const HexMesh box = make_box(2, 1, 1);
    write("a.bdf", "GRID");
    EXPECT_FALSE(is_mesh_file(path("a.bdf")));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.bdf"))); }), HasSubstr("python3 -m subvol.convert a.bdf"));
    std::vector<std::size_t> steps;
    read_foreign_files([&](const std::filesystem::path& file, const ForeignRequest& asked) {
        const bool has_steps = foreign_format(file)->steps;
        steps.push_back(asked.only_times ? 9 : asked.step.value_or(8));
        return ForeignFile{asked.only_times ? "" : vtu(box),
                           has_steps ? std::vector<double>{0, .5} : std::vector<double>(),
                           {"read by a test"}};
    });
    EXPECT_TRUE(is_mesh_file(path("a.bdf")));
    const ReadResult read = read_mesh(path("a.bdf"));
    EXPECT_EQ(read.mesh.cells, box.cells);
    EXPECT_EQ(read.warnings.front(), "read by a test");
    EXPECT_EQ(open_series(path("a.bdf")).size(), 1u);
    EXPECT_THAT(steps, ElementsAre(8));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.bdf"), {.step = 1})); }), HasSubstr("there is no step 1"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("none.bdf"))); }, ErrorCode::Io), HasSubstr("none.bdf"));
    steps.clear();
    write("d3plot", "states");
    EXPECT_THAT(open_series(path("d3plot")).times, ElementsAre(0, .5));
    const ReadResult step = read_mesh(path("d3plot"), {.step = 0});
    EXPECT_EQ(step.steps, 2u);
    EXPECT_EQ(step.mesh.time, 0);
    EXPECT_EQ(read_mesh(path("d3plot")).mesh.time, .5);
    EXPECT_EQ(read_mesh(path("d3plot"), {.time = .1}).step, 0u);
    EXPECT_THAT(steps, ElementsAre(9, 0, 8, 0));  // times are kept
}

TEST_F(ForeignFiles, ContentsOfTheLibrarysFormatsAreReadByIt) {
    read_foreign_files([](const std::filesystem::path&, const ForeignRequest&) -> ForeignFile {
        throw Error(ErrorCode::InvalidInput, "is not asked");
    });
    write_mesh(path("a.vtu"), make_box(1, 1, 1));
    std::filesystem::rename(path("a.vtu"), path("a.dat"));
    EXPECT_EQ(read_mesh(path("a.dat")).mesh.cells.size(), 1u);
}

TEST_F(ForeignFiles, ErrorsNameTheFile) {
    write("a.bdf", "GRID");
    read_foreign_files([](const std::filesystem::path&, const ForeignRequest&) { return ForeignFile{"<VTKFile", {}, {}}; });
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.bdf"))); }), HasSubstr("a.bdf"));
}

}  // namespace foreign_files_test

}  // namespace subvol::test
