// SPDX-License-Identifier: Apache-2.0
#include "vdb_parts.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <optional>
#include <set>

#include "quantities.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/vdb_file.h"
#include "subvol/error.h"
#include "subvol/join_grids.h"
#include "subvol/vdb_contents.h"
#include "subvol/version.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

Json corner(const Vec3& p) {
    return {p.x, p.y, p.z};
}

Json entry_of(const std::string& file, const GridReport& first) {
    Json entry{{"file", file}, {"active_voxels", first.active_voxels}};
    if (first.active_voxels > 0) entry["bounds"] = {corner(first.bounds.lower), corner(first.bounds.upper)};
    return entry;
}

/// path: the final name, for messages
void write_text(const detail::AtomicFile& file, const fs::path& path, const std::string& text) {
    std::FILE* const stream = file.open();
    const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    if (std::fclose(stream) != 0 || !written) {
        throw Error(ErrorCode::Io, "cannot be written; the disk may be full", path.string());
    }
}

constexpr const char* kEarlier = "earlier_parts";

/// The parts that the list of an earlier run names, its own and those that were there before. Nothing if there is another file
/// with the name of the list.
std::optional<std::set<std::string>> parts_of_list(const fs::path& list) {
    std::set<std::string> parts;
    std::error_code error;
    if (!fs::exists(list, error)) return parts;
    if (!fs::is_regular_file(list, error)) return {};
    Json json;
    try {
        json = Json::parse(detail::of_limited_depth(detail::read_text(list), list.string()), nullptr, false);
    } catch (const Error&) {  // it cannot be read, or is not such a list
    }
    if (!json.is_object() || !json.contains("voxel_size") || !json.contains("parts") || !json["parts"].is_array()) return {};
    for (const Json& part : json["parts"]) {
        if (!part.is_object() || !part.contains("file") || !part["file"].is_string()) return {};
        parts.insert(part["file"].get<std::string>());
    }
    for (const Json& part : json.value(kEarlier, Json::array())) {
        if (part.is_string()) parts.insert(part.get<std::string>());
    }
    return parts;
}

[[noreturn]] void refuse_list(const fs::path& list) {
    throw Error(ErrorCode::InvalidInput, "exists and is not a list of grids; the list of the parts would have this name",
                list.string(), "another name for -o");
}

}  // namespace

VdbParts::VdbParts(const VdbOutput& output, std::uint64_t memory_bytes)
    : output_(output),
      list_file_(fs::path(output.path).replace_extension(".json")),
      earlier_(parts_of_list(list_file_)),
      memory_bytes_(memory_bytes) {
    if (always_listed() && !earlier_) refuse_list(list_file_);
}

void VdbParts::write(std::span<const VdbGrid> grids, std::size_t number, const Json& more) {
    const fs::path path(output_.path);
    const std::string name = text(path.stem().string(), "_", std::setw(4), std::setfill('0'), number, ".vdb");
    vdb().write_vdb_file(files_.emplace_back(path.parent_path() / name), name, grids, output_.compression);
    const GridReport& first = grids.front().report();
    active_voxels_ += first.active_voxels;
    for (const VdbGrid& grid : grids) bytes_ += grid.report().bytes;
    if (!earlier_ && count() > 0 && bytes_ > memory_bytes_) refuse_list(list_file_);
    Json entry = entry_of(name, first);
    entry.update(more);
    list_.push_back(std::move(entry));
}

Facts VdbParts::finish(const std::string& input, double voxel_size_world, Progress* progress) {
    Facts facts;
    const bool whole = count() == 1 || bytes_ <= memory_bytes_;
    std::vector<VdbGrid> grids;
    if (whole) {
        grids = facts.timed(progress, "join", [&] { return joined(); });
        files_.clear();
        list_ = Json::array({entry_of(fs::path(output_.path).filename().string(), grids.front().report())});
    } else {
        check_names();
    }
    // All files are on the disk before the first one has its name.
    std::optional<detail::AtomicFile> list;
    if (!whole || always_listed()) {
        Json json{{"input", input},
                  {"version", SUBVOL_VERSION},
                  {"voxel_size", voxel_size_world},
                  {"active_voxels", active_voxels_},
                  {"parts", list_}};
        const Json earlier = earlier_parts();
        if (!earlier.empty()) {
            json[kEarlier] = earlier;
            facts.warn(text(counted(earlier.size(), "part"), " of an earlier run, as ", earlier.front().get<std::string>(),
                            ", remain beside ", output_.path));
        }
        write_text(list.emplace(list_file_), list_file_, json.dump(2) + "\n");
    }
    if (whole) facts.merge(write_reported(grids, output_, progress));
    if (list) list->commit();  // before the parts: it says whose they are, should this process end between two of them
    for (detail::AtomicFile& file : files_) file.commit();
    facts["parts"] = count();
    facts["active_voxels"] = active_voxels_;
    facts["voxel_size"] = voxel_size_world;
    if (!whole) facts["output"] = list_file_.string();
    warn(whole, facts);
    return facts;
}

/// What a user who has asked for one file should know.
void VdbParts::warn(bool whole, Facts& facts) const {
    if (!whole) {
        facts.warn(text("the grids take ", bytes_text(static_cast<double>(bytes_)), ", more than the ",
                        bytes_text(static_cast<double>(memory_bytes_)), " of --memory: they are in ", counted(count(), "file"),
                        ", which ", list_file_.string(), " lists; `subvol join` makes ", output_.path, " of it in memory"));
        std::error_code error;
        if (fs::exists(output_.path, error)) facts.warn(text(output_.path, " is that of an earlier run"));
    } else if (!always_listed()) {
        if (earlier_ && !earlier_->empty()) facts.warn(text(list_file_.string(), " and its parts are those of an earlier run"));
    }
}

/// All parts together.
std::vector<VdbGrid> VdbParts::joined() const {
    std::vector<std::vector<VdbGrid>> of_grids;  // of each grid its parts
    for (const detail::AtomicFile& file : files_) {
        std::vector<VdbGrid> read = vdb().read_vdb_contents(file.path().string()).grids;
        of_grids.resize(std::max(of_grids.size(), read.size()));
        for (std::size_t g = 0; g < read.size(); ++g) of_grids[g].push_back(std::move(read[g]));
    }
    std::vector<VdbGrid> grids;
    for (std::vector<VdbGrid>& parts : of_grids) grids.push_back(vdb().join_grids(std::move(parts)));
    return grids;
}

/// The parts of earlier runs that this one does not replace. They are not removed: something else may have their names by now.
Json VdbParts::earlier_parts() const {
    Json names = Json::array();
    std::error_code error;
    for (const std::string& name : earlier_.value_or(std::set<std::string>())) {
        const bool replaced = std::ranges::any_of(list_, [&](const Json& part) { return part.at("file") == name; });
        if (!replaced && fs::path(name).filename() == name && fs::exists(list_file_.parent_path() / name, error)) {
            names.push_back(name);
        }
    }
    return names;
}

/// The user has not given the names of parts: only those of an earlier run are replaced.
void VdbParts::check_names() const {
    if (!earlier_) refuse_list(list_file_);
    const fs::path folder = fs::path(output_.path).parent_path();
    for (const Json& part : list_) {
        const auto name = part.at("file").get<std::string>();
        std::error_code error;
        if (earlier_->contains(name) || !fs::exists(folder / name, error)) continue;
        throw Error(ErrorCode::InvalidInput, "exists and is not a part of grids that an earlier run has listed",
                    (folder / name).string(), "another name for -o, or more --memory");
    }
}

}  // namespace subvol::cli
