// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "subvol/names.h"
#include "subvol/vec.h"
#include "subvol/voxels.h"

namespace subvol {

struct GridReport {
    std::string name;
    std::string kind;        ///< float, vector, integer, mask, or the name of another type
    bool level_set = false;  ///< whether the values are distances from a surface, below 0 inside; the file says so
    std::size_t active_voxels = 0;
    double voxel_size_world = 0;
    std::size_t bytes = 0;    ///< size of the tree in memory
    double min = 0, max = 0;  ///< over the active values; for a vector, over its length
    /// The value that stands for places where there is none: 0; for a level set the background, which is the largest distance
    /// that it has.
    double outside = 0;
    Box bounds{};  ///< the box of the active voxels' centres, world; empty if there are none
    /// What named views show: the box of the mesh or the points that the grid was made of, which its file has; for other grids,
    /// the box of the active voxels. Empty if there are no active voxels.
    Box frame{};
};

namespace detail {
class VdbData;

/// What a VdbGrid holds; `VdbData` has OpenVDB's grid. The calls are virtual, so that a program that loads this component only
/// when it needs it links none of it.
class GridData {
public:
    virtual ~GridData() = default;
    [[nodiscard]] virtual const GridReport& report() const = 0;
    [[nodiscard]] virtual std::optional<double> value(const Vec3& x) const = 0;
    [[nodiscard]] virtual std::unique_ptr<Voxels> voxels() const = 0;
};
}  // namespace detail

/// An OpenVDB grid; a grid of floats is a field that can be sampled. Grids made by this library have voxel centres at
/// world = h·ijk, unless they copy the transform of another grid.
class VdbGrid {
public:
    explicit VdbGrid(std::unique_ptr<detail::GridData> data) : data_(std::move(data)) {}

    [[nodiscard]] const GridReport& report() const { return data_->report(); }

    /// Trilinear between the eight voxels about x; nothing where the voxel that contains x is inactive. Inactive neighbours are
    /// ignored: the weights of the active ones are normalised. Nothing if the voxels are not floats. Inactive voxels of a level
    /// set have values, the background with the sign of their side; there is nothing only where they lie outside.
    [[nodiscard]] std::optional<double> value(const Vec3& x) const { return data_->value(x); }

    /// The voxels, for a renderer; they share the grid's memory and may outlive it.
    ///
    /// throws: Error(InvalidInput) if the transform is not linear, or the voxels are not floats
    [[nodiscard]] std::unique_ptr<Voxels> voxels() const { return data_->voxels(); }

private:
    friend class detail::VdbData;

    std::unique_ptr<detail::GridData> data_;
};

/// The differences of two grids of floats at the voxels that are active in both; NaN if there is none.
struct GridDifference {
    std::size_t voxels = 0;
    double rms = 0, max = 0;
};
/// throws: Error(InvalidInput) if the voxels are not floats, or the transforms differ: an index is another place then
[[nodiscard]] GridDifference compare_voxels(const VdbGrid& a, const VdbGrid& b);

/// All voxels of a box as one array.
///
/// The centre of voxel (i, j, k) is at world = to_world · (i, j, k) + origin; its values begin at
/// components · (k + size[2] · (j + size[1] · i)).
struct GridArray {
    std::array<std::size_t, 3> size{};  ///< voxels along the three axes
    std::size_t components = 1;         ///< of a voxel: 1, or 3 of a vector
    Mat3 to_world{1};                   ///< the edges of a voxel in its columns
    Vec3 origin{};                      ///< the centre of the first voxel, world
    std::vector<float> values{};        ///< NaN in voxels that are not active; a level set has values everywhere
};

/// Returns the box of the active voxels without its values; sizes of 0 if no voxel is active.
///
/// throws: Error(InvalidInput) if the voxels are neither floats nor vectors, the transform is not linear, or the box has more
///         than 2^31 voxels
[[nodiscard]] GridArray grid_box(const VdbGrid& grid);

/// Copies the voxels in the box of the active ones.
///
/// throws: as `grid_box`
/// cost:   O(voxels of the box)
[[nodiscard]] GridArray grid_array(const VdbGrid& grid);

struct GridArrayOptions {
    std::string name = "density";
    bool level_set = false;  ///< the values are distances from a surface, below 0 inside
    /// For a level set, the largest distance that it has, world: voxels that are as far or farther are not active. none: the
    /// largest of the array
    std::optional<double> background{};
};

/// Makes a grid of an array. Voxels whose value is NaN are not active.
///
/// If the voxels are cubes along the axes and `origin` is a multiple of their size, their centres are at world = h·ijk as in
/// all grids of that voxel size which this library makes; else the grid's transform has the origin.
///
/// throws: Error(InvalidInput) if there is no voxel, the sizes differ from the number of values, a value is infinite, or voxels
///         are flat or too small for OpenVDB; for a level set also if voxels are no cubes, values are vectors, or one is NaN
[[nodiscard]] VdbGrid make_grid(const GridArray& array, const GridArrayOptions& options = {});

enum class VdbCompression { None, Zip, Blosc };

template <>
struct NameTable<VdbCompression> {
    static constexpr Name<VdbCompression> rows[] = {
        {VdbCompression::Blosc, "blosc"}, {VdbCompression::Zip, "zip"}, {VdbCompression::None, "none"}};
};

/// Writes grids into one `.vdb` file, which appears whole under its name or not at all.
///
/// throws: Error(Io); Error(MissingCapability) if OpenVDB was built without that compression
void write_vdb(const std::filesystem::path& path, std::span<const VdbGrid> grids,
               VdbCompression compression = VdbCompression::Blosc);

/// Reads the float grids of a `.vdb` file.
///
/// throws: Error(Io), Error(InvalidInput) if it is not a VDB file or has no grid of floats
[[nodiscard]] std::vector<VdbGrid> read_vdb(const std::filesystem::path& path);

}  // namespace subvol
