// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/vtkhdf_writer.h"

#include <algorithm>
#include <array>

namespace subvol::detail {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

VtkHdfWriter::VtkHdfWriter(const std::filesystem::path& target) : out_(target) {
    out_.group("/VTKHDF");
    out_.attribute("/VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
    out_.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
    for (const char* group : {"/VTKHDF/PointData", "/VTKHDF/CellData", "/VTKHDF/FieldData"}) out_.group(group);
}

void VtkHdfWriter::grid(std::span<const Vec3> points, std::span<const std::int64_t> connectivity, std::uint8_t type,
                        std::size_t per_cell) {
    const std::size_t cells = connectivity.size() / per_cell;
    const auto number = [&](const char* name, std::size_t count) {
        const std::array<std::int64_t, 1> one{static_cast<std::int64_t>(count)};
        out_.put("/VTKHDF/" + std::string(name), std::span<const std::int64_t>(one));
    };
    number("NumberOfPoints", points.size());
    number("NumberOfCells", cells);
    number("NumberOfConnectivityIds", connectivity.size());
    out_.put("/VTKHDF/Points", std::span(reinterpret_cast<const double*>(points.data()), 3 * points.size()), 3);
    out_.put("/VTKHDF/Connectivity", connectivity);
    std::vector<std::int64_t> offsets(cells + 1);
    for (std::size_t c = 0; c <= cells; ++c) offsets[c] = static_cast<std::int64_t>(c * per_cell);
    out_.put("/VTKHDF/Offsets", std::span<const std::int64_t>(offsets));
    const std::vector<std::uint8_t> types(cells, type);
    out_.put("/VTKHDF/Types", std::span<const std::uint8_t>(types));
}

std::string VtkHdfWriter::unique_name(std::string name, std::set<std::string>& taken) {
    std::ranges::replace(name, '/', '_');
    if (name.empty() || name == ".") name = "field";
    while (!taken.insert(name).second) name += '_';
    return name;
}

}  // namespace subvol::detail
