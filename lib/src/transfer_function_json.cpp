#include <fstream>
#include <nlohmann/json.hpp>

#include "subvol/error.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& file, const std::string& message, const std::string& allowed = {}) {
    throw Error(ErrorCode::InvalidInput, message, file, allowed);
}

json read_color_map(const std::string& file) {
    std::ifstream stream(file);
    if (!stream) throw Error(ErrorCode::Io, "cannot be opened", file);
    json document;
    try {
        document = json::parse(stream);
    } catch (const json::exception& e) {
        refuse(file, e.what());
    }
    // ParaView writes an array of colour maps; a bare one is as clear. The first counts.
    if (document.is_array() && !document.empty()) document = json(document.front());
    if (!document.is_object()) refuse(file, "holds no colour map", "an array with one object that has RGBPoints");
    return document;
}

/// The numbers at a key, four of them a knot.
std::vector<double> read_quadruples(const json& map, const std::string& file, const std::string& key) {
    const auto found = map.find(key);
    if (found == map.end()) refuse(file, "key '" + key + "' is missing");
    if (!found->is_array() || found->empty() || found->size() % 4 != 0) {
        refuse(file, "key '" + key + "' is not an array of four numbers a knot");
    }
    std::vector<double> numbers;
    numbers.reserve(found->size());
    for (const json& item : *found) {
        if (!item.is_number()) refuse(file, "key '" + key + "', entry " + std::to_string(numbers.size()) + " is not a number");
        numbers.push_back(item.get<double>());
    }
    return numbers;
}

std::vector<TransferFunction::ColorKnot> read_colors(const json& map, const std::string& file) {
    const std::vector<double> n = read_quadruples(map, file, "RGBPoints");
    std::vector<TransferFunction::ColorKnot> knots;
    for (std::size_t i = 0; i < n.size(); i += 4) {
        knots.push_back({n[i], linear_from_srgb(Vec3(n[i + 1], n[i + 2], n[i + 3]))});
    }
    return knots;
}

std::vector<TransferFunction::OpacityKnot> read_opacities(const json& map, const std::string& file) {
    const std::vector<double> n = read_quadruples(map, file, "Points");
    std::vector<TransferFunction::OpacityKnot> knots;
    for (std::size_t i = 0; i < n.size(); i += 4) {
        if (n[i + 2] != 0.5 || n[i + 3] != 0) {
            refuse(file, "key 'Points', knot " + std::to_string(i / 4) + " is not linear", "midpoint 0.5 and sharpness 0");
        }
        knots.push_back({n[i], n[i + 1]});
    }
    return knots;
}

}  // namespace

TransferFunction read_transfer_function(const std::filesystem::path& path) {
    const std::string file = path.string();
    const json map = read_color_map(file);
    TransferFunction function{.color = read_colors(map, file), .opacity = {}};
    if (map.contains("Points")) {
        function.opacity = read_opacities(map, file);
    } else if (const double first = function.color.front().value, last = function.color.back().value; first < last) {
        function.opacity = {{first, 0}, {last, 0.5}};
    } else {
        function.opacity = {{first, 0.5}};
    }
    try {
        validate(function);
    } catch (const Error& e) {
        refuse(file, e.what());
    }
    return function;
}

}  // namespace subvol
