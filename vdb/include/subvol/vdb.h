#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/voxels.h"

namespace subvol {

/// voxel_size_world: > 0, or 0 to take `resolution`; resolution: voxels along the longest side of the bounding box
/// half:             values stored as 16-bit floats
struct RasterizeOptions {
    double voxel_size_world = 0;
    int resolution = 200;
    bool half = false;
    std::string creator = "OpenSubVol";
    Progress* progress = nullptr;
};

struct GridReport {
    std::string name;
    std::size_t active_voxels = 0;
    double voxel_size_world = 0;
    std::size_t bytes = 0;  // of the tree in memory
    double min = 0, max = 0;
    Box bounds{};  // of the active voxels' centres, world; empty if there are none
};

/// An OpenVDB float grid, and a field that can be sampled. Voxel centres lie at world = h·ijk.
class VdbGrid {
public:
    struct Data;
    explicit VdbGrid(std::unique_ptr<Data> data);
    ~VdbGrid();
    VdbGrid(VdbGrid&&) noexcept;
    VdbGrid& operator=(VdbGrid&&) noexcept;

    [[nodiscard]] const GridReport& report() const;

    /// Trilinear between the eight voxels about x; nothing where the voxel that holds x is inactive. Inactive neighbours do not
    /// count: the weights of the active ones are normalised.
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;

    /// The voxels, for a renderer; shares the grid's memory, may outlive it.
    ///
    /// throws: Error(InvalidInput) if the transform is not linear
    [[nodiscard]] std::unique_ptr<Voxels> voxels() const;

    [[nodiscard]] const Data& data() const { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

/// Rasterizes one-channel attributes of a hexahedral mesh: cubic voxels, values at voxel centres, active where the centre lies
/// inside the mesh. The first field becomes a fog volume (named as the attribute), the others plain float grids.
///
/// A centre on the boundary counts as if it lay 1e-6 voxels further up all axes: a box that fits the voxels fills its volume
/// exactly, and boxes that touch share none. Where cells overlap, the cell with the smallest id counts; leaf-parallel, the same
/// for any number of threads.
/// throws: Error(InvalidInput) if the mesh is not valid, a field is missing, has several channels or does not fit its float, or
///         the voxel size is not positive or below OpenVDB's least of 1.45e-5, makes more than 2·10⁹ voxels or voxel numbers
///         beyond 2³⁰; Error(Cancelled)
[[nodiscard]] std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields,
                                             const RasterizeOptions& options = {});

/// Writes grids into one `.vdb` file (blosc), beside and then renamed.
///
/// throws: Error(Io)
void write_vdb(const std::filesystem::path& path, std::span<const VdbGrid> grids);

/// Reads the float grids of a `.vdb` file.
///
/// throws: Error(Io), Error(InvalidInput) if it is no VDB file or holds no float grid
[[nodiscard]] std::vector<VdbGrid> read_vdb(const std::filesystem::path& path);

}  // namespace subvol
