#include <gtest/gtest.h>

#include <random>

#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "temp_folder.h"
#include "test_meshes.h"

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

}  // namespace

}  // namespace subvol::test
