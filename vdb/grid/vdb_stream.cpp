// SPDX-License-Identifier: Apache-2.0
#include "vdb_stream.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>
#include "openvdb_grids.h"

#include <fstream>
#include <optional>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

// OpenVDB's own File continues after a short read with memory that was never filled; a stream that throws stops it.
template <class Read>
auto read_throwing(const std::filesystem::path& path, const Read& read) {
    std::ifstream file(path, std::ios::binary);
    if (!file || std::filesystem::is_directory(path)) throw Error(ErrorCode::Io, "cannot be read", path.string());
    file.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    try {
        openvdb::initialize();
        return read(file);
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::InvalidInput, "is not a whole OpenVDB file: it ends too early", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::InvalidInput, std::string("is not a whole OpenVDB file: ") + error.what(), path.string());
    }
}

/// Reads the descriptions of a file's grids only; nothing if the file does not store their positions.
class DescriptionReader : public openvdb::io::Archive {
public:
    std::optional<std::vector<std::string>> types(std::istream& file) {
        openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata);
        openvdb::io::setStreamMetadataPtr(file, metadata, /*transfer=*/false);
        if (!readHeader(file)) return std::nullopt;
        openvdb::io::setVersion(file, libraryVersion(), fileVersion());
        openvdb::MetaMap().readMeta(file);
        std::vector<std::string> types;
        for (std::int32_t left = readGridCount(file); left > 0; --left) {
            openvdb::io::GridDescriptor description;
            static_cast<void>(description.read(file));
            types.push_back(description.gridType());
            if (description.getEndPos() <= file.tellg()) OPENVDB_THROW(openvdb::IoError, "a grid ends before it begins");
            description.seekToEnd(file);
        }
        return types;
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

}  // namespace

openvdb::GridPtrVecPtr read_grids(const std::filesystem::path& path) {
    return read_throwing(path, [](std::istream& file) { return openvdb::io::Stream(file, /*delayLoad=*/false).getGrids(); });
}

std::vector<std::string> grid_types(const std::filesystem::path& path) {
    if (auto types = read_throwing(path, [](std::istream& file) { return DescriptionReader().types(file); })) return *types;
    std::vector<std::string> types;
    for (const auto& grid : *read_grids(path)) types.push_back(grid->type());
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
