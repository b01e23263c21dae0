// SPDX-License-Identifier: Apache-2.0
// MEDIT's binary files.

#include <gmock/gmock.h>

#include "binary_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace meshb_io_test {

using testing::HasSubstr;

// Writes files of one version, section by section.
class MeshbText {
public:
    explicit MeshbText(int version, std::endian order = std::endian::little) : version_(version), order_(order) {
        add<std::int32_t>({1, version});
        begin(3);
        add<std::int32_t>({3});
        end();
    }

    void vertices(const HexMesh& mesh) {
        begin(4);
        integers({static_cast<std::int64_t>(mesh.points.size())});
        for (const Vec3& x : mesh.points) {
            version_ == 1 ? add<float>({static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)})
                          : add<double>({x.x, x.y, x.z});
            integers({5});
        }
        end();
    }

    /// Each cell with its reference; corners counted from 1.
    void cells(std::int32_t section, const std::vector<std::vector<std::int64_t>>& cells) {
        begin(section);
        integers({static_cast<std::int64_t>(cells.size())});
        for (const auto& cell : cells) integers(cell);
        end();
    }

    void hexahedra(const HexMesh& mesh) {
        std::vector<std::vector<std::int64_t>> list;
        for (const auto& cell : mesh.cells) {
            list.emplace_back();
            for (const Index p : cell) list.back().push_back(static_cast<std::int64_t>(p) + 1);
            list.back().push_back(0);
        }
        cells(10, list);
    }

    std::string text() {
        begin(54);
        return text_ + positions(0);
    }

private:
    template <class T>
    void add(const std::vector<T>& values) {
        text_ += bytes_of(values, order_);
    }
    void integers(const std::vector<std::int64_t>& values) {
        version_ == 4 ? add(values) : add(std::vector<std::int32_t>(values.begin(), values.end()));
    }
    [[nodiscard]] std::string positions(std::size_t position) const {
        return version_ < 3 ? bytes_of(std::vector{static_cast<std::int32_t>(position)}, order_)
                            : bytes_of(std::vector{static_cast<std::int64_t>(position)}, order_);
    }
    void begin(std::int32_t section) {
        add<std::int32_t>({section});
        place_ = text_.size();
        if (section != 54) text_ += positions(0);
    }
    void end() { text_.replace(place_, positions(0).size(), positions(text_.size())); }

    int version_;
    std::endian order_;
    std::string text_;
    std::size_t place_ = 0;
};

class MeshbIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text, const ReadOptions& options = {}) const {
        return read_mesh(write("a.meshb", text), options);
    }
    [[nodiscard]] std::string read_error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

const HexMesh kBox = make_box(2, 1, 3);

TEST_F(MeshbIo, EveryVersionInBothOrdersOfBytes) {
    for (const int version : {1, 2, 3, 4}) {
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            MeshbText meshb(version, order);
            meshb.hexahedra(kBox);  // before the vertices
            meshb.cells(6, {{1, 2, 3, 0}});
            meshb.vertices(kBox);
            const ReadResult result = read(meshb.text());
            EXPECT_EQ(result.mesh.points, kBox.points);
            EXPECT_EQ(result.mesh.cells, kBox.cells);
            EXPECT_TRUE(result.warnings.empty());
        }
    }
}

TEST_F(MeshbIo, OtherCells) {
    MeshbText meshb(2);
    meshb.vertices(make_box(1, 1, 1));
    meshb.cells(8, {{1, 2, 3, 5, 0}});
    meshb.cells(9, {{1, 2, 3, 5, 6, 7, 0}});
    meshb.cells(49, {{1, 2, 4, 3, 5, 0}});
    const std::string text = meshb.text();
    EXPECT_THAT(read(text).warnings[0], HasSubstr("1 tetrahedron, 1 prism and 1 pyramid cut into 6 tetrahedra"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read(text, {.other_cells = OtherCells::Ignore})); }),
                HasSubstr("no hexahedra, but 1 tetrahedron, 1 prism, 1 pyramid, which are ignored"));
}

TEST_F(MeshbIo, GroupsCanBeKeptSharp) {
    for (const int version : {1, 4}) {
        MeshbText meshb(version, std::endian::big);
        const HexMesh box = make_box(2, 1, 1);
        meshb.cells(7, {{2, 5, 11, 8, 7}, {1, 4, 10, 7, 9}});
        meshb.cells(5, {{1, 2, 3}, {8, 11, 0}});
        meshb.cells(14, {{2}});
        meshb.vertices(box);
        meshb.hexahedra(box);
        const HexMesh mesh = read(meshb.text(), {.sharp = {"7", "3", "Ridges"}}).mesh;
        ASSERT_EQ(mesh.sharp_faces.size(), 1u);
        for (const Index p : mesh.sharp_faces[0]) EXPECT_EQ(mesh.points[p].x, 1);
        EXPECT_EQ(mesh.creases, (std::vector<std::array<Index, 2>>{{0, 1}, {7, 10}}));
        EXPECT_TRUE(read(meshb.text(), {.sharp = {"9"}}).mesh.sharp_faces.empty());  // on the hull
    }
    MeshbText meshb(2);
    meshb.vertices(kBox);
    meshb.hexahedra(kBox);
    meshb.cells(5, {{1, 2, 3}});
    meshb.cells(14, {{2}});
    EXPECT_THAT(error_of([&] { static_cast<void>(read(meshb.text(), {.sharp = {"Ridges"}})); }),
                HasSubstr("Ridges: there is no edge with index 2 (indices are 1 to 1)"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read(meshb.text(), {.sharp = {"4"}})); }), HasSubstr("it has: 3"));
}

TEST_F(MeshbIo, CutAnywhereItIsRefused) {
    MeshbText meshb(3);
    meshb.vertices(kBox);
    meshb.hexahedra(kBox);
    const std::string text = meshb.text();
    const std::size_t end = text.size() - 12;  // the section End has no contents
    for (std::size_t length = 0; length < end; ++length) EXPECT_NE(read_error(text.substr(0, length)), "no error") << length;
}

TEST_F(MeshbIo, ErrorsNameThePlace) {
    const auto file = [](std::int64_t corner, std::int32_t section = 10) {
        MeshbText meshb(4);
        meshb.vertices(make_box(1, 1, 1));
        meshb.cells(section, {{1, 2, 4, 3, 5, 6, 8, corner, 0}});
        return meshb.text();
    };
    EXPECT_THAT(read_error(file(9)), HasSubstr("hex 1: there is no vertex with index 9 (indices are 1 to 8)"));
    EXPECT_THAT(read_error(file(-1)), HasSubstr("there is no vertex with index -1"));
    EXPECT_THAT(read_error(file(4)), HasSubstr("hex 1 has vertex 4 twice"));
    EXPECT_THAT(read_error(file(7, 4)), HasSubstr("there is a second section of the kind 4"));
    EXPECT_THAT(read_error(""), HasSubstr("the file is empty"));
    EXPECT_THAT(read_error("neither text nor binary"), HasSubstr("not a binary MEDIT file"));
    const auto numbers = [](std::vector<std::int32_t> list) { return bytes_of(list, std::endian::little); };
    EXPECT_THAT(read_error(numbers({1, 5})), HasSubstr("version 5 is not supported"));
    EXPECT_THAT(read_error(numbers({1, 2, 3, 0, 2})), HasSubstr("dimension 2 is not supported"));
    EXPECT_THAT(read_error(numbers({1, 2, 3, 20, 3, 4, 20, 0})), HasSubstr("a section begins before the one that names it"));
    EXPECT_THAT(read_error(numbers({1, 2, 3, 20, 3, 4, 9999, 0})), HasSubstr("byte 9999, after the end of the file"));
    EXPECT_THAT(read_error(numbers({1, 2, 3, 20, 3, 4, 0, 1 << 30})), HasSubstr("Vertices: count out of range: 1073741824"));
    EXPECT_THAT(read_error(numbers({1, 2, 3, 20, 3, 4, 0, -1})), HasSubstr("Vertices: negative count -1"));
}

}  // namespace meshb_io_test

}  // namespace subvol::test
