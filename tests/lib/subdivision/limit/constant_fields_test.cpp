// SPDX-License-Identifier: Apache-2.0
// Fields that are constant in cells: whatever evaluates, refines, cuts or writes a mesh has the numbers of the cells.

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <random>

#include "lib/test_meshes.h"
#include "subvol/boundary_values.h"
#include "subvol/dense_cells.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit.h"
#include "subvol/limit_level.h"
#include "subvol/measure.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_kernels.h"
#include "subvol/quantity.h"
#include "subvol/refine.h"
#include "subvol/region.h"
#include "subvol/wavelet_file.h"

namespace subvol::test {

namespace constant_fields_test {

constexpr double kNowhere = 1e6;  // the values at points, which must not be seen

// A box of unit cells, which the limit of MCQ fills cell by cell, with numbers of its own in each.
HexMesh numbered_box(Index nx, Index ny, Index nz) {
    HexMesh mesh = make_box(nx, ny, nz);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> number(-2, 3);
    for (const int channels : {1, 3}) {
        Attribute& field =
            mesh.attributes.emplace_back(Attribute{.name = channels == 1 ? "m" : "v", .channels = channels, .values = {}});
        field.values.assign(mesh.points.size() * static_cast<std::size_t>(channels), kNowhere);
        for (std::size_t i = 0; i < mesh.cells.size() * static_cast<std::size_t>(channels); ++i)
            field.cells.push_back(number(random));
        field.constant = true;
    }
    return mesh;
}

// The cell of a box at a place.
std::size_t cell_at(const Vec3& x, Index nx, Index ny) {
    return static_cast<std::size_t>(x.x) + nx * (static_cast<std::size_t>(x.y) + ny * static_cast<std::size_t>(x.z));
}

TEST(ConstantFields, PlacesHaveTheNumbersOfTheirCell) {
    HexMesh mesh = numbered_box(4, 3, 2);
    jitter(mesh, .2, 3);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Linear}) {
        std::vector<LimitQuery> queries;
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            for (const Vec3& at : {Vec3(.5), Vec3(0, .3, 1), Vec3(1, 1, 1)}) queries.push_back({c, at});
        }
        const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {scheme}});
        for (std::size_t q = 0; q < queries.size(); ++q) {
            const Index cell = queries[q].cell;
            EXPECT_EQ(samples.attributes[0].values[q], mesh.attributes[0].cells[cell]);
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_EQ(samples.attributes[1].values[3 * q + k], mesh.attributes[1].cells[3 * cell + k]);
                EXPECT_EQ(samples.attributes[1].derivatives[3 * q + k], Vec3(0.0));
            }
        }
    }
}

TEST(ConstantFields, GridsAndPiecesHaveThem) {
    const HexMesh mesh = numbered_box(4, 3, 2);
    for (const DenseBits bits : {DenseBits::OfRefine, DenseBits::ToRounding}) {
        const DenseCells dense(mesh, {.levels = 2}, true, bits);
        std::vector<Index> cells(mesh.cells.size());
        std::iota(cells.begin(), cells.end(), Index{0});
        dense.for_each(cells, [&](const DenseCell& grid) {
            for (std::size_t n = 0; n < grid.points.size(); ++n) {
                EXPECT_EQ(grid.values[0][n], mesh.attributes[0].cells[grid.cell]);
                EXPECT_EQ(grid.values[1][3 * n + 2], mesh.attributes[1].cells[3 * grid.cell + 2]);
            }
        });
    }
    const LimitCells limit = find_limit_cells(mesh, {}, {});
    ASSERT_TRUE(limit.pieces);
    for (std::size_t p = 0; p < limit.pieces->cells.size(); ++p) {
        const auto number = static_cast<float>(mesh.attributes[0].cells[limit.pieces->cells[p]]);
        for (std::size_t n = 0; n < LimitPieces::kNodes; ++n) EXPECT_EQ(limit.pieces->value(p, n, 0), number);
    }
}

TEST(ConstantFields, IntegralsAndExtremesAreThoseOfTheCells) {
    const HexMesh mesh = numbered_box(5, 4, 3);
    const std::vector<double>& cells = mesh.attributes[0].cells;
    const auto [least, most] = std::ranges::minmax_element(cells);
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const FieldMeasure field = measure_limit(mesh).whole.fields[0];
        EXPECT_NEAR(field.integral, std::accumulate(cells.begin(), cells.end(), 0.), 1e-12);  // cells of volume 1
        EXPECT_EQ(field.min.value, *least);
        EXPECT_EQ(field.max.value, *most);
        EXPECT_EQ(field.max.cell, static_cast<Index>(most - cells.begin()));
        EXPECT_EQ(field.extreme_error, 0);
    }
}

TEST(ConstantFields, ChildrenInheritThem) {
    const HexMesh mesh = numbered_box(3, 2, 2);
    const HexMesh fine = refine(mesh, {.levels = 2});
    const Attribute& field = fine.attributes[0];
    ASSERT_TRUE(field.constant);
    ASSERT_EQ(field.cells.size(), fine.cells.size());
    std::vector<double> sums(fine.points.size(), 0), counts(sums);
    for (std::size_t c = 0; c < fine.cells.size(); ++c) {
        Vec3 centre(0.0);
        for (const Index p : fine.cells[c]) centre += fine.points[p] / 8.0;
        EXPECT_EQ(field.cells[c], mesh.attributes[0].cells[cell_at(centre, 3, 2)]);
        EXPECT_EQ(fine.attributes[1].cells[3 * c + 1], mesh.attributes[1].cells[3 * cell_at(centre, 3, 2) + 1]);
        for (const Index p : fine.cells[c]) {
            sums[p] += field.cells[c];
            counts[p] += 1;
        }
    }
    for (std::size_t p = 0; p < sums.size(); ++p) EXPECT_NEAR(field.values[p], sums[p] / counts[p], 1e-14);
    const std::vector<Index> some{7, 2};
    const HexMesh part = refine_cells(mesh, some, {.levels = 1});
    for (std::size_t c = 0; c < 16; ++c) EXPECT_EQ(part.attributes[0].cells[c], mesh.attributes[0].cells[some[c / 8]]);
}

TEST(ConstantFields, PartsKeepThem) {
    const HexMesh mesh = numbered_box(4, 2, 1);
    std::vector<std::uint8_t> wanted(mesh.cells.size(), 0);
    wanted[1] = wanted[6] = 1;
    const HexMesh part = only_cells(mesh, wanted);
    EXPECT_THAT(part.attributes[0].cells, testing::ElementsAre(mesh.attributes[0].cells[1], mesh.attributes[0].cells[6]));
    EXPECT_TRUE(part.attributes[0].constant);
    HexMesh with_more = mesh;
    with_more.points.insert(with_more.points.begin(), Vec3(9.0));
    for (auto& cell : with_more.cells) {
        for (Index& p : cell) ++p;
    }
    with_more.attributes[0].values.push_back(0);
    with_more.attributes.pop_back();
    EXPECT_EQ(without_unused_points(with_more).attributes[0].cells, mesh.attributes[0].cells);
}

// What is computed of them alone is computed in each cell; the mean of lengths is no length of means.
TEST(ConstantFields, QuantitiesAreThoseOfTheCells) {
    HexMesh mesh = numbered_box(3, 2, 2);
    const Attribute length = field_of(mesh, "l", "2 * length(v) + m^2");
    ASSERT_TRUE(length.constant);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const double* v = &mesh.attributes[1].cells[3 * c];
        const double expected =
            2 * std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + std::pow(mesh.attributes[0].cells[c], 2);
        EXPECT_NEAR(length.cells[c], expected, 1e-12);
    }
    EXPECT_EQ(field_of(mesh, "v.y", "v.y").cells[3], mesh.attributes[1].cells[10]);
    EXPECT_TRUE(field_of(mesh, "j", "vector(m, m, v.z)").constant);
    EXPECT_FALSE(field_of(mesh, "x", "m + x").constant);
    EXPECT_FALSE(field_of(mesh, "g", "grad(m)").constant);
    mesh.attributes[0].cells[2] = 0;
    EXPECT_THROW(static_cast<void>(field_of(mesh, "q", "1 / m")), Error);
}

// Kernels inside of cells have the cell's number; at points of the mesh they would all have means.
TEST(ConstantFields, KernelsHaveThem) {
    HexMesh mesh = numbered_box(4, 3, 2);
    mesh.attributes.pop_back();
    const RbfVolume volume = make_mesh_kernels(mesh, {}).value;
    std::size_t inside = 0;
    for (std::size_t k = 0; k < volume.size(); ++k) {
        const Vec3 part = volume.centers[k] - glm::floor(volume.centers[k]);
        if (part != Vec3(.5)) continue;
        ++inside;
        EXPECT_FLOAT_EQ(volume.channels[0].values[k],
                        static_cast<float>(mesh.attributes[0].cells[cell_at(volume.centers[k], 4, 3)]));
    }
    EXPECT_EQ(inside, mesh.cells.size());
}

// On the boundary of a refined mesh only the points between cells have means.
TEST(ConstantFields, TheBoundaryHasThem) {
    HexMesh mesh = numbered_box(4, 3, 2);
    mesh.attributes.pop_back();
    const BoundaryValues boundary = boundary_values(mesh, {.levels = 2});
    std::size_t inside = 0;
    for (std::size_t p = 0; p < boundary.surface.points.size(); ++p) {
        const Vec3& x = boundary.surface.points[p];
        const std::array<double, 3> ends{4, 3, 2};
        Vec3 in_cell = x;
        bool between = false;
        for (int a = 0; a < 3; ++a) {
            const double end = ends[static_cast<std::size_t>(a)];
            if (x[a] == 0 || x[a] == end) {
                in_cell[a] = std::min(x[a], end - .5);
            } else {
                between = between || x[a] == std::floor(x[a]);
            }
        }
        if (between) continue;
        ++inside;
        EXPECT_NEAR(boundary.values[0][p], mesh.attributes[0].cells[cell_at(in_cell, 4, 3)], 1e-12);
    }
    EXPECT_GT(inside, boundary.surface.points.size() / 3);
}

TEST(ConstantFields, FilesHaveThemAtTheirCells) {
    const auto folder = std::filesystem::temp_directory_path() / "subvol_constant_fields_test";
    std::filesystem::create_directories(folder);
    HexMesh mesh = numbered_box(3, 2, 2);
    Attribute& labels = mesh.attributes.emplace_back(Attribute{.name = "layer", .channels = 1, .values = {}});
    labels.values.assign(mesh.points.size(), 0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) labels.cells.push_back(static_cast<double>(c / 3));
    labels.constant = true;
    mesh.attributes[0].constant = false;  // values at points made of those at cells
    mesh.attributes.push_back({"p", 1, std::vector<double>(mesh.points.size(), .5)});
    for (const char* name : {"a.vtu", "a.vtkhdf"}) {
        const auto file = folder / name;
        try {
            write_mesh(file, mesh);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::MissingCapability) continue;  // without HDF5
            throw;
        }
        const ReadResult read = read_mesh(file);
        for (std::size_t f = 0; f < mesh.attributes.size(); ++f) {
            const Attribute& wanted = mesh.attributes[f];
            const Attribute* found = read.mesh.find_attribute(wanted.name);
            ASSERT_TRUE(found) << wanted.name;
            EXPECT_EQ(found->cells, wanted.cells) << name << " " << wanted.name;
            // Integers are constant by themselves.
            EXPECT_EQ(found->constant, wanted.name == "layer") << name << " " << wanted.name;
        }
        EXPECT_EQ(read.mesh.find_attribute("p")->values, mesh.attributes.back().values);
        const ReadResult constant = read_mesh(file, {.cell_values = CellValues::Constant});
        EXPECT_TRUE(constant.mesh.find_attribute("v")->constant);
        EXPECT_EQ(range_of(*constant.mesh.find_attribute("m")).max[0], std::ranges::max(mesh.attributes[0].cells));
        const ReadResult mean = read_mesh(file, {.cell_values = CellValues::Mean});
        EXPECT_FALSE(mean.mesh.find_attribute("layer")->constant);
        std::filesystem::remove(file);
    }
}

TEST(ConstantFields, WaveletsHaveThemWithinTheTolerance) {
    const auto file = std::filesystem::temp_directory_path() / "subvol_constant_fields_test.svw";
    HexMesh mesh = numbered_box(4, 4, 2);  // has a coarser one
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) mesh.attributes[0].cells[c] = static_cast<double>(c % 5);
    mesh.attributes[1].constant = false;
    write_wavelet_file(file, mesh, {.tolerance = 1e-3});
    const HexMesh read = read_mesh(file).mesh;
    std::filesystem::remove(file);
    ASSERT_EQ(read.cells.size(), mesh.cells.size());
    EXPECT_TRUE(read.attributes[0].constant);
    EXPECT_FALSE(read.attributes[1].constant);
    for (std::size_t c = 0; c < read.cells.size(); ++c) {
        Vec3 centre(0.0);
        for (const Index p : read.cells[c]) centre += read.points[p] / 8.0;
        const std::size_t cell = cell_at(centre, 4, 4);
        EXPECT_EQ(read.attributes[0].cells[c], mesh.attributes[0].cells[cell]);
        for (std::size_t k = 0; k < 3; ++k)  // half of a thousandth of the range, which is below 5
            EXPECT_NEAR(read.attributes[1].cells[3 * c + k], mesh.attributes[1].cells[3 * cell + k], 2.6e-3);
    }
}

}  // namespace constant_fields_test

}  // namespace subvol::test
