// SPDX-License-Identifier: Apache-2.0
#include "openvdb_grids.h"

#include "subvol/detail/vdb_file.h"
#include "subvol/error.h"
#include "vdb_data.h"
#include "vdb_stream.h"

namespace subvol {

using namespace detail;

void detail::write_vdb(const AtomicFile& file, const std::filesystem::path& path, std::span<const VdbGrid> grids,
                       VdbCompression compression) {
    openvdb::GridCPtrVec written;
    for (const auto& grid : grids) written.push_back(VdbData::of(grid).grid);
    write_grids(file, path, written, compression);
}

void write_vdb(const std::filesystem::path& path, std::span<const VdbGrid> grids, VdbCompression compression) {
    AtomicFile file(path);
    detail::write_vdb(file, path, grids, compression);
    file.commit();
}

std::vector<VdbGrid> read_vdb(const std::filesystem::path& path) {
    const auto grids = read_grids(path);
    std::vector<VdbGrid> result;
    std::string others;
    for (const auto& grid : *grids) {
        if (grid->isType<openvdb::FloatGrid>()) {
            result.push_back(make_vdb_grid(grid));
        } else {
            others += (others.empty() ? "" : ", ") + grid->type();
        }
    }
    if (result.empty()) {
        throw Error(ErrorCode::InvalidInput, "holds no float grid", path.string(), others.empty() ? "" : "it holds: " + others);
    }
    return result;
}

}  // namespace subvol
