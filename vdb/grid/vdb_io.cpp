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
    std::vector<VdbGrid> result;
    for (const auto& grid : read_grids(path, openvdb::FloatGrid::gridType(), "float grid"))
        result.push_back(make_vdb_grid(grid));
    return result;
}

}  // namespace subvol
