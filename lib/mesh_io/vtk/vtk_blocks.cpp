// SPDX-License-Identifier: Apache-2.0
#include "vtk_blocks.h"

#include <algorithm>

namespace subvol::detail {

namespace {

void read_three(const std::string& keyword, TextScanner& in, std::array<double, 3>& numbers) {
    for (double& number : numbers) number = in.real({keyword});
}

}  // namespace

std::optional<VtkBlock> VtkBlock::of(const std::string& type) {
    VtkBlock block;
    if (type == "STRUCTURED_GRID") return block;
    block.kind_ = type == "RECTILINEAR_GRID" ? Kind::Cuts : Kind::Even;
    if (type == "RECTILINEAR_GRID" || type == "STRUCTURED_POINTS") return block;
    return std::nullopt;
}

bool VtkBlock::read_section(const std::string& keyword, TextScanner& in, VtkValues& values) {
    if (keyword == "DIMENSIONS") {
        for (std::size_t& along : grid_.points) along = in.count({"DIMENSIONS"});
    } else if (kind_ == Kind::Cuts && keyword.size() == 13 && keyword.ends_with("_COORDINATES") && keyword[0] >= 'X' &&
               keyword[0] <= 'Z') {
        read_cuts(static_cast<std::size_t>(keyword[0] - 'X'), keyword, in, values);
    } else if (kind_ == Kind::Even && keyword == "ORIGIN") {
        read_three(keyword, in, origin_);
    } else if (kind_ == Kind::Even && (keyword == "SPACING" || keyword == "ASPECT_RATIO")) {
        read_three(keyword, in, spacing_);
    } else {
        return false;
    }
    return true;
}

void VtkBlock::read_cuts(std::size_t axis, const std::string& keyword, TextScanner& in, VtkValues& values) {
    const std::size_t count = in.count({keyword});
    values.begin(values.read_type(keyword));
    cuts_[axis].clear();
    cuts_[axis].reserve(std::min(count, values.room()));
    for (std::size_t i = 0; i < count; ++i) cuts_[axis].push_back(values.real({keyword, static_cast<std::int64_t>(i), count}));
}

void VtkBlock::expect_cells(const TextScanner& in) const {
    if (grid_.cell_count() == 0) in.fail("there is no cell between " + size_text(grid_));
}

void VtkBlock::add_points(const TextScanner& in, MeshFile& into) {
    if (lists_points() || has_points_) return;
    has_points_ = true;
    expect_cells(in);
    constexpr std::size_t kBits = 8;  // a value takes at least one
    if (grid_.point_count() > most_points(kBits * in.size())) {
        in.fail("DIMENSIONS: " + size_text(grid_) + " are more than the file can have values for");
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t along = grid_.points[a];
        if (kind_ == Kind::Cuts) {
            if (cuts_[a].size() == along) continue;
            in.fail("there are " + std::to_string(cuts_[a].size()) + " " + "XYZ"[a] + "_COORDINATES, but DIMENSIONS says " +
                    size_text(grid_));
        }
        for (std::size_t i = 0; i < along; ++i) cuts_[a].push_back(origin_[a] + spacing_[a] * static_cast<double>(i));
    }
    detail::add_points(into, cuts_, in.position());
}

void VtkBlock::add_cells(const TextScanner& in, MeshFile& into) const {
    if (into.points.size() != grid_.point_count()) {
        in.fail("there are " + std::to_string(into.points.size()) + " POINTS, but DIMENSIONS says " + size_text(grid_));
    }
    expect_cells(in);
    add_hexes(into, grid_, 0, 0);
}

}  // namespace subvol::detail
