// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "subvol/sample.h"

namespace subvol {

/// `sample_rbf_points` for a mesh that moves, or whose values change: what depends on its cells alone is computed once. It
/// makes one kernel for each control point, by a scheme that keeps these points.
class SampleTables {
public:
    /// Whether there are tables for these options.
    [[nodiscard]] static bool are_for(const SampleOptions& options);

    /// throws: Error(InvalidInput) as `sample_rbf_points`, or if there are no tables for the options
    SampleTables(const HexMesh& mesh, const SampleOptions& options);
    ~SampleTables();
    SampleTables(SampleTables&&) noexcept;
    SampleTables& operator=(SampleTables&&) noexcept;

    /// What `sample_rbf_points` returns for a mesh with the same cells, creases and number of attributes; its boundary up to
    /// rounding. No crease by angle is found anew.
    ///
    /// throws: Error(InvalidInput) if its number of points is another one
    [[nodiscard]] SampleResult apply(const HexMesh& mesh) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
