#include "subvol/mixed_cells.h"

#include "mixed_cells_split.h"
#include "subvol/error.h"

namespace subvol {

std::vector<Vec3> means(const IndexRows& sources, std::span<const Vec3> points) {
    std::vector<Vec3> result(sources.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        Vec3 sum(0);
        for (const Index p : sources[i]) sum += points[p];
        result[i] = sum / static_cast<double>(sources[i].size());
    }
    return result;
}

std::vector<double> means(const IndexRows& sources, std::span<const double> values, std::size_t channels) {
    std::vector<double> result(sources.size() * channels);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (std::size_t k = 0; k < channels; ++k) {
            double sum = 0;
            for (const Index p : sources[i]) sum += values[p * channels + k];
            result[i * channels + k] = sum / static_cast<double>(sources[i].size());
        }
    }
    return result;
}

HexMesh split_into_hexes(const HexMesh& hexes, const MixedCells& others) {
    if (!hexes.creases.empty() || !hexes.sharp_faces.empty()) {
        throw Error(ErrorCode::InvalidInput, "creases and sharp faces cannot be split with the cells");
    }
    for (const Attribute& attribute : hexes.attributes) {
        if (attribute.values.size() == hexes.points.size() * static_cast<std::size_t>(attribute.channels)) continue;
        throw Error(ErrorCode::InvalidInput, "its length is not that of the points", "attribute \"" + attribute.name + "\"");
    }
    HexSplit split = plan_split(hexes.points, hexes.cells, others);
    HexMesh result;
    result.points = means(split.sources, hexes.points);
    result.cells = std::move(split.cells);
    for (const Attribute& attribute : hexes.attributes) {
        result.attributes.push_back({attribute.name, attribute.channels,
                                     means(split.sources, attribute.values, static_cast<std::size_t>(attribute.channels))});
    }
    return result;
}

}  // namespace subvol
