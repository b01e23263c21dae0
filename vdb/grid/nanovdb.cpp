// SPDX-License-Identifier: Apache-2.0
#include "subvol/nanovdb.h"

#include "subvol/detail/printable.h"
#include "subvol/error.h"

#ifndef SUBVOL_NANOVDB

namespace subvol {

bool has_nanovdb() {
    return false;
}

void write_nanovdb(const std::filesystem::path&, std::span<const VdbGrid>) {
    throw Error(ErrorCode::MissingCapability, "this build has no NanoVDB", {},
                "configure again where libnanovdb-dev is installed");
}

}  // namespace subvol

#else

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <fstream>
#include <vector>

#include "subvol/detail/atomic_file.h"
#include "vdb_data.h"

namespace subvol {

namespace {

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

// One type at a time: NanoVDB's conversion of any grid takes minutes to compile.
Handle convert(const openvdb::GridBase& grid) {
    if (const auto* floats = dynamic_cast<const openvdb::FloatGrid*>(&grid)) return nanovdb::openToNanoVDB(*floats);
    if (const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(&grid)) return nanovdb::openToNanoVDB(*vectors);
    if (const auto* integers = dynamic_cast<const openvdb::Int32Grid*>(&grid)) return nanovdb::openToNanoVDB(*integers);
    if (const auto* mask = dynamic_cast<const openvdb::MaskGrid*>(&grid)) return nanovdb::openToNanoVDB(*mask);
    throw Error(ErrorCode::InvalidInput, "has voxels of type " + grid.valueType(), "grid " + detail::in_quotes(grid.getName()),
                "floats, vectors of floats, integers or a mask");
}

}  // namespace

bool has_nanovdb() {
    return true;
}

void write_nanovdb(const std::filesystem::path& path, std::span<const VdbGrid> grids) {
    detail::AtomicFile file(path);
    try {
        std::vector<Handle> handles;
        for (const VdbGrid& grid : grids) handles.push_back(convert(*detail::VdbData::of(grid).grid));
        std::ofstream out;
        out.exceptions(std::ios::failbit | std::ios::badbit);
        out.open(file.path(), std::ios::binary);
        nanovdb::io::writeGrids(out, handles, nanovdb::io::Codec::NONE);
        out.close();
    } catch (const Error&) {
        throw;
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::Io, "cannot be written; the disk may be full", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::Io, std::string("cannot be written: ") + error.what(), path.string());
    }
    file.commit();
}

}  // namespace subvol

#endif
