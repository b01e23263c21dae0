// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A channel of a field.
struct MeanChannel {
    std::size_t field, number;
};

[[nodiscard]] std::vector<MeanChannel> mean_channels(std::span<const Attribute> fields);

[[nodiscard]] std::vector<double> channel_values(std::span<const Attribute> fields, const MeanChannel& channel);

/// The power of two by which values are divided while they are fitted: sums of squares of very large and very small ones would
/// leave the range of doubles. Nothing else changes, as a power of two changes no digits. 0: they stay as they are
[[nodiscard]] int mean_exponent(const std::vector<double>& values);
void divide_values(std::vector<double>& values, int exponent);
[[nodiscard]] double multiplied_value(double value, int exponent);

/// The fields with the same names and channels, a value 0 at each point.
[[nodiscard]] std::vector<Attribute> empty_fields(const HexMesh& mesh, std::span<const Attribute> means);

/// throws: Error(InvalidInput) if a size is wrong or a mean is not finite
void check_means(const HexMesh& mesh, std::span<const Attribute> means, std::span<const Index> parts);

}  // namespace subvol::detail
