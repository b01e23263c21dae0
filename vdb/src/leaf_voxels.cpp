#include "leaf_voxels.h"

#include <algorithm>

#include "subvol/cell_locator.h"

namespace subvol {

namespace {

// Centres on the surface go to the side of a small step along all axes (half-open: a box of n³ voxels fills n³ of them, and
// two boxes that touch share none). The step is far above the rounding and in no plane that meshes like to have.
const Vec3 kStep = 1e-6 * Vec3(1.0, 0.83, 0.71);  // voxels

// The weights reach beyond [0,1] between a bent face and its two triangles; the field's values must not.
double interpolate(const std::array<Index, 8>& cell, const std::vector<double>& values, const std::array<double, 8>& weights) {
    double sum = 0, lowest = values[cell[0]], highest = lowest;
    for (std::size_t k = 0; k < 8; ++k) {
        const double value = values[cell[k]];
        sum += weights[k] * value;
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    return std::clamp(sum, lowest, highest);
}

class LeafFiller {
public:
    LeafFiller(const HexMesh& mesh, std::span<const Attribute* const> fields, double voxel_size, const VoxelCoord& origin)
        : mesh_(mesh), fields_(fields), voxel_size_(voxel_size), origin_(origin) {
        voxels_.values.resize(fields.size());
    }

    void fill(Index cell) {
        VoxelBox box = voxels_in(cell_box(mesh_, cell), voxel_size_);
        for (std::size_t d = 0; d < 3; ++d) {
            box.lower[d] = std::max(box.lower[d], origin_[d]);
            box.upper[d] = std::min(box.upper[d], origin_[d] + kLeafSide - 1);
        }
        const CellLocator locator(mesh_, cell);
        for (int x = box.lower[0]; x <= box.upper[0]; ++x) {
            for (int y = box.lower[1]; y <= box.upper[1]; ++y) {
                for (int z = box.lower[2]; z <= box.upper[2]; ++z) fill(cell, locator, {x, y, z});
            }
        }
    }

    [[nodiscard]] LeafVoxels result() && { return std::move(voxels_); }

private:
    void fill(Index cell, const CellLocator& locator, const VoxelCoord& voxel) {
        const auto local = [&](std::size_t d) { return static_cast<std::size_t>(voxel[d] - origin_[d]); };
        const std::size_t in_word = 8 * local(1) + local(2);
        auto& word = voxels_.active[local(0)];
        if (word >> in_word & 1u) return;

        const Vec3 index(voxel[0], voxel[1], voxel[2]);
        const auto tetrahedron = locator.find_tetrahedron(voxel_size_ * (index + kStep));
        if (!tetrahedron) return;
        word |= std::uint64_t{1} << in_word;
        const auto weights = locator.weights(*tetrahedron, voxel_size_ * index);
        for (std::size_t f = 0; f < fields_.size(); ++f) {
            voxels_.values[f][64 * local(0) + in_word] =
                static_cast<float>(interpolate(mesh_.cells[cell], fields_[f]->values, weights));
        }
    }

    const HexMesh& mesh_;
    std::span<const Attribute* const> fields_;
    double voxel_size_;
    VoxelCoord origin_;
    LeafVoxels voxels_;
};

}  // namespace

bool LeafVoxels::empty() const {
    return std::all_of(active.begin(), active.end(), [](std::uint64_t word) { return word == 0; });
}

LeafVoxels fill_leaf(const HexMesh& mesh, std::span<const Attribute* const> fields, const LeafBins& bins, std::size_t leaf) {
    LeafFiller filler(mesh, fields, bins.voxel_size, bins.origin_of(leaf));
    for (const LeafCell& entry : bins.cells_of(leaf)) filler.fill(entry.cell);
    return std::move(filler).result();
}

}  // namespace subvol
