// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "subvol/approximate.h"

namespace subvol {

/// Fits the steps of a series onto one control mesh, as `approximate` fits each of them, to the bit. The limit's matrix and the
/// places of the samples in it are found once for all steps whose samples are at the same points, and once more whenever these
/// have moved or are others; the pieces of the limit in which places are looked for are kept in any case.
class Approximator {
public:
    /// onto:   the control mesh; its attributes are not used
    /// throws: Error(InvalidInput) as `approximate`, and with `refine`: all steps have the same control mesh
    explicit Approximator(HexMesh onto, const ApproximateOptions& options = {});
    ~Approximator();
    Approximator(Approximator&&) noexcept;
    Approximator& operator=(Approximator&&) noexcept;

    /// The fit of a step, whichever steps were fitted before.
    ///
    /// samples:  as of `approximate`; steps may have different fields
    /// progress: instead of that of the options
    /// throws:   Error(InvalidInput) as `approximate`
    /// cost:     of a step whose samples are where those of the step before were: the search alone
    [[nodiscard]] Approximation fit(const HexMesh& samples, Progress* progress = nullptr);

    /// How often the places of samples were found.
    [[nodiscard]] std::size_t placements() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The options that an approximator has: those of `approximate` without those that refine the control mesh.
[[nodiscard]] std::vector<Option> options_of_series(ApproximateOptions& options);

}  // namespace subvol
