// SPDX-License-Identifier: Apache-2.0
// Plot3D's grids and flows: the files do not state their encoding.

#include <gmock/gmock.h>

#include "binary_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace plot3d_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

enum class Form { Text, Records, Bytes };

// Writes the records of a file in one encoding.
struct Plot3dText {
    Form form = Form::Text;
    std::endian order = std::endian::little;
    bool doubles = true;
    std::string text{};

    void integers(const std::vector<std::int32_t>& values) { record(values); }
    void places(const HexMesh& mesh, const std::vector<std::int32_t>& blanks = {}) {
        std::vector<double> values;
        for (int a = 0; a < 3; ++a) {
            for (const Vec3& x : mesh.points) values.push_back(x[a]);
        }
        std::string body = reals(values);
        if (!blanks.empty()) body += form == Form::Text ? words(blanks) : bytes_of(blanks, order);
        add(body);
    }
    void values(const std::vector<double>& list) { add(reals(list)); }

private:
    template <class T>
    static std::string words(const std::vector<T>& values) {
        std::string line;
        for (const T& value : values) line += number(static_cast<double>(value)) + " ";
        return line + "\n";
    }
    [[nodiscard]] std::string reals(const std::vector<double>& values) const {
        if (form == Form::Text) return words(values);
        return doubles ? bytes_of(values, order) : bytes_of(std::vector<float>(values.begin(), values.end()), order);
    }
    void record(const std::vector<std::int32_t>& values) { add(form == Form::Text ? words(values) : bytes_of(values, order)); }
    void add(const std::string& body) {
        const std::string mark = bytes_of(std::vector{static_cast<std::int32_t>(body.size())}, order);
        text += form == Form::Records ? mark + body + mark : body;
    }
};

class Plot3dIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text, const ReadOptions& options = {}) const {
        return read_mesh(write("a.xyz", text), options);
    }
};

const HexMesh kBox = make_box(3, 2, 4);

void expect_box(const HexMesh& mesh) {
    EXPECT_EQ(mesh.points, kBox.points);
    EXPECT_EQ(mesh.cells, kBox.cells);
}

std::vector<Plot3dText> all_encodings() {
    std::vector<Plot3dText> all{{}};
    for (const Form form : {Form::Records, Form::Bytes}) {
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            for (const bool doubles : {false, true}) all.push_back({form, order, doubles});
        }
    }
    return all;
}

TEST_F(Plot3dIo, OneBlockInEveryEncoding) {
    for (Plot3dText grid : all_encodings()) {
        grid.integers({4, 3, 5});
        grid.places(kBox);
        expect_box(read(grid.text).mesh);
    }
}

TEST_F(Plot3dIo, BlanksHidePoints) {
    for (Plot3dText grid : all_encodings()) {
        grid.integers({4, 3, 5});
        std::vector<std::int32_t> blanks(60, 1);
        blanks[0] = 0;
        grid.places(kBox, blanks);
        const ReadResult result = read(grid.text);
        EXPECT_THAT(result.warnings, ElementsAre("1 cell with hidden points left out"));
        EXPECT_EQ(inspect(result.mesh).volume, 23);
    }
}

TEST_F(Plot3dIo, BlocksAreWelded) {
    HexMesh left = make_box(1, 2, 4), right = make_box(2, 2, 4);
    for (Vec3& x : right.points) x.x += 1;
    for (Plot3dText grid : all_encodings()) {
        grid.integers({2});
        grid.integers({2, 3, 5, 3, 3, 5});
        grid.places(left);
        grid.places(right);
        const ReadResult result = read(grid.text, {.weld = 0});
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("15 points welded")));
        EXPECT_EQ(inspect(result.mesh).faces, inspect(kBox).faces);
    }
}

TEST_F(Plot3dIo, TheFlowBesideIsTaken) {
    for (Plot3dText flow : all_encodings()) {
        Plot3dText grid{flow.form, flow.order, flow.doubles};
        grid.integers({4, 3, 5});
        grid.places(kBox);
        flow.integers({4, 3, 5});
        flow.values({0.5, 0, 1000, 0});
        std::vector<double> values;
        for (int i = 0; i < 300; ++i) values.push_back(i);
        flow.values(values);
        write("a.q", flow.text);
        const ReadResult result = read(grid.text);
        EXPECT_TRUE(result.warnings.empty());
        EXPECT_EQ(result.mesh.find_attribute("Density")->values[59], 59);
        const auto& momentum = result.mesh.find_attribute("Momentum")->values;
        EXPECT_EQ(Vec3(momentum[3], momentum[4], momentum[5]), Vec3(61, 121, 181));
        EXPECT_EQ(result.mesh.find_attribute("StagnationEnergy")->values[0], 240);
        write("a.q", flow.text + "1");
        EXPECT_THAT(read(grid.text).warnings,
                    ElementsAre(HasSubstr("a.q\" ignored: the flow in it does not have these blocks")));
        std::filesystem::remove(path("a.q"));
    }
}

TEST_F(Plot3dIo, WhatIsNoGridIsRefused) {
    for (Plot3dText grid : all_encodings()) {
        grid.integers({4, 3, 5});
        grid.places(kBox);
        for (std::size_t length = 0; length < grid.text.size() - 4; length += 7) {
            EXPECT_NE(error_of([&] { static_cast<void>(read(grid.text.substr(0, length))); }), "no error") << length;
        }
    }
    EXPECT_THAT(error_of([&] { static_cast<void>(read("")); }), HasSubstr("the file is empty"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read("2 2 2 1 2 3")); }),
                HasSubstr("not a Plot3D grid: the size of the file does not match"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read("8 1 1 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8")); }),
                HasSubstr("no hexahedra"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read("2147483647 2147483647 2147483647 1")); }),
                HasSubstr("not a Plot3D grid"));
}

}  // namespace plot3d_io_test

}  // namespace subvol::test
