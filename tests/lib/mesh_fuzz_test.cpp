#include <gtest/gtest.h>

#include <random>

#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "temp_folder.h"
#include "test_meshes.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace {

// Any byte, but often those that mean something to a parser.
char odd_byte(std::mt19937& random) {
    constexpr std::string_view kLikely = "0123456789-+.eE \n#na\t%\"";
    const auto draw = random();
    return draw % 2 == 0 ? static_cast<char>(draw >> 8) : kLikely[(draw >> 8) % kLikely.size()];
}

std::string damaged(std::string text, std::mt19937& random) {
    const auto place = [&] { return random() % text.size(); };
    const auto ways = random() % 4;
    if (ways == 0) return text.substr(0, place());
    if (ways == 1) return text.erase(place(), 1 + random() % 40);
    if (ways == 2) return text.insert(place(), text.substr(place(), random() % 40));
    for (auto flips = 1 + random() % 4; flips > 0; --flips) text[place()] = odd_byte(random);
    return text;
}

class MeshFuzz : public TempFolder {
protected:
    // Whatever is read is sound, and whatever is not is refused by an Error; nothing else leaves the reader.
    void expect_sound_or_refused(const std::string& extension, const std::string& text, unsigned seed) const {
        constexpr int kRuns = 1500;
        std::mt19937 random(seed);
        int refused = 0;
        for (int run = 0; run < kRuns; ++run) {
            const auto file = write(std::to_string(run) + extension, damaged(text, random));  // a new one: truncating is slow
            try {
                validate(read_mesh(file).mesh);
            } catch (const Error& error) {
                EXPECT_FALSE(std::string(error.what()).empty());
                ++refused;
            }
            std::filesystem::remove(file);
        }
        EXPECT_GT(refused, kRuns / 10);  // the damage is real
    }
};

TEST_F(MeshFuzz, Medit) {
    const std::string text = "# c\n" + medit_text(make_box(2, 2, 2)) + "Tetrahedra 1\n1 2 3 4 0\nCorners 1\n1\n";
    expect_sound_or_refused(".mesh", replaced(text, "End\n", ""), 1);
}

TEST_F(MeshFuzz, VtkCountedCells) {
    std::string text = vtk_text(make_box(2, 2, 1)) +
                       "METADATA\nINFORMATION 0\n\nPOINT_DATA 18\nSCALARS s%20t double 1\n"
                       "LOOKUP_TABLE t\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\nLOOKUP_TABLE t 1\n"
                       "0 0 0 1\nCELL_DATA 4\nFIELD f 2\na 1 4 int\n1 2 3 4\nb 1 4 string\n1\n\n3\n4\n";
    expect_sound_or_refused(".vtk", text, 2);
}

TEST_F(MeshFuzz, VtkOffsetsAndConnectivity) {
    const HexMesh mesh = make_box(2, 1, 1);
    const std::string text = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" +
                             point_lines(mesh) + "CELLS 4 20\nOFFSETS vtktypeint64\n0 8 16 20\nCONNECTIVITY vtktypeint64\n" +
                             cell_lines(mesh, 0) + "0 1 2 3\nCELL_TYPES 3\n12\n12\n10\nCELL_DATA 3\nVECTORS v float\n" +
                             "1 2 3 4 5 6 7 8 9\n";
    expect_sound_or_refused(".vtk", text, 3);
}

TEST_F(MeshFuzz, VtkBinary) {
    const std::string eight = bytes_of(std::vector<double>(12, 0.5), std::endian::big);
    const std::string text = binary_vtk_text(make_box(2, 1, 1)) + "METADATA\nINFORMATION 0\n\nPOINT_DATA 12\nFIELD f 3\n" +
                             "a 1 12 double\n" + eight + "\nb 1 12 bit\nab\nc 1 2 string\n\xC1x\x80\x02yz\n" +
                             "COLOR_SCALARS r 1\n0123456789ab\nCELL_DATA 2\nSCALARS s short\nLOOKUP_TABLE default\nabcd\n";
    expect_sound_or_refused(".vtk", text, 4);
}

TEST_F(MeshFuzz, VtkBinaryOffsetsAndConnectivity) {
    const HexMesh mesh = make_box(2, 1, 1);
    std::vector<std::int64_t> corners = corners_as<std::int64_t>(mesh);
    corners.insert(corners.end(), {0, 1, 3, 6});
    const auto big = [](const auto& values) { return bytes_of(values, std::endian::big); };
    const std::string text = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" +
                             big(coordinates_as<double>(mesh)) + "\nCELLS 4 20\nOFFSETS vtktypeint64\n" +
                             big(std::vector<std::int64_t>{0, 8, 16, 20}) + "\nCONNECTIVITY vtktypeint64\n" + big(corners) +
                             "\nCELL_TYPES 3\n" + big(std::vector<std::int32_t>{12, 12, 10}) + "\n";
    expect_sound_or_refused(".vtk", text, 5);
}

TEST_F(MeshFuzz, VtuOfEveryEncoding) {
    unsigned seed = 6;
    for (const auto& [format, encoding] : std::vector<std::pair<std::string, std::string>>{
             {"ascii", ""}, {"binary", ""}, {"appended", "raw"}, {"appended", "base64"}}) {
        for (const std::string compressor : {"", "vtkZLibDataCompressor", "vtkLZMADataCompressor", "vtkLZ4DataCompressor"}) {
            if (format == "ascii" && !compressor.empty()) continue;
            VtuText vtu{.format = format, .encoding = encoding, .compressor = compressor};
            const std::string data = "<PointData>" + vtu.array("Float32", "Name=\"s\"", std::vector<float>(8, 1)) +
                                     "</PointData><CellData>" + vtu.array("Int16", "Name=\"c\"", std::vector<std::int16_t>{1}) +
                                     "</CellData>";
            const std::string piece = vtu.piece(make_box(1, 1, 1), data);
            expect_sound_or_refused(".vtu", vtu.file(piece + piece), seed++);
        }
    }
}

TEST_F(MeshFuzz, Gmsh) {
    const std::string text =
        replaced(gmsh_text(make_box(2, 1, 1), "2 1 3"), "$Elements\n2\n", "$Elements\n4\n1 4 0 1 2 4 7\n2 3 0 1 2 3 4\n") +
        "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n12\n1 1\n2 2\n3 3\n4 4\n5 5\n6 6\n7 7\n8 8\n9 9\n"
        "10 1\n11 1\n12 1\n$EndNodeData\n";
    expect_sound_or_refused(".msh", text, 30);
}

TEST_F(MeshFuzz, MixedCells) {
    const std::string cells = "Pyramids 1\n1 2 7 6 4 0\nPrisms 1\n1 2 3 6 7 8 0\nTetrahedra 1\n1 2 3 5 0\nHexahedra 0\n";
    const std::string vertices = "Vertices 8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n.5 -1 .5 0\n0 0 -1 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\n";
    expect_sound_or_refused(".mesh", "MeshVersionFormatted 2\nDimension 3\n" + vertices + cells, 31);
    expect_sound_or_refused(".mesh", "MeshVersionFormatted 2\nDimension 3\n" + cells + vertices, 32);
}

}  // namespace

}  // namespace subvol::test
