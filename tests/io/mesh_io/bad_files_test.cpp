// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <numeric>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace bad_files_test {

using testing::HasSubstr;

// The folder of small faulty files, next to the real meshes.
std::filesystem::path bad_folder() {
    const auto data = data_folder();
    return data ? (*data / ".." / "bad").lexically_normal() : std::filesystem::path();
}

// The expected contents of a correct file. warning: a part of one of the warnings; empty if there must be none
struct Good {
    std::string file;
    std::string warning;
    std::size_t points_used = 27;
    std::size_t cells = 8;
    std::size_t edges = 54;
    std::size_t faces = 36;
    double volume = 8;
};

struct Bad {
    std::string file;
    std::string message;
};

const std::vector<Good> kGood{
    {"00_ok.mesh", ""},
    {"01_crlf_ok.mesh", ""},
    {"02_comments_ok.mesh", ""},
    {"03_bom_ok.mesh", ""},
    {"04_freeform_ok.mesh", ""},
    {"05_extra_sections_ok.mesh", "MyVendorSection (3)"},
    {"06_no_end_ok.mesh", ""},
    {"07_unused_vertices_ok.mesh", ""},
    {"08_two_components_edge_contact_ok.mesh", "", 14, 2, 23, 12, 2},
    {"09_irregular3_ok.mesh", "", 14, 3, 25, 15, 10.2},
    // An edge has no length: a corner of the cube of 8 cells is cut off, up to the diagonal of a face that runs through it.
    {"25_duplicate_vertex_in_hex.mesh", "1 cell with repeated points taken as 4 tetrahedra", 287, 184, 729, 627, 8 - 1.0 / 3},
    {"26_one_inverted_hex.mesh", "1 of 8 hexahedra was left-handed"},
    {"27_all_inverted.mesh", "8 of 8 hexahedra were left-handed"},
    {"28_folded_hex.mesh", "1 of 8 hexahedra has a negative Jacobian"},
    {"31_mixed_tet_hex.mesh", "8 hexahedra and 1 tetrahedron split into 68 hexahedra", 133, 68, 322, 258, 8 + 1.0 / 6},
    {"32_tet_only.mesh", "1 tetrahedron split into 4 hexahedra", 15, 4, 28, 18, 1.0 / 6},
    {"50_ok.vtk", ""},
    {"51_crlf_ok.vtk", ""},
    {"52_v51_ok.vtk", ""},
    {"53_type10_with_8_vertices.vtk", "8 cells with 8 corners but the type of a tetrahedron"},
    {"54_voxel11_ok.vtk", ""},
    {"55_binary_ok.vtk", ""},
    {"63_negative_density.vtk", "\"density\" has negative values"},
    {"64_no_scalars_ok.vtk", ""},
    {"65_structured_grid.vtk", ""},
    {"68_latin1_title.vtk", ""},
    {"69_wedge_hex_mix.vtk", "7 hexahedra and 1 prism split into 62 hexahedra", 123, 62, 295, 235, 7.5},
    {"80_ok_ascii.vtu", ""},
    {"81_ok_appended_base64.vtu", ""},
    {"82_ok_appended_raw.vtu", ""},
    {"83_ok_appended_raw_zlib.vtu", ""},
};

const std::vector<Bad> kBad{
    {"10_empty.mesh", "line 1: the file is empty"},
    {"11_garbage.mesh", "not a MEDIT file"},
    {"12_wrong_header.mesh", "line 1: not a MEDIT file: it begins with \"OFF\""},
    {"13_truncated_in_vertices.mesh", "line 17: vertex 14 of 27: unexpected end of file"},
    {"14_truncated_in_hexes.mesh", "line 36: hex 3 of 8: unexpected end of file"},
    {"15_index_out_of_range.mesh", "line 41: hex 8: there is no vertex with index 28"},
    {"16_zero_based.mesh", "line 34: hex 1: there is no vertex with index 0"},
    {"17_negative_index.mesh", "line 34: hex 1: there is no vertex with index -5"},
    {"18_nan_vertex.mesh", "line 18: non-finite coordinate at vertex 14"},
    {"19_inf_overflow_vertex.mesh", "line 18: non-finite coordinate at vertex 14"},
    {"20_negative_count.mesh", "line 4: Vertices: negative count -27"},
    {"21_huge_vertex_count.mesh", "line 4: Vertices: count out of range"},
    {"22_huge_hex_count_overflow.mesh", "line 33: Hexahedra: number out of range"},
    {"23_zero_cells.mesh", "no hexahedra"},
    {"24_no_hexahedra_section.mesh", "no hexahedra"},
    {"33_dimension2.mesh", "line 2: dimension 2 is not supported"},
    {"34_missing_vertex_ref.mesh", "line 32: vertex 21 of 27: a number is expected, not \"Hexahedra\""},
    {"35_float_index.mesh", "line 34: hex 1 of 8: an integer is expected, not \"1.5\""},
    {"36_letters_in_number.mesh", "line 18: vertex 14 of 27: a number is expected, not \"1x\""},
    {"37_second_vertices_section.mesh", "line 42: there is a second Vertices section"},
    {"38_text_bomb.mesh", "line 4: Vertices: number out of range"},
    {"56_binary_truncated.vtk", "byte 498: cell 2: unexpected end of file"},
    {"57_binary_little_endian.vtk", "it would have 134217728 corners; BINARY numbers have to be big-endian"},
    {"58_cell_count_mismatch.vtk", "there are 7 CELL_TYPES for 8 CELLS"},
    {"59_cells_size_too_small.vtk", "cell 4 does not fit into the 40 numbers"},
    {"60_scalars_too_few.vtk", "array \"density\": value 20: unexpected end of file"},
    {"61_point_data_count_mismatch.vtk", "POINT_DATA is for 28 points, but there are 27"},
    {"66_polydata.vtk", "POLYDATA is not a volume mesh"},
    {"67_index_out_of_range.vtk", "line 41: cell 7: there is no point with index 27"},
    {"84_offset_past_end.vtu", "line 4: array \"connectivity\": its offset 1000000000 is beyond the appended data"},
    {"85_truncated_appended.vtu", "line 4: array \"Points\": its 324 bytes go beyond the end of the data"},
    {"86_corrupt_zlib.vtu", "line 4: array \"connectivity\": block 1 of 1: decompression failed"},
    {"87_connectivity_out_of_range.vtu", "cell 7: there is no point with index 4000000000"},
    {"88_offsets_not_multiple_of_8.vtu", "the last offset is 63, but the connectivity has 64 corners"},
    {"89_entity_bomb.vtu", "line 5: array \"density\": value 0: a number is expected, not \"&a9;0\""},
    {"90_wrong_type_polydata.vtu", "line 2: \"PolyData\" is not an UnstructuredGrid"},
};

// The cells of these can be read.
const std::vector<Bad> kBadFields{
    {"62_nan_density.vtk", "field \"density\" has no value at 1 of 27 points"},
};

// These can be read: only the topology finds that the cells do not fit together.
const std::vector<Bad> kBadTopology{
    {"29_nonmanifold_face.mesh", "has 3 cells"},
    {"30_duplicate_hex.mesh", "have the same corners"},
};

class BadFiles : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::is_directory(bad_folder())) {
            GTEST_SKIP() << "no folder bad beside the one that SUBVOL_DATA names, or SUBVOL_DATA is not set";
        }
    }
};

void expect_density(const HexMesh& mesh, double sign) {
    const Attribute* density = mesh.find_attribute("density");
    ASSERT_NE(density, nullptr);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_EQ(density->values[p], sign * glm::dot(mesh.points[p], Vec3(1, 2, 4)));
    }
}

TEST_F(BadFiles, CorrectFilesHaveTheExpectedFigures) {
    for (const auto& good : kGood) {
        SCOPED_TRACE(good.file);
        const ReadResult result = read_mesh(bad_folder() / good.file);
        const MeshReport report = inspect(result.mesh);
        EXPECT_EQ(report.points_used, good.points_used);
        EXPECT_EQ(report.cells, good.cells);
        EXPECT_EQ(report.edges, good.edges);
        EXPECT_EQ(report.faces, good.faces);
        EXPECT_NEAR(report.volume, good.volume, 1e-12 * good.volume);  // the cell volumes are exact: rounding of their sum only
        const auto said = std::accumulate(result.warnings.begin(), result.warnings.end(), std::string());
        EXPECT_EQ(said.empty(), good.warning.empty()) << said;
        EXPECT_THAT(said, HasSubstr(good.warning));
        if (!result.fields.empty()) expect_density(result.mesh, good.file.starts_with("63") ? -1 : 1);
    }
}

TEST_F(BadFiles, FaultyFilesAreRefusedWithFileAndPlace) {
    for (const auto& bad : kBad) {
        const std::string message = error_of([&] { static_cast<void>(read_mesh(bad_folder() / bad.file)); });
        EXPECT_THAT(message, HasSubstr(bad.file));
        EXPECT_THAT(message, HasSubstr(bad.message));
    }
}

TEST_F(BadFiles, FieldsThatCannotBeReadLeaveTheCells) {
    for (const auto& bad : kBadFields) {
        const ReadResult result = read_mesh(bad_folder() / bad.file);
        EXPECT_EQ(result.mesh.cells.size(), 8U) << bad.file;
        EXPECT_THAT(result.warnings, testing::Contains(HasSubstr(bad.message))) << bad.file;
    }
}

TEST_F(BadFiles, CellsThatDoNotFitTogetherAreRefused) {
    for (const auto& bad : kBadTopology) {
        const ReadResult result = read_mesh(bad_folder() / bad.file);
        EXPECT_THAT(error_of([&] { static_cast<void>(inspect(result.mesh)); }), HasSubstr(bad.message)) << bad.file;
    }
}

TEST_F(BadFiles, EveryFileIsListedHere) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(bad_folder())) {
        files += entry.path().extension() != ".md";
    }
    EXPECT_EQ(files, kGood.size() + kBad.size() + kBadFields.size() + kBadTopology.size());
}

}  // namespace bad_files_test

}  // namespace subvol::test
