// SPDX-License-Identifier: Apache-2.0
#include "vdb_stream.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <algorithm>
#include <fstream>
#include <span>

#include "openvdb_grids.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/vdb_file.h"
#include "subvol/error.h"
#include "vdb_check.h"
#include "vdb_data.h"

namespace subvol::detail {

namespace {

/// Reads grids of a file that has been checked, where the check found them.
class CheckedReader : public openvdb::io::Archive {
public:
    openvdb::GridPtrVec read(std::istream& file, std::span<const GridEntry> entries) {
        openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata);
        openvdb::io::setStreamMetadataPtr(file, metadata, /*transfer=*/false);
        readHeader(file);
        openvdb::io::setVersion(file, libraryVersion(), fileVersion());
        std::vector<openvdb::io::GridDescriptor> descriptions;
        openvdb::GridPtrVec grids;
        NamedGridMap by_name;
        for (const GridEntry& entry : entries) {
            file.seekg(static_cast<std::streamoff>(entry.begin));
            openvdb::io::GridDescriptor& description = descriptions.emplace_back();
            grids.push_back(description.read(file));
            readGrid(grids.back(), description, file);
            by_name[description.uniqueName()] = grids.back();
        }
        for (const auto& description : descriptions) connectInstance(description, by_name);
        return grids;
    }
};

// io::File, the usual way, does not notice a full disk; a stream that throws does.
class ThrowingWriter : public openvdb::io::Archive {
public:
    void write_grids(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, std::uint32_t compression) {
        std::ofstream file;
        file.exceptions(std::ios::failbit | std::ios::badbit);
        file.open(path, std::ios::binary);
        setCompression(compression | openvdb::io::COMPRESS_ACTIVE_MASK);
        write(file, grids, /*seekable=*/true);
        file.close();
    }
};

std::uint32_t flag_of(VdbCompression compression) {
    using openvdb::io::Archive;
    switch (compression) {
        case VdbCompression::Blosc:
            if (Archive::hasBloscCompression()) return openvdb::io::COMPRESS_BLOSC;
            throw Error(ErrorCode::MissingCapability, "OpenVDB was built without blosc", {}, "zip or none");
        case VdbCompression::Zip:
            if (Archive::hasZLibCompression()) return openvdb::io::COMPRESS_ZIP;
            throw Error(ErrorCode::MissingCapability, "OpenVDB was built without zip", {}, "blosc or none");
        default:
            return openvdb::io::COMPRESS_NONE;
    }
}

openvdb::GridPtrVec read_entries(const std::filesystem::path& path, std::span<const GridEntry> entries) {
    std::ifstream file(path, std::ios::binary);
    // OpenVDB continues after a short read with memory that was never filled; a stream that throws stops it.
    file.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    try {
        return CheckedReader().read(file, entries);
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::InvalidInput, "is not a whole OpenVDB file: it ends too early", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::InvalidInput, "is not a whole OpenVDB file: " + printable(error.what()), path.string());
    }
}

}  // namespace

openvdb::GridPtrVec read_grids(const std::filesystem::path& path, std::span<const std::string> types,
                               const std::function<void(const std::string&, const std::string&)>& other) {
    std::vector<GridEntry> entries = checked_grids(path, types);
    std::erase_if(entries, [&](const GridEntry& entry) {
        if (std::ranges::find(types, entry.type) != types.end()) return false;
        other(entry.name, entry.type);
        return true;
    });
    return read_entries(path, entries);
}

openvdb::GridPtrVec read_grids(const std::filesystem::path& path, const std::string& type, const std::string& what) {
    std::vector<GridEntry> entries = checked_grids(path, std::span(&type, 1));
    std::vector<std::string> others;
    for (const GridEntry& entry : entries) {
        if (entry.type != type) others.push_back(entry.type);
    }
    std::erase_if(entries, [&](const GridEntry& entry) { return entry.type != type; });
    if (entries.empty()) {
        throw Error(ErrorCode::InvalidInput, "holds no " + what, path.string(),
                    others.empty() ? "" : "it holds: " + listed(others));
    }
    return read_entries(path, entries);
}

std::vector<std::string> grid_types(const std::filesystem::path& path) {
    std::vector<std::string> types;
    for (GridEntry& entry : checked_grids(path, {})) types.push_back(std::move(entry.type));
    return types;
}

void write_grids(const AtomicFile& file, const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                 VdbCompression compression) {
    const std::uint32_t flag = flag_of(compression);
    try {
        openvdb::initialize();
        ThrowingWriter().write_grids(file.path(), grids, flag);
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::Io, "cannot be written; the disk may be full", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::Io, std::string("cannot be written: ") + error.what(), path.string());
    }
}

}  // namespace subvol::detail

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
