// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_io.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstring>

#include <sys/resource.h>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "mesh_texts.h"
#include "subvol/mesh_report.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace mesh_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

// Coordinates that are no short decimals: a round trip must give back every bit.
HexMesh awkward_box() {
    HexMesh mesh = make_box(2, 2, 2);
    for (Vec3& x : mesh.points) x = {x.x / 3 + 1e-17, x.y * std::sqrt(2.0) * 1e6, x.z / 7e9 - 4.9406564584124654e-324};
    return mesh;
}

class MeshIo : public MeshFiles {};

const HexMesh kBox = make_box(2, 2, 2);

TEST_F(MeshIo, MeditRoundTripKeepsEveryBit) {
    const HexMesh mesh = awkward_box();
    EXPECT_TRUE(write_mesh(path("box.mesh"), mesh).empty());
    const ReadResult back = read_mesh(path("box.mesh"));
    expect_same_geometry(back.mesh, mesh);
    EXPECT_TRUE(back.warnings.empty());
    EXPECT_TRUE(back.fields.empty());
}

TEST_F(MeshIo, ErrorsBeginWithTheFile) {
    EXPECT_THAT(read_error("a.mesh", "OFF"), testing::StartsWith(path("a.mesh").string() + ", line 1: "));
    EXPECT_THAT(read_error("a.vtk", "OFF"), testing::StartsWith(path("a.vtk").string() + ", line 1: "));
}

TEST_F(MeshIo, NonFinitePointsThatNoCellUsesAreIgnored) {
    const auto text = replaced(replaced(medit_text(kBox), "\n27\n", "\n28\n"), "Hexahedra", "nan inf 0 0\nHexahedra");
    EXPECT_EQ(read("a.mesh", text).mesh.points.size(), 28u);
}

TEST_F(MeshIo, LeftHandedCellsAreTurnedAndCounted) {
    HexMesh mirrored = kBox;
    for (std::size_t c = 0; c < 3; ++c)
        std::swap_ranges(mirrored.cells[c].begin(), mirrored.cells[c].begin() + 4, mirrored.cells[c].begin() + 4);
    const ReadResult result = read("a.mesh", medit_text(mirrored));
    EXPECT_EQ(result.mesh.cells, kBox.cells);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("3 of 8 hexahedra were left-handed")));
}

TEST_F(MeshIo, FoldedCellsStayAndAreCounted) {
    HexMesh folded = kBox;
    folded.points[13] = Vec3(1.9);  // the centre close to the far corner: the last cell is concave there
    const ReadResult result = read("a.mesh", medit_text(folded));
    expect_same_geometry(result.mesh, folded);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 of 8 hexahedra has a negative Jacobian at a corner")));
}

// The values of an array that a file holds as base64, compressed by zlib in one block.
template <class T>
std::vector<T> compressed(const std::string& file, const std::string& name) {
    const auto array = file.find("Name=\"" + name + "\"");
    const auto begin = file.find('\n', array) + 1;
    const std::string text = file.substr(begin, file.find('\n', begin) - begin);
    constexpr std::size_t kHeader = 44;  // four numbers of 8 bytes
    std::array<std::uint64_t, 4> header{};
    const std::string numbers = from_base64(text.substr(0, kHeader)), data = from_base64(text.substr(kHeader));
    std::memcpy(header.data(), numbers.data(), sizeof header);
    EXPECT_EQ(header[0], 1u);
    EXPECT_EQ(header[3], data.size());
    std::vector<T> values(header[2] / sizeof(T));
    uLongf size = header[2];
    EXPECT_EQ(
        uncompress(reinterpret_cast<Bytef*>(values.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size()),
        Z_OK);
    EXPECT_EQ(size, header[2]);
    return values;
}

TEST_F(MeshIo, VtuHoldsTheMeshToTheBit) {
    HexMesh mesh = awkward_box();
    mesh.attributes.push_back({"a<\"b\">", 1, std::vector<double>(27, 1.0 / 3)});
    mesh.attributes.push_back({"velocity", 3, std::vector<double>(81, -0.1)});
    EXPECT_TRUE(write_mesh(path("box.vtu"), mesh).empty());
    const std::string file = read_bytes(path("box.vtu"));
    EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"27\" NumberOfCells=\"8\""));
    EXPECT_THAT(file, HasSubstr("Name=\"velocity\" NumberOfComponents=\"3\""));
    const auto points = compressed<Vec3>(file, "Points");
    EXPECT_EQ(points, mesh.points);
    const auto connectivity = compressed<std::int64_t>(file, "connectivity");
    ASSERT_EQ(connectivity.size(), 64u);
    for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(connectivity[i], mesh.cells[i / 8][i % 8]);
    EXPECT_THAT(compressed<std::int64_t>(file, "offsets"), ElementsAre(8, 16, 24, 32, 40, 48, 56, 64));
    EXPECT_EQ(compressed<std::uint8_t>(file, "types"), std::vector<std::uint8_t>(8, 12));
    EXPECT_EQ(compressed<double>(file, "a&lt;&quot;b&quot;&gt;"), mesh.attributes[0].values);
    EXPECT_EQ(compressed<double>(file, "velocity"), mesh.attributes[1].values);
}

TEST_F(MeshIo, AWarningListsWhatAFormatCannotHold) {
    HexMesh mesh = kBox;
    mesh.attributes.push_back({"density", 1, std::vector<double>(27)});
    mesh.creases.push_back({0, 1});
    EXPECT_THAT(write_mesh(path("a.mesh"), mesh), ElementsAre(HasSubstr("\"density\""), HasSubstr("1 crease written as")));
}

TEST_F(MeshIo, UnknownFormatsAndMissingFilesAreRefused) {
    const std::string refusal = read_error("a.abc", "none of ours");
    EXPECT_THAT(refusal,
                HasSubstr("\".abc\" files cannot be read (docs/formats.md and `subvol info --help` list the formats that can"));
#ifdef SUBVOL_SOLVERS
    EXPECT_THAT(refusal, testing::EndsWith("that can)"));
#else
    EXPECT_THAT(refusal, HasSubstr("without the readers of solvers' files, SUBVOL_SOLVERS"));
#endif
    EXPECT_THAT(error_of([&] { write_mesh(path("a.vtk"), kBox); }),
                HasSubstr("\".vtk\" files cannot be written (.mesh: MEDIT; .vtu: VTK XML; .msh: Gmsh; .vtkhdf, .hdf: VTKHDF"));
    const auto missing = [&] { static_cast<void>(read_mesh(path("none.mesh"))); };
    EXPECT_THAT(error_of(missing, ErrorCode::Io), HasSubstr("none.mesh: cannot be read: No such file"));
    std::filesystem::create_directory(path("folder.mesh"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("folder.mesh"))); }, ErrorCode::Io), HasSubstr("directory"));
    EXPECT_THAT(error_of([&] { write_mesh(path("no/a.vtu"), kBox); }, ErrorCode::Io), HasSubstr("does not exist"));
}

TEST_F(MeshIo, ListedExtensionsAreThoseThatAreReadAndWritten) {
    for (const std::string& extension : readable_mesh_extensions()) {
        const auto missing = [&] { static_cast<void>(read_mesh(path("none" + extension))); };
        EXPECT_THAT(error_of(missing, ErrorCode::Io), HasSubstr("cannot be read: No such file"));
    }
    for (const std::string& extension : writable_mesh_extensions()) {
        if (extension.ends_with("hdf")) continue;       // not in every build
        const auto folder = path(extension.substr(1));  // an OpenFOAM case has one of its own
        std::filesystem::create_directory(folder);
        write_mesh(folder / ("a" + extension), kBox);
        const HexMesh read = read_mesh(folder / ("a" + extension)).mesh;
        EXPECT_EQ(read.points, kBox.points);
        EXPECT_EQ(read.cells.size(), kBox.cells.size());
        if (!extension.ends_with("foam")) {  // where cells are faces their corners may turn
            EXPECT_EQ(read.cells, kBox.cells);
        }
    }
    EXPECT_THAT(readable_mesh_extensions(), testing::Contains(".xdmf"));
    for (const char* extension : {".mesh", ".vtu", ".msh", ".vtkhdf", ".hdf"})
        EXPECT_THAT(writable_mesh_extensions(), testing::Contains(extension));
}

// What a file is decides, where it shows that beyond doubt; its name is believed otherwise.
TEST_F(MeshIo, TheContentsDecideWhereTheEndingIsMisleading) {
    write_mesh(path("a.vtu"), kBox);
    for (const auto& [from, to] : {std::array{"a.vtu", "a.vtk"}, std::array{"a.vtu", "a.msh"}, std::array{"a.vtu", "a.xdmf"}}) {
        std::filesystem::copy_file(path(from), path(to), std::filesystem::copy_options::overwrite_existing);
        const ReadResult result = read_mesh(path(to));
        expect_same_geometry(result.mesh, kBox);
        EXPECT_THAT(result.warnings, testing::Contains(HasSubstr("the contents are those of VTK XML, which decides")));
    }
    EXPECT_EQ(read("b.vtu", medit_text(kBox)).mesh.cells, kBox.cells);
    EXPECT_EQ(read("b.msh", vtk_text(kBox)).mesh.cells, kBox.cells);
    EXPECT_TRUE(read("b.mesh", medit_text(kBox)).warnings.empty());
    // Nothing that only suggests a format is stronger than the name.
    EXPECT_THAT(read_error("c.mesh", "** FORMAT *NODE ENSIGHT GEOMETRY"), HasSubstr("c.mesh, line 1"));
    EXPECT_THAT(read_error("c.obj", "v 0 0 0"), HasSubstr("/c.obj -o c.vtu` makes a control mesh of it"));
}

TEST_F(MeshIo, MeshesThatAreNotSoundAreNotWritten) {
    HexMesh mesh = kBox;
    mesh.cells[3][0] = 99;
    EXPECT_THAT(error_of([&] { write_mesh(path("a.vtu"), mesh); }), HasSubstr("cell 3"));
    EXPECT_EQ(file_count(), 0u);
}

// Simulates a full disk: limits the size of files.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

TEST_F(MeshIo, AFullDiskIsAnErrorAndLeavesNothing) {
    for (const std::string name : {"a.mesh", "a.vtu"}) {
        for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{20000}}) {
            const FileSizeLimit limit(bytes);
            const auto write = [&] { write_mesh(path(name), make_box(12, 12, 12)); };
            EXPECT_THAT(error_of(write, ErrorCode::Io), HasSubstr(name + ": cannot be written"));
            EXPECT_EQ(file_count(), 0u);
        }
    }
}

}  // namespace mesh_io_test

}  // namespace subvol::test
