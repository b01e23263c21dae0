// SPDX-License-Identifier: Apache-2.0
#include "brick_index.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "brick_folder.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/version.h"

// The index of a folder says all that is known about a brick before it is read: what it owns and stores, the box of its cells,
// and its reach, the box that the limit of its cells does not leave:
//
//      +--------------------+      reach = box of the cells and of all cells at their points, a quarter larger; a scheme's
//      |  +-------------+   |      weights may be negative, but their absolute values add up to less than 1.5
//      |  | own cells   |   |
//      |  +-------------+   |      Readers skip a brick whose reach does not touch what they look for.
//      +--------------------+

namespace subvol::detail {

namespace {

using Json = nlohmann::ordered_json;

/// Hashes are stored as 16 hexadecimal digits, because many JSON readers keep numbers as doubles, which have only 53 bits.
std::uint64_t from_hex(const Json& text) {
    const auto digits = text.get<std::string>();
    if (digits.size() != 16 || digits.find_first_not_of("0123456789abcdef") != std::string::npos) {
        throw std::invalid_argument("hash");
    }
    return std::stoull(digits, nullptr, 16);
}

/// A count. The JSON library would silently turn negative numbers and fractions into a count, so they are refused here.
std::uint64_t count_from(const Json& number) {
    if (!number.is_number_unsigned()) throw std::invalid_argument("count");
    return number.get<std::uint64_t>();
}

Json to_json(const Box& box) {
    return {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}};
}

Box box_from(const Json& json) {
    const auto corner = [](const Json& at) { return Vec3(at.at(0), at.at(1), at.at(2)); };
    return {corner(json.at(0)), corner(json.at(1))};
}

Json to_json(const std::vector<BrickField>& fields) {
    Json list = Json::array();
    for (const BrickField& field : fields) {
        list.push_back({{"name", field.name},
                        {"components", field.channels},
                        {"min", field.min},
                        {"max", field.max},
                        {"lengths", {field.shortest, field.longest}}});
        if (!field.bounds.empty()) list.back()["bounds"] = field.bounds;
    }
    return list;
}

std::vector<BrickField> fields_from(const Json& json) {
    std::vector<BrickField> fields;
    for (const Json& entry : json) {
        BrickField field{.name = entry.at("name"),
                         .channels = entry.at("components"),
                         .min = entry.at("min"),
                         .max = entry.at("max"),
                         .shortest = entry.at("lengths").at(0),
                         .longest = entry.at("lengths").at(1)};
        if (entry.contains("bounds")) field.bounds = entry.at("bounds").get<std::vector<std::array<double, 2>>>();
        for (const auto& [low, high] : field.bounds) {
            if (!(low <= high)) throw std::invalid_argument("bounds");
        }
        const auto channels = static_cast<std::size_t>(std::max(field.channels, 0));
        if (!field.bounds.empty() && field.bounds.size() != channels) throw std::invalid_argument("bounds");
        if (channels == 0 || field.min.size() != channels || field.max.size() != channels) throw std::invalid_argument("field");
        fields.push_back(std::move(field));
    }
    return fields;
}

/// Whether a box is finite and not empty: bounds of zero thickness, as of a flat set of points, are allowed.
bool is_sound(const Box& box) {
    for (int d = 0; d < 3; ++d) {
        if (!std::isfinite(box.lower[d]) || !std::isfinite(box.upper[d]) || box.lower[d] > box.upper[d]) return false;
    }
    return true;
}

bool encloses(const Box& outer, const Box& inner) {
    for (int d = 0; d < 3; ++d) {
        if (!(outer.lower[d] <= inner.lower[d] && inner.upper[d] <= outer.upper[d])) return false;
    }
    return true;
}

/// What the entry of a brick says contradicts itself.
void check_entry(const Brick& brick) {
    // A point of a part belongs to one of its cells, and no sum over a million bricks overflows.
    constexpr std::uint64_t kMostCells = std::uint64_t{1} << 40;
    // A name is used to read and to remove: never anything outside of the folder, and no other file in it.
    if (!is_brick_name(brick.file)) throw std::invalid_argument("file");
    if (brick.cells == 0 || brick.cells > brick.stored_cells || brick.stored_cells > kMostCells) {
        throw std::invalid_argument("cells");
    }
    if (brick.points > brick.stored_points || brick.stored_points > 8 * brick.stored_cells) {
        throw std::invalid_argument("points");
    }
    if (!is_sound(brick.bounds) || !is_sound(brick.reach) || !encloses(brick.reach, brick.bounds)) {
        throw std::invalid_argument("bounds");
    }
}

bool same_names(const std::vector<BrickField>& a, const std::vector<BrickField>& b) {
    return std::ranges::equal(
        a, b, [](const BrickField& x, const BrickField& y) { return x.name == y.name && x.channels == y.channels; });
}

bool same_bounds(const std::vector<BrickField>& a, const std::vector<BrickField>& b) {
    return std::ranges::equal(a, b, {}, &BrickField::bounds, &BrickField::bounds);
}

bool same_ranges(const std::vector<BrickField>& a, const std::vector<BrickField>& b) {
    return std::ranges::equal(a, b, [](const BrickField& x, const BrickField& y) { return x.min == y.min && x.max == y.max; });
}

[[noreturn]] void refuse(const std::string& what, const std::string& file) {
    throw Error(ErrorCode::InvalidInput, what, file, "split the mesh again");
}

/// Refuses an index in which two entries name one file, or have one hash: a copied brick would give its cells to the mesh
/// twice.
void check_distinct(const Bricks& bricks, const std::string& file) {
    std::set<std::string_view> files;
    std::set<std::uint64_t> hashes;
    for (const Brick& brick : bricks.bricks) {
        if (!files.insert(brick.file).second) refuse("names the brick " + brick.file + " twice", file);
        if (!hashes.insert(brick.hash).second) refuse("has the same hash for " + brick.file + " as for another brick", file);
    }
}

/// The bricks together are what the index says of the mesh.
void check_whole(const Bricks& bricks, const std::string& file) {
    for (const Brick& brick : bricks.bricks) {
        if (!same_names(brick.fields, bricks.fields)) refuse("gives " + brick.file + " other fields than the mesh", file);
        if (!same_bounds(brick.fields, bricks.fields)) refuse("gives " + brick.file + " other bounds than the mesh", file);
    }
    // The index stores the sums although they follow from the bricks, so that a lost or an added entry is found without reading
    // any brick.
    Bricks sum = bricks;
    sum_up(sum);
    const auto check_count = [&](std::uint64_t counted, std::uint64_t said, const char* what) {
        if (counted == said) return;
        refuse(
            "says that the mesh has " + std::to_string(said) + " " + what + ", and its bricks own " + std::to_string(counted),
            file);
    };
    check_count(sum.cells, bricks.cells, "cells");
    check_count(sum.points, bricks.points, "points");
    if (sum.bounds.lower != bricks.bounds.lower || sum.bounds.upper != bricks.bounds.upper) {
        refuse("gives the mesh other bounds than its bricks have together", file);
    }
    if (!same_ranges(sum.fields, bricks.fields)) {
        refuse("gives the mesh other ranges of fields than its bricks have together", file);
    }
}

/// Widens the ranges of `into` so that they contain those of `fields`. Only the common part is merged, because the bricks of an
/// index that has not been checked may have different fields.
void merge(std::vector<BrickField>& into, const std::vector<BrickField>& fields) {
    if (into.empty()) into = fields;
    for (std::size_t f = 0; f < std::min(into.size(), fields.size()); ++f) {
        for (std::size_t c = 0; c < std::min(into[f].min.size(), fields[f].min.size()); ++c) {
            into[f].min[c] = std::min(into[f].min[c], fields[f].min[c]);
            into[f].max[c] = std::max(into[f].max[c], fields[f].max[c]);
        }
        into[f].shortest = std::min(into[f].shortest, fields[f].shortest);
        into[f].longest = std::max(into[f].longest, fields[f].longest);
    }
}

/// The range of a field over the points that the brick owns. Points of the halo are left out, because other bricks own them and
/// their ranges count there.
BrickField range_of_owned(const Attribute& field, const std::vector<std::uint8_t>& owned) {
    const auto channels = static_cast<std::size_t>(field.channels);
    BrickField range{.name = field.name,
                     .channels = field.channels,
                     .min = std::vector<double>(channels, HUGE_VAL),
                     .max = std::vector<double>(channels, -HUGE_VAL),
                     .shortest = HUGE_VAL,
                     .longest = -HUGE_VAL,
                     .bounds = field.bounds};
    for (std::size_t p = 0; p < owned.size(); ++p) {
        if (!owned[p]) continue;
        double square = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double value = field.values[p * channels + c];
            range.min[c] = std::min(range.min[c], value);
            range.max[c] = std::max(range.max[c], value);
            square += value * value;
        }
        // A scalar keeps its sign as its "length", so that its range of lengths is its range of values.
        const double length = channels == 1 ? field.values[p] : std::sqrt(square);
        range.shortest = std::min(range.shortest, length);
        range.longest = std::max(range.longest, length);
    }
    return range;
}

}  // namespace

std::string brick_name(std::size_t brick) {
    char name[32];
    std::snprintf(name, sizeof name, "brick_%05zu.vtu", brick);
    return name;
}

bool is_brick_name(const std::string& name) {
    constexpr std::string_view kBefore = "brick_", kAfter = ".vtu";
    std::size_t brick = 0;
    if (!name.starts_with(kBefore) || !name.ends_with(kAfter)) return false;
    (void)std::from_chars(name.data() + kBefore.size(), name.data() + name.size(), brick);
    return name == brick_name(brick);
}

Brick describe(const MeshPiece& brick) {
    const HexMesh& mesh = brick.mesh;
    Brick about;
    about.cells = static_cast<std::uint64_t>(std::ranges::count(brick.owned_cells, 1));
    about.points = static_cast<std::uint64_t>(std::ranges::count(brick.owned_points, 1));
    about.stored_cells = mesh.cells.size();
    about.stored_points = mesh.points.size();
    const CellReaches reaches(mesh);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if (!brick.owned_cells[c]) continue;
        for (const Index p : mesh.cells[c]) about.bounds.add(mesh.points[p]);
        about.reach.add(reaches(c));
    }
    // A brick may own cells and no points: its fields then have no range.
    for (const Attribute& field : mesh.attributes) about.fields.push_back(range_of_owned(field, brick.owned_points));
    if (about.points == 0) {
        std::vector<std::uint8_t> all(mesh.points.size(), 1);
        about.fields.clear();
        for (const Attribute& field : mesh.attributes) about.fields.push_back(range_of_owned(field, all));
    }
    return about;
}

void sum_up(Bricks& bricks) {
    bricks.cells = bricks.points = 0;
    bricks.bounds = {};
    bricks.fields.clear();
    for (const Brick& brick : bricks.bricks) {
        bricks.cells += brick.cells;
        bricks.points += brick.points;
        bricks.bounds.add(brick.bounds);
        merge(bricks.fields, brick.fields);
    }
}

std::string bricks_to_json(const Bricks& bricks) {
    // Keys are written in a fixed order, so that the same split gives the same bytes.
    Json list = Json::array();
    for (const Brick& brick : bricks.bricks) {
        list.push_back({{"file", brick.file},
                        {"cells", brick.cells},
                        {"points", brick.points},
                        {"stored_cells", brick.stored_cells},
                        {"stored_points", brick.stored_points},
                        {"bounds", to_json(brick.bounds)},
                        {"reach", to_json(brick.reach)},
                        {"bytes", brick.bytes},
                        {"hash", hex_digits(brick.hash)},
                        {"fields", to_json(brick.fields)}});
    }
    const Json json{{"format", "OpenSubVol bricks"},
                    {"version", kBricksFormat},
                    {"program", SUBVOL_VERSION},
                    {"id", hex_digits(bricks.id)},
                    {"cells", bricks.cells},
                    {"points", bricks.points},
                    {"bounds", to_json(bricks.bounds)},
                    {"halo_layers", bricks.halo_layers},
                    {"fields", to_json(bricks.fields)},
                    {"bricks", list}};
    return json.dump(1) + "\n";
}

Bricks bricks_from_json(const std::string& text, const std::string& file, bool unfinished) {
    const Json json = Json::parse(of_limited_depth(text, file), nullptr, false);
    if (json.is_discarded()) throw Error(ErrorCode::InvalidInput, "not well-formed JSON", file);
    try {
        // The version is checked before anything else is read, because another version may have other keys.
        if (json.at("format") != "OpenSubVol bricks") throw std::invalid_argument("format");
        if (const std::uint64_t version = count_from(json.at("version")); version != kBricksFormat) {
            throw Error(ErrorCode::InvalidInput, "has version " + std::to_string(version) + " of the format of bricks", file,
                        "this program reads version " + std::to_string(kBricksFormat) + "; split the mesh again");
        }
        Bricks bricks;
        bricks.id = from_hex(json.at("id"));
        bricks.cells = count_from(json.at("cells"));
        bricks.points = count_from(json.at("points"));
        if (!unfinished) bricks.bounds = box_from(json.at("bounds"));
        const std::uint64_t layers = count_from(json.at("halo_layers"));
        if (layers < 1 || layers > kMostHaloLayers) throw std::invalid_argument("halo_layers");
        bricks.halo_layers = static_cast<int>(layers);
        bricks.fields = fields_from(json.at("fields"));
        for (const Json& entry : json.at("bricks")) {
            Brick brick{.file = entry.at("file"),
                        .cells = count_from(entry.at("cells")),
                        .points = count_from(entry.at("points")),
                        .stored_cells = count_from(entry.at("stored_cells")),
                        .stored_points = count_from(entry.at("stored_points")),
                        .bounds = box_from(entry.at("bounds")),
                        .reach = box_from(entry.at("reach")),
                        .bytes = count_from(entry.at("bytes")),
                        .hash = from_hex(entry.at("hash")),
                        .fields = fields_from(entry.at("fields"))};
            check_entry(brick);
            bricks.bricks.push_back(std::move(brick));
        }
        if (bricks.bricks.size() > kMostBricks) throw std::invalid_argument("bricks");
        check_distinct(bricks, file);
        // The progress of an unfinished split may have no brick yet, and it is not read as a mesh.
        if (unfinished) return bricks;
        if (bricks.bricks.empty()) throw std::invalid_argument("bricks");
        check_whole(bricks, file);
        return bricks;
    } catch (const std::exception& error) {
        // Errors of the JSON library and those thrown above as plain exceptions get one sentence; errors with a sentence of
        // their own keep it.
        if (const auto* ours = dynamic_cast<const Error*>(&error)) throw *ours;
        throw Error(ErrorCode::InvalidInput, "is not an index of bricks as `subvol split` writes it", file);
    }
}

// Only the sizes of the files are checked here, which costs no reading: the hash of a brick is checked when it is read.
void check_files(const Bricks& bricks) {
    for (const Brick& brick : bricks.bricks) {
        const std::filesystem::path file = bricks.path / brick.file;
        std::error_code error;
        const auto status = std::filesystem::symlink_status(file, error);
        if (!std::filesystem::exists(status)) {
            throw Error(ErrorCode::InvalidInput, "a brick is missing: " + brick.file, bricks.path.string(),
                        "split the mesh again");
        }
        if (!std::filesystem::is_regular_file(status)) {
            throw Error(ErrorCode::InvalidInput, "is a brick in the index and no regular file", file.string(),
                        "split the mesh again");
        }
        const auto bytes = std::filesystem::file_size(file, error);
        if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file.string());
        if (bytes != brick.bytes) {
            throw Error(ErrorCode::InvalidInput,
                        "has " + std::to_string(bytes) + " bytes, in the index it has " + std::to_string(brick.bytes),
                        file.string(), "split the mesh again");
        }
    }
}

void check_contents(const Bricks& bricks, const Brick& about, const MeshPiece& read, const std::string& file) {
    if (!read.cell_numbers.empty() && read.cell_numbers.back() >= bricks.cells) {
        throw Error(ErrorCode::InvalidInput,
                    "has cell " + std::to_string(read.cell_numbers.back()) + " of the mesh, and by the index the mesh has " +
                        std::to_string(bricks.cells) + " cells",
                    file, "split the mesh again");
    }
    // The entry is worked out again from the brick and compared, so that an index that was edited cannot make readers skip
    // cells.
    const Brick found = describe(read);
    // The reach is computed with roundings, which another program may have made otherwise.
    const Vec3 roundings(1e-9 * found.reach.diagonal());
    const bool same = found.stored_cells == about.stored_cells && found.stored_points == about.stored_points &&
                      found.cells == about.cells && found.points == about.points && found.bounds.lower == about.bounds.lower &&
                      found.bounds.upper == about.bounds.upper &&
                      encloses({about.reach.lower - roundings, about.reach.upper + roundings}, found.reach) &&
                      encloses({found.reach.lower - roundings, found.reach.upper + roundings}, about.reach);
    if (!same) throw Error(ErrorCode::InvalidInput, "has not the counts and bounds that the index gives", file);
    if (!same_names(found.fields, about.fields)) {
        throw Error(ErrorCode::InvalidInput, "has not the fields that the index gives", file);
    }
    if (!same_ranges(found.fields, about.fields)) {
        throw Error(ErrorCode::InvalidInput, "has not the ranges of fields that the index gives", file);
    }
}

}  // namespace subvol::detail
