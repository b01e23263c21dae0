// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>

#include "subvol/hex_mesh.h"
#include "tensor_functions.h"

namespace subvol::detail {

/// From the channels of a field at a place to others.
using ChannelFunction = std::function<void(std::span<const double> channels, std::span<double> values)>;

/// Linear: the limit of its values at the points is the function of the limit
enum class Rule { Linear, Nonlinear };

/// A function of a field as a field. Its values at the points are computed at once; if it is not linear, or the field is a
/// function itself, it is one at all places (`Attribute::function`).
[[nodiscard]] Attribute applied(const Attribute& field, std::string name, int channels, Rule rule,
                                const ChannelFunction& function);
/// Of a vector or tensor. The result has the name of the field, and as bounds that it is not negative where it cannot be.
[[nodiscard]] Attribute applied(const Attribute& field, const TensorFunction& function);

/// One channel.
[[nodiscard]] Attribute channel_of(const Attribute& field, std::size_t channel, std::string name);

/// Scalars as the channels of one field.
[[nodiscard]] Attribute joined(std::span<const Attribute* const> scalars, std::string name);

}  // namespace subvol::detail
