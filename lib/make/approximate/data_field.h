// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fitter.h"
#include "subvol/limit.h"

namespace subvol::detail {

/// The fields of data between its points, where the data is a mesh: the limit of the mesh by the scheme, if this one meets the
/// values at points; else by MCQ.
class DataField {
public:
    /// data:    its attributes are not used. Without cells there is nothing between the points
    /// options: as they were given: the creases that they ask for are those of the data, too
    /// throws:  Error(InvalidInput) as `validate`
    DataField(const HexMesh& data, const ApproximateOptions& options);

    /// The data without its fields.
    [[nodiscard]] const HexMesh& mesh() const { return mesh_; }
    [[nodiscard]] bool has_cells() const { return !mesh_.cells.empty(); }

    /// The places in the cells of the data; kNone beyond the reach.
    [[nodiscard]] std::vector<LimitQuery> find(std::span<const Vec3> positions, Progress* progress) const;

    /// About `count` places, as many in each cell, or in each of a part of the cells.
    [[nodiscard]] std::vector<LimitQuery> spread(std::size_t count) const;
    [[nodiscard]] std::vector<Vec3> positions(std::span<const LimitQuery> places) const;

    /// The values of each field at places, as those of an attribute.
    ///
    /// fields: with values at the points of the data
    [[nodiscard]] std::vector<std::vector<double>> values(std::span<const Attribute> fields,
                                                          std::span<const LimitQuery> places) const;

private:
    HexMesh mesh_;
    ApproximateOptions options_;
};

/// `evaluate_limit`, which takes the cells about the places alone where these are few.
[[nodiscard]] LimitSamples limit_at(const HexMesh& mesh, std::span<const LimitQuery> places, const LimitOptions& options);

/// About `count` places in cells, as many in each of them. Of very many cells they are in a part, so that `limit_at` needs few.
[[nodiscard]] std::vector<LimitQuery> spread_places(std::size_t cells, std::size_t count);

}  // namespace subvol::detail
