// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "dense_grid.h"
#include "subvol/camera.h"

namespace subvol::detail {

/// The boxes of dense grids in Embree, as user geometry.
class DenseScene {
public:
    /// grids:  referred to, not copied
    ///
    /// throws: Error(MissingCapability) if Embree cannot be started or has not enough memory
    explicit DenseScene(const std::vector<DenseGrid>& grids);
    ~DenseScene();
    DenseScene(DenseScene&&) = delete;

    /// Appends the numbers of the grids whose boxes the whole line of a ray may meet, in no particular order.
    void find_met(const Ray& ray, std::vector<std::uint32_t>& grids) const;
    [[nodiscard]] const std::vector<DenseGrid>& grids() const { return grids_; }

private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    const std::vector<DenseGrid>& grids_;
    Vec3 center_{0.0};
    double scale_ = 1;  // to a ball of radius 1
};

}  // namespace subvol::detail
