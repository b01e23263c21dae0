// SPDX-License-Identifier: Apache-2.0
#include "subvol/region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>

#include "region_cells.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/small_letters.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/quantity.h"

namespace subvol {
namespace {

constexpr const char* kKinds =
    "box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, half:px,py,pz,nx,ny,nz, where:EXPRESSION, set:NAME, nodes:NAME, fold:VERDICT";

std::vector<double> numbers_of(const std::string& text, std::string_view list, std::size_t count) {
    std::vector<double> numbers;
    bool right = true;
    for (std::size_t at = 0; right && at <= list.size();) {
        const std::size_t comma = std::min(list.find(',', at), list.size());
        const std::optional<double> number = detail::plain_number(list.substr(at, comma - at));
        right = number && std::isfinite(*number);
        if (right) numbers.push_back(*number);
        at = comma + 1;
    }
    if (!right || numbers.size() != count) {
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a region: " + std::to_string(count) + " numbers are needed",
                    {}, kKinds);
    }
    return numbers;
}

/// Calls use(name) for each name of a list with commas between.
template <class Use>
void each_name(const std::string& names, const Use& use) {
    for (std::size_t at = 0; at <= names.size();) {
        const std::size_t comma = std::min(names.find(',', at), names.size());
        use(names.substr(at, comma - at));
        at = comma + 1;
    }
}

std::vector<FoldVerdict> verdicts_of(const std::string& names) {
    std::vector<FoldVerdict> verdicts;
    each_name(names, [&](const std::string& name) { verdicts.push_back(named<FoldVerdict>(name, "fold")); });
    return verdicts;
}

}  // namespace

Region::Region(const std::string& text) : text_(text) {
    const auto flat = [&](const std::string& why) {
        throw Error(ErrorCode::InvalidInput, "'" + text + "' " + why, {}, kKinds);
    };
    const std::size_t colon = text.find(':');
    const std::string name = text.substr(0, colon);
    const std::string_view rest = colon == std::string::npos ? std::string_view() : std::string_view(text).substr(colon + 1);
    if (name == "box") {
        const auto n = numbers_of(text, rest, 6);
        box_ = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
        if (!(n[0] < n[3] && n[1] < n[4] && n[2] < n[5])) flat("has no volume: the first corner is the lower one");
    } else if (name == "sphere") {
        const auto n = numbers_of(text, rest, 4);
        kind_ = Kind::Sphere;
        point_ = {n[0], n[1], n[2]};
        radius_ = n[3];
        if (!(radius_ > 0)) flat("has no volume: the radius is more than 0");
    } else if (name == "half") {
        const auto n = numbers_of(text, rest, 6);
        kind_ = Kind::Half;
        point_ = {n[0], n[1], n[2]};
        const Vec3 normal(n[3], n[4], n[5]);
        if (glm::length(normal) == 0) flat("has no normal");
        normal_ = glm::normalize(normal);
    } else if ((name == "where" || name == "set" || name == "nodes") && !rest.empty()) {
        kind_ = name == "set" ? Kind::Set : name == "nodes" ? Kind::Nodes : Kind::Where;
        quantity_ = rest;
    } else if (name == "fold" && !rest.empty()) {
        kind_ = Kind::Fold;
        quantity_ = rest;
        std::ignore = verdicts_of(quantity_);
    } else {
        flat("is not a region");
    }
}

namespace {

Region region_of(const std::string& kind, const Vec3& a, const Vec3& b) {
    std::string text = kind;
    for (const double number : {a.x, a.y, a.z, b.x, b.y, b.z}) {
        text += (text.size() > kind.size() ? "," : ":") + detail::exact_text(number);
    }
    return {text};
}

}  // namespace

Region half_space(const Vec3& point, const Vec3& normal) {
    return region_of("half", point, normal);
}

Region box_region(const Box& box) {
    return region_of("box", box.lower, box.upper);
}

double Region::depth(const Vec3& place, std::size_t face) const {
    if (kind_ == Kind::Sphere) return radius_ - glm::distance(place, point_);
    if (kind_ == Kind::Half) return glm::dot(place - point_, normal_);
    const int axis = static_cast<int>(face % 3);
    return face < 3 ? place[axis] - box_.lower[axis] : box_.upper[axis] - place[axis];
}

double Region::depth(const Vec3& place) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t face = 0; face < faces(); ++face) least = std::min(least, depth(place, face));
    return least;
}

std::vector<Region> parse_regions(std::span<const std::string> texts) {
    return {texts.begin(), texts.end()};
}

SpaceAndCells space_and_cells(std::span<const Region> regions) {
    SpaceAndCells found;
    for (const Region& region : regions) (region.chooses_cells() ? found.cells : found.space).push_back(region);
    return found;
}

double depth(std::span<const Region> regions, const Vec3& place) {
    double least = std::numeric_limits<double>::infinity();
    for (const Region& region : regions) least = std::min(least, region.depth(place));
    return least;
}

namespace detail {

void refuse_none(std::span<const std::uint8_t> cells) {
    if (std::ranges::count(cells, 1) == 0) throw Error(ErrorCode::InvalidInput, "no cell lies in the region");
}

RegionCells::RegionCells(const HexMesh& mesh, const MeshSets& sets) : mesh_(mesh), sets_(sets) {
}

template <class Sets, class Find, class Use>
void RegionCells::each_set(const Sets& sets, const std::string& names, const Find& find, const Use& use) const {
    using Set = typename Sets::value_type;
    const auto whole = std::ranges::find(sets, names, &Set::name);
    if (whole != sets.end()) return use(*whole);
    each_name(names, [&](const std::string& name) {
        const auto same = [&](const Set& set) { return small_letters(set.name) == small_letters(name); };
        const bool is_there = std::ranges::find(sets, name, &Set::name) != sets.end();
        const auto alike = std::ranges::find_if(sets, same);  // names may differ in the case of letters
        use(is_there || alike == sets.end() ? find(sets_, name) : *alike);
    });
}

std::vector<std::uint8_t> RegionCells::in(const Region& region) {
    std::vector<std::uint8_t> inside(mesh_.cells.size(), 0);
    switch (region.kind()) {
        case Region::Kind::Set:
            each_set(sets_.sets, region.quantity(), find_set, [&](const CellSet& set) {
                for (const Index c : set.cells) inside[c] = 1;
            });
            break;
        case Region::Kind::Nodes:
            each_set(sets_.nodes, region.quantity(), find_node_set, [&](const NodeSet& set) {
                for (const CellCorners& at : set.cells) inside[at.cell] = 1;
            });
            break;
        case Region::Kind::Fold: {
            const std::vector<FoldVerdict> wanted = verdicts_of(region.quantity());
            if (verdicts_.empty()) verdicts_ = check_folds(mesh_).verdicts;
            for (std::size_t c = 0; c < inside.size(); ++c) inside[c] = std::ranges::count(wanted, verdicts_[c]) > 0 ? 1 : 0;
            break;
        }
        case Region::Kind::Where: {
            const Attribute values = select_field(mesh_, region.quantity()).scalar;
            parallel_each(inside.size(), [&](std::size_t c) {
                if (values.constant) {
                    inside[c] = values.cells[c] != 0;
                    return;
                }
                inside[c] = std::ranges::count_if(mesh_.cells[c], [&](Index p) { return values.values[p] != 0; }) >= 4;
            });
            break;
        }
        default:
            parallel_each(inside.size(), [&](std::size_t c) {
                Vec3 sum(0.0);
                for (const Index p : mesh_.cells[c]) sum += mesh_.points[p];
                inside[c] = region.depth(sum / 8.0) >= 0;
            });
    }
    return inside;
}

}  // namespace detail

std::vector<std::uint8_t> cells_in(const HexMesh& mesh, std::span<const Region> regions, const MeshSets& sets) {
    std::vector<std::uint8_t> inside(mesh.cells.size(), 1);
    detail::RegionCells cells(mesh, sets);
    for (const Region& region : regions) {
        const std::vector<std::uint8_t> of_region = cells.in(region);
        for (std::size_t c = 0; c < inside.size(); ++c) inside[c] = inside[c] && of_region[c];
    }
    detail::refuse_none(inside);
    return inside;
}

HexMesh only_in(const HexMesh& mesh, std::span<const Region> regions, const MeshSets& sets) {
    return only_cells(mesh, cells_in(mesh, regions, sets));
}

}  // namespace subvol
