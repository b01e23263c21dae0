// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "series_format.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// What is tried.
inline constexpr std::array kSpatials{Spatial::ByNumber, Spatial::InCells, Spatial::BetweenSheets};

/// The predictions of a mesh, each made when it is needed.
class Predictions {
public:
    explicit Predictions(const HexMesh& mesh);

    void make(Spatial spatial);
    /// One that has been made; null for Spatial::None.
    [[nodiscard]] const ValuePrediction* find(Spatial spatial) const;

private:
    Topology topology_;
    std::array<std::optional<ValuePrediction>, 4> made_;
};

/// Residuals as planes of bytes, and the numbers that they give.
struct Residuals {
    std::size_t bytes_each = 0;
    std::string planes;
    std::vector<std::int64_t> numbers;
};

struct Mode {
    Spatial spatial = Spatial::None;
    Temporal temporal = Temporal::None;
};

struct CodedChannel {
    Mode mode;
    Residuals residuals;
    std::uint64_t bytes = 0;
};

/// A channel in parts of steps; 0 where a value is not finite or too large.
[[nodiscard]] std::vector<std::int64_t> targets_of(std::span<const double> values, std::size_t channel, std::size_t channels,
                                                   const Quantization& q);

/// Codes a channel by the mode that takes fewest bytes; all predictions have been made.
///
/// before: the numbers in the steps before, the latest first; null: not known
[[nodiscard]] CodedChannel coded(const std::vector<std::int64_t>& targets,
                                 const std::array<const std::vector<std::int64_t>*, 2>& before, const Predictions& predictions);

/// What is kept of a channel.
struct KeptValues {
    std::vector<std::size_t> exact_points;  ///< points whose values are kept as they are
    std::vector<double> exact_values;       ///< values of these points
    double max_error = 0;
};

/// most: the error within which a value need not be kept as it is
[[nodiscard]] KeptValues kept_values(std::span<const double> values, std::size_t channel, std::size_t channels,
                                     const Quantization& q, std::span<const std::int64_t> numbers, double most);

}  // namespace subvol::detail
