// SPDX-License-Identifier: Apache-2.0
// Exodus II in netCDF-4, which is HDF5: as netCDF's library writes it, and files made like that by HDF5's library.

#include <gmock/gmock.h>
#include <zlib.h>

#include <array>

#include "exodus_expected.h"
#include "io/mesh_io/hdf5_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace exodus_hdf5_test {

using testing::ElementsAre;
using testing::HasSubstr;

const HexMesh kBox = make_box(2, 2, 1);

class ExodusHdf5 : public TempFolder {
protected:
    // Variables as datasets, dimensions as such without values. The unlimited one keeps the length 0. nodes: as its dimension
    // says
    std::filesystem::path write_netcdf4(const std::string& name, const NetcdfText& text, bool deflated = false,
                                        std::size_t nodes = 18) const {
        Hdf5Writer file(path(name));
        for (const auto& dimension : text.dimensions) {
            const bool unlimited = dimension.length == NetcdfText::kUnlimited;
            file.put_empty(dimension.name, dimension.name == "num_nodes" ? nodes : dimension.length, unlimited);
            file.attribute(dimension.name, "CLASS", "DIMENSION_SCALE");
            file.attribute(dimension.name, "NAME", "This is a netCDF dimension but not a netCDF variable.         0");
        }
        for (const auto& variable : text.variables) {
            std::vector<hsize_t> lengths;
            for (const std::size_t d : variable.dimensions) lengths.push_back(text.dimensions[d].length);
            lengths[0] = text.rows(variable);
            std::vector<double> values = variable.values;
            values.resize(text.rows(variable) * text.row_length(variable));
            if (variable.kind == NetcdfText::Kind::Characters) {
                file.put(variable.name, std::vector<char>(values.begin(), values.end()), lengths);
            } else if (variable.kind == NetcdfText::Kind::Integers) {
                file.put(variable.name, std::vector<std::int32_t>(values.begin(), values.end()), lengths, deflated);
            } else {
                file.put(variable.name, values, lengths, deflated, text.is_record(variable));
            }
            for (const auto& [key, value] : variable.texts) file.attribute(variable.name, key, value);
        }
        return path(name);
    }
};

TEST_F(ExodusHdf5, WhatNetcdfItselfWritesIsRead) {
    // Written by nc_create with NC_NETCDF4 (netCDF-C 4.9.0): one cell, the steps 0 and 0.5, T at its nodes, c in it.
    gzFile packed = gzopen((std::filesystem::path(__FILE__).parent_path() / "netcdf4.exo.gz").c_str(), "rb");
    ASSERT_NE(packed, nullptr);
    std::string bytes;
    std::array<char, 1 << 16> piece{};
    for (int count = 0; (count = gzread(packed, piece.data(), piece.size())) > 0;) {
        bytes.append(piece.data(), static_cast<std::size_t>(count));
    }
    gzclose(packed);
    const auto file = write("a.exo", bytes);
    EXPECT_THAT(open_series(file).times, ElementsAre(0, 0.5));
    const ReadResult result = read_mesh(file);
    EXPECT_EQ(result.mesh.points.size(), 8u);
    EXPECT_EQ(result.mesh.points[3], Vec3(1, 1, 0));
    ASSERT_EQ(result.mesh.cells.size(), 1u);
    EXPECT_THAT(result.mesh.cells[0], ElementsAre(0, 1, 3, 2, 4, 5, 7, 6));
    EXPECT_EQ(result.mesh.find_attribute("T")->values, count_from(10, 8));
    EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 4);
    EXPECT_EQ(read_mesh(file, {.step = 0}).mesh.find_attribute("T")->values, count_from(0, 8));
    for (const std::size_t length : {9u, 1000u, 30000u}) {
        EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(write("cut.exo", bytes.substr(0, length)))); }),
                    HasSubstr("cut.exo: the HDF5 file is damaged or not complete"));
    }
}

TEST_F(ExodusHdf5, HoldsWhatTheClassicFormatHolds) {
    for (const bool deflated : {false, true}) {
        for (const bool old_names : {false, true}) {
            ExodusText text = two_blocks(kBox);
            text.old_names = old_names;
            const auto file = write_netcdf4("a.exo", exodus_variables(text), deflated);
            expect_two_blocks(read_mesh(file), kBox);
            EXPECT_EQ(open_series(file).times, text.times);
        }
    }
}

TEST_F(ExodusHdf5, VariablesOfADimensionsNameHaveAPrefix) {
    NetcdfText text = exodus_variables(two_blocks(kBox));
    text.dimension("coordx", 5);
    for (auto& variable : text.variables) {
        if (variable.name == "coordx") variable.name = "_nc4_non_coord_coordx";
    }
    expect_two_blocks(read_mesh(write_netcdf4("a.exo", text)), kBox);
}

TEST_F(ExodusHdf5, WrongFilesGetASentence) {
    const NetcdfText good = exodus_variables(two_blocks(kBox));
    const auto error = [&](const NetcdfText& text, std::size_t nodes = 18) {
        return error_of([&] { static_cast<void>(read_mesh(write_netcdf4("a.exo", text, false, nodes))); });
    };
    EXPECT_EQ(error(good), "no error");
    EXPECT_THAT(error(good, 17), HasSubstr("a.exo: coordx does not have the 17 values that are needed"));
    EXPECT_THAT(error(good, std::size_t{1} << 31), HasSubstr("count out of range"));
    EXPECT_THAT(error({}), HasSubstr("a.exo: not an Exodus II file, or it has no nodes"));
    NetcdfText reals = good;
    for (auto& variable : reals.variables) {
        if (variable.name == "connect2") variable.kind = NetcdfText::Kind::Reals;
    }
    EXPECT_THAT(error(reals), HasSubstr("a.exo: connect2 does not consist of integers"));
}

}  // namespace exodus_hdf5_test

}  // namespace subvol::test
