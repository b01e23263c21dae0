// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/vec.h"
#include "subvol/voxels.h"

namespace subvol {

namespace detail {
struct VdbData;
}

/// kind:     float, vector, integer, mask, or another type's name
/// min, max: of a vector's length
struct GridReport {
    std::string name;
    std::string kind;
    std::size_t active_voxels = 0;
    double voxel_size_world = 0;
    std::size_t bytes = 0;  // of the tree in memory
    double min = 0, max = 0;
    Box bounds{};  // of the active voxels' centres, world; empty if there are none
};

/// An OpenVDB grid; of floats it is a field that can be sampled. Those that are made here have voxel centres at world = h·ijk.
class VdbGrid {
public:
    ~VdbGrid();
    VdbGrid(VdbGrid&&) noexcept;
    VdbGrid& operator=(VdbGrid&&) noexcept;

    [[nodiscard]] const GridReport& report() const;

    /// Trilinear between the eight voxels about x; nothing where the voxel that holds x is inactive. Inactive neighbours do not
    /// count: the weights of the active ones are normalised. Floats only; of vectors and whole numbers there is nothing.
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;

    /// The voxels, for a renderer; shares the grid's memory, may outlive it.
    ///
    /// throws: Error(InvalidInput) if the transform is not linear, or the voxels are no floats
    [[nodiscard]] std::unique_ptr<Voxels> voxels() const;

private:
    friend struct detail::VdbData;
    explicit VdbGrid(std::unique_ptr<detail::VdbData> data);

    std::unique_ptr<detail::VdbData> data_;
};

/// How far the values of two grids of floats are apart where both are active.
struct GridDifference {
    std::size_t voxels = 0;
    double rms = 0, max = 0;
};
[[nodiscard]] GridDifference compare_voxels(const VdbGrid& a, const VdbGrid& b);

enum class VdbCompression { None, Zip, Blosc };

/// Writes grids into one `.vdb` file, beside and then renamed.
///
/// throws: Error(Io); Error(MissingCapability) if OpenVDB was built without that compression
void write_vdb(const std::filesystem::path& path, std::span<const VdbGrid> grids,
               VdbCompression compression = VdbCompression::Blosc);

/// Reads the float grids of a `.vdb` file.
///
/// throws: Error(Io), Error(InvalidInput) if it is no VDB file or holds no float grid
[[nodiscard]] std::vector<VdbGrid> read_vdb(const std::filesystem::path& path);

}  // namespace subvol
