// SPDX-License-Identifier: Apache-2.0
#include "brick_index.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "brick_layers.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/error.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

using Json = nlohmann::ordered_json;

std::uint64_t from_hex(const Json& text) {
    const auto digits = text.get<std::string>();
    if (digits.size() != 16 || digits.find_first_not_of("0123456789abcdef") != std::string::npos) {
        throw std::invalid_argument("hash");
    }
    return std::stoull(digits, nullptr, 16);
}

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
        const auto channels = static_cast<std::size_t>(std::max(field.channels, 0));
        if (channels == 0 || field.min.size() != channels || field.max.size() != channels) throw std::invalid_argument("field");
        fields.push_back(std::move(field));
    }
    return fields;
}

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

BrickField range_of_owned(const Attribute& field, const std::vector<std::uint8_t>& owned) {
    const auto channels = static_cast<std::size_t>(field.channels);
    BrickField range{.name = field.name,
                     .channels = field.channels,
                     .min = std::vector<double>(channels, HUGE_VAL),
                     .max = std::vector<double>(channels, -HUGE_VAL),
                     .shortest = HUGE_VAL,
                     .longest = -HUGE_VAL};
    for (std::size_t p = 0; p < owned.size(); ++p) {
        if (!owned[p]) continue;
        double square = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double value = field.values[p * channels + c];
            range.min[c] = std::min(range.min[c], value);
            range.max[c] = std::max(range.max[c], value);
            square += value * value;
        }
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

Brick describe(const BrickMesh& brick) {
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
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw Error(ErrorCode::InvalidInput, "not well-formed JSON", file);
    try {
        if (json.at("format") != "OpenSubVol bricks") throw std::invalid_argument("format");
        if (const int version = json.at("version"); version != kBricksFormat) {
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
        std::set<std::string> files;
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
            // A name is used to read and to remove: never anything outside of the folder, and no other file in it.
            if (!is_brick_name(brick.file) || !files.insert(brick.file).second) throw std::invalid_argument("file");
            bricks.bricks.push_back(std::move(brick));
        }
        if (bricks.bricks.empty() && !unfinished) throw std::invalid_argument("bricks");
        return bricks;
    } catch (const std::exception& error) {
        if (const auto* ours = dynamic_cast<const Error*>(&error)) throw *ours;
        throw Error(ErrorCode::InvalidInput, "is not an index of bricks as `subvol split` writes it", file);
    }
}

void check_files(const Bricks& bricks) {
    for (const Brick& brick : bricks.bricks) {
        const std::filesystem::path file = bricks.path / brick.file;
        std::error_code error;
        const auto bytes = std::filesystem::file_size(file, error);
        if (error) {
            throw Error(ErrorCode::InvalidInput, "a brick is missing: " + brick.file, bricks.path.string(),
                        "split the mesh again");
        }
        if (bytes != brick.bytes) {
            throw Error(ErrorCode::InvalidInput,
                        "has " + std::to_string(bytes) + " bytes, in the index it has " + std::to_string(brick.bytes),
                        file.string(), "split the mesh again");
        }
    }
}

}  // namespace subvol::detail
