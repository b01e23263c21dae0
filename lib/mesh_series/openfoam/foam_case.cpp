// SPDX-License-Identifier: Apache-2.0
#include "foam_case.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace {

namespace fs = std::filesystem;

template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

bool is_there(const fs::path& file) {
    std::error_code none;
    return fs::exists(file, none) || fs::exists(file.string() + ".gz", none);
}

// The folders inside a folder, by the numbers that their names are after a prefix.
std::map<double, std::string> numbered(const fs::path& folder, std::string_view prefix) {
    std::map<double, std::string> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix) || !entry.is_directory(none)) continue;
        const auto number = number_of<double>(std::string_view(name).substr(prefix.size()));
        if (number && std::isfinite(*number)) found.emplace(*number, name);
    }
    return found;
}

bool has_mesh(const fs::path& part) {
    if (is_there(part / "constant/polyMesh/faces")) return true;
    return std::ranges::any_of(numbered(part, ""),
                               [&](const auto& time) { return is_there(part / time.second / "polyMesh/faces"); });
}

double last_time(const fs::path& part) {
    const auto times = numbered(part, "");
    return times.empty() ? -1 : times.rbegin()->first;
}

}  // namespace

fs::path FoamCase::mesh_file(std::size_t part, std::size_t step, const std::string& name) const {
    for (std::size_t k = std::min(step + 1, folders.size()); k-- > 0;) {
        const fs::path file = parts[part] / folders[k] / "polyMesh" / name;
        if (is_there(file)) return file;
    }
    return parts[part] / "constant/polyMesh" / name;
}

FoamCase find_foam_case(const fs::path& path) {
    std::error_code none;
    if (!fs::exists(path, none)) static_cast<void>(read_text(path));  // says what is wrong; the file's contents mean nothing
    FoamCase found;
    found.root = fs::is_directory(path, none) ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
    for (const auto& [number, name] : numbered(found.root, "processor")) {
        if (has_mesh(found.root / name)) found.parts.push_back(found.root / name);
    }
    const bool whole = has_mesh(found.root);
    if (!whole && found.parts.empty()) {
        throw Error(ErrorCode::InvalidInput, "there is no mesh of OpenFOAM", path.string(),
                    "constant/polyMesh/faces is needed, there or in processor0");
    }
    found.decomposed = !whole || (!found.parts.empty() && last_time(found.parts.front()) > last_time(found.root));
    if (!found.decomposed) found.parts = {found.root};
    for (const auto& [time, name] : numbered(found.parts.front(), "")) {
        found.times.push_back(time);
        found.folders.push_back(name);
    }
    return found;
}

std::vector<double> foam_times(const fs::path& path) {
    return find_foam_case(path).times;
}

}  // namespace subvol::detail
