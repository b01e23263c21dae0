// SPDX-License-Identifier: Apache-2.0
#include "mean_channels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/error.h"

namespace subvol::detail {

std::vector<MeanChannel> mean_channels(std::span<const Attribute> fields) {
    std::vector<MeanChannel> channels;
    for (std::size_t f = 0; f < fields.size(); ++f) {
        for (std::size_t c = 0; c < static_cast<std::size_t>(fields[f].channels); ++c) channels.push_back({f, c});
    }
    return channels;
}

std::vector<double> channel_values(std::span<const Attribute> fields, const MeanChannel& channel) {
    const Attribute& field = fields[channel.field];
    const auto width = static_cast<std::size_t>(field.channels);
    std::vector<double> values(field.values.size() / width);
    for (std::size_t c = 0; c < values.size(); ++c) values[c] = field.values[c * width + channel.number];
    return values;
}

int mean_exponent(const std::vector<double>& values) {
    constexpr int kPlain = 300;
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    const int exponent = most > 0 ? std::ilogb(most) : 0;
    return std::abs(exponent) > kPlain ? exponent : 0;
}

void divide_values(std::vector<double>& values, int exponent) {
    if (exponent == 0) return;
    for (double& value : values) value = std::ldexp(value, -exponent);
}

double multiplied_value(double value, int exponent) {
    if (exponent == 0) return value;
    constexpr double kMost = std::numeric_limits<double>::max();
    return std::clamp(std::ldexp(value, exponent), -kMost, kMost);  // the gradient may lead beyond
}

std::vector<Attribute> empty_fields(const HexMesh& mesh, std::span<const Attribute> means) {
    std::vector<Attribute> fields;
    for (const Attribute& field : means) {
        fields.push_back(
            {field.name, field.channels, std::vector<double>(mesh.points.size() * static_cast<std::size_t>(field.channels))});
    }
    return fields;
}

void check_means(const HexMesh& mesh, std::span<const Attribute> means, std::span<const Index> parts) {
    const auto fail = [](const std::string& message) { throw Error(ErrorCode::InvalidInput, message); };
    if (!parts.empty() && parts.size() != mesh.cells.size()) fail("parts are not as many as cells");
    for (const Attribute& field : means) {
        if (field.channels < 1 || field.values.size() != mesh.cells.size() * static_cast<std::size_t>(field.channels)) {
            fail("field \"" + field.name + "\" does not have a mean for each cell");
        }
        if (!std::ranges::all_of(field.values, [](double value) { return std::isfinite(value); })) {
            fail("a mean of field \"" + field.name + "\" is not finite");
        }
    }
}

}  // namespace subvol::detail
