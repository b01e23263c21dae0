// SPDX-License-Identifier: Apache-2.0
#include "foam_case.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include "foam_text.h"
#include "mesh_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

// A case has one mesh in constant/polyMesh, or that of each processor in a folder of its own (processor0, processor1, …), or
// those of several in the files of one folder, block after block: "processors" has all of them, "processors8" too, and
// "processors8_4-7" those from 4 to 7 of 8. A processor that is missing would leave a hole in the mesh, so all are counted.

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
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

// Each processor's own folder. They are numbered from 0.
std::vector<FoamCase::Part> folders_of_processors(const fs::path& root) {
    std::vector<FoamCase::Part> parts;
    for (const auto& [number, name] : numbered(root, "processor")) parts.push_back({root / name});
    // A solver's working folders need not have a mesh, but then none of them has.
    const auto meshes = std::ranges::count_if(parts, [](const FoamCase::Part& part) { return has_mesh(part.folder); });
    if (meshes == 0) parts.clear();
    return parts;
}

// Refuses folders of single processors of which one is missing, has no mesh, or is there twice by a link.
void check_processors(const FoamCase& found, const std::string& file) {
    for (std::size_t k = 0; k < found.parts.size(); ++k) {
        const fs::path& folder = found.parts[k].folder;
        const std::string name = "processor" + std::to_string(k);
        if (folder.filename() != name || !has_mesh(folder)) {
            throw Error(ErrorCode::InvalidInput, "there is no mesh in the folder " + name, file,
                        "all of the " + counted(found.parts.size(), "processor", "processors") + " need one");
        }
        std::error_code none;
        const auto is_same = [&](std::size_t other) { return fs::equivalent(folder, found.parts[other].folder, none); };
        for (std::size_t other = 0; fs::is_symlink(folder, none) && other < found.parts.size(); ++other) {
            if (other != k && is_same(other)) {
                throw Error(ErrorCode::InvalidInput, name + " is the same folder as processor" + std::to_string(other), file);
            }
        }
    }
}

/// A folder with the files of several processors: "processors", "processors8", or "processors8_4-7" for some of them.
///
/// total: of all processors, and first and last of those in the folder, where the name says so
struct CollatedFolder {
    fs::path path;
    std::optional<std::size_t> total, last = {};
    std::size_t first = 0;
};

std::optional<CollatedFolder> collated_folder(const fs::path& path) {
    constexpr std::string_view kPrefix = "processors";
    const std::string name = path.filename().string();
    if (!name.starts_with(kPrefix)) return {};
    const std::string_view rest = std::string_view(name).substr(kPrefix.size());
    const std::size_t ranks = std::min(rest.find('_'), rest.size()), dash = std::min(rest.find('-', ranks), rest.size());
    CollatedFolder folder{path, number_of<std::size_t>(rest.substr(0, ranks))};
    if (ranks == rest.size()) return rest.empty() || folder.total ? std::optional(folder) : std::nullopt;
    const auto first = number_of<std::size_t>(rest.substr(ranks + 1, dash - std::min(dash, ranks + 1)));
    if (!first) return {};
    folder.first = *first;
    folder.last = dash < rest.size() ? number_of<std::size_t>(rest.substr(dash + 1)) : first;
    return folder;
}

std::vector<CollatedFolder> collated_folders(const fs::path& root) {
    std::vector<CollatedFolder> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(root, none)) {
        if (!entry.is_directory(none) || !has_mesh(entry.path())) continue;
        if (const auto folder = collated_folder(entry.path())) found.push_back(*folder);
    }
    std::ranges::sort(found, {}, [](const CollatedFolder& folder) { return std::pair(folder.first, folder.path); });
    return found;
}

// How many processors have their mesh in a folder: the blocks of any of its files.
std::size_t blocks_in(const fs::path& folder) {
    const fs::path of_constant = folder / "constant/polyMesh/owner";
    if (is_there(of_constant)) return FoamText(of_constant).blocks();
    for (const auto& [time, name] : numbered(folder, "")) {
        const fs::path file = folder / name / "polyMesh/owner";
        if (is_there(file)) return FoamText(file).blocks();
    }
    return 0;
}

// The processors in the files of several of them.
std::vector<FoamCase::Part> blocks_of_processors(const fs::path& root, const std::string& file) {
    const std::vector<CollatedFolder> folders = collated_folders(root);
    std::vector<FoamCase::Part> parts;
    const auto missing = [&](std::size_t processor) {
        throw Error(ErrorCode::InvalidInput, "there is no folder with the files of processor " + std::to_string(processor),
                    file);
    };
    for (const CollatedFolder& folder : folders) {
        if (folder.first < parts.size()) {
            throw Error(ErrorCode::InvalidInput,
                        "processor " + std::to_string(folder.first) + " is in " + in_quotes(folder.path.filename().string()) +
                            " and in another folder",
                        file, "remove the folders of the other decomposition");
        }
        if (folder.first > parts.size()) missing(parts.size());
        const std::size_t blocks = blocks_in(folder.path);
        const auto named = folder.last ? std::optional(*folder.last + 1 - folder.first) : folder.total;
        if (named && blocks != *named) {
            throw Error(ErrorCode::InvalidInput,
                        counted(blocks, "block", "blocks") + " in the files of a folder for " +
                            counted(*named, "processor", "processors"),
                        folder.path.string());
        }
        for (std::size_t b = 0; b < blocks; ++b) parts.push_back({folder.path, b});
    }
    if (!folders.empty() && folders.front().total && *folders.front().total != parts.size()) missing(parts.size());
    return parts;
}

}  // namespace

bool is_there(const fs::path& file) {
    std::error_code none;
    return fs::exists(file, none) || fs::exists(file.string() + ".gz", none);
}

fs::path FoamCase::mesh_file(std::size_t part, std::size_t step, const std::string& name) const {
    for (std::size_t k = std::min(step + 1, folders.size()); k-- > 0;) {
        const fs::path file = parts[part].folder / folders[k] / "polyMesh" / name;
        if (is_there(file)) return file;
    }
    return parts[part].folder / "constant/polyMesh" / name;
}

FoamCase find_foam_case(const fs::path& path) {
    std::error_code none;
    if (!fs::exists(path, none)) std::ignore = read_text(path);  // says what is wrong; the file's contents mean nothing
    FoamCase found;
    found.root = fs::is_directory(path, none) ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
    found.parts = folders_of_processors(found.root);
    const bool single = !found.parts.empty();
    if (!single) found.parts = blocks_of_processors(found.root, path.string());
    const bool whole = has_mesh(found.root);
    if (!whole && found.parts.empty()) {
        throw Error(ErrorCode::InvalidInput, "there is no mesh of OpenFOAM", path.string(),
                    "constant/polyMesh/faces is needed, there, in processor0 or in processors");
    }
    found.decomposed = !whole || (!found.parts.empty() && last_time(found.parts.front().folder) > last_time(found.root));
    if (!found.decomposed) found.parts = {{found.root}};
    if (found.decomposed && single) check_processors(found, path.string());
    for (const auto& [time, name] : numbered(found.parts.front().folder, "")) {
        found.times.push_back(time);
        found.folders.push_back(name);
    }
    return found;
}

}  // namespace subvol::detail
