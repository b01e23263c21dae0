// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// A binary `.ply` of points that come in any order: the bytes are those that `write_points` writes for all together.
class PlyRows {
public:
    /// like:   points of the same kernel and channels
    /// points: how many there will be
    /// note:   not empty: the file is a part with this note, for `read_points_note`. Its points have the order in which they
    ///         come, and each has its number in a property `number`
    PlyRows(const std::filesystem::path& path, const RbfVolume& like, std::uint64_t points, const Surface& boundary,
            const std::string& note = {});
    ~PlyRows();
    PlyRows(const PlyRows&) = delete;
    PlyRows& operator=(const PlyRows&) = delete;

    /// numbers: the places of the points in the whole, ascending
    void write(std::span<const std::uint64_t> numbers, const RbfVolume& points);

    /// Writes the boundary; then the file has its name.
    ///
    /// throws: Error(Io); Error(InvalidInput) if a point has not been written
    void finish(const Surface& boundary);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A part that `PlyRows` has written.
struct NumberedPoints {
    RbfVolume volume;
    std::vector<std::uint64_t> numbers;
};

/// throws: as `read_points`; Error(InvalidInput) if a point has no number, or one from 2⁵³ on
[[nodiscard]] NumberedPoints read_numbered_points(const std::filesystem::path& path);

}  // namespace subvol::detail
