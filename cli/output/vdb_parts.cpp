// SPDX-License-Identifier: Apache-2.0
#include "vdb_parts.h"

#include <filesystem>
#include <fstream>
#include <iomanip>

#include "subvol/detail/vdb_file.h"
#include "subvol/version.h"
#include "text.h"

namespace subvol::cli {
namespace {

Json corner(const Vec3& p) {
    return {p.x, p.y, p.z};
}

/// Writes a text into a file that is committed later. path: its final name, for error messages
void write_text(const detail::AtomicFile& file, const std::filesystem::path& path, const std::string& text) {
    std::ofstream out(file.path(), std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(ErrorCode::Io, "cannot be written; the disk may be full", path.string());
}

}  // namespace

void VdbParts::write(std::span<const VdbGrid> grids, std::size_t number, const Json& more) {
    const std::filesystem::path path(output_.path);
    const std::string name = text(path.stem().string(), "_", std::setw(4), std::setfill('0'), number, ".vdb");
    const GridReport& first = grids.front().report();
    detail::write_vdb(files_.emplace_back(path.parent_path() / name), name, grids, output_.compression);
    active_voxels_ += first.active_voxels;
    Json entry{{"file", name}, {"active_voxels", first.active_voxels}};
    entry.update(more);
    if (first.active_voxels > 0) entry["bounds"] = {corner(first.bounds.lower), corner(first.bounds.upper)};
    list_.push_back(std::move(entry));
}

std::string VdbParts::finish(const std::string& input, double voxel_size_world) {
    const std::filesystem::path list = std::filesystem::path(output_.path).replace_extension(".json");
    const Json json{{"input", input},
                    {"version", SUBVOL_VERSION},
                    {"voxel_size", voxel_size_world},
                    {"active_voxels", active_voxels_},
                    {"parts", list_}};
    write_text(files_.emplace_back(list), list, json.dump(2) + "\n");
    for (detail::AtomicFile& file : files_) file.commit();
    return list.string();
}

}  // namespace subvol::cli
