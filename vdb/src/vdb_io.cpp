#include <openvdb/io/Archive.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <fstream>

#include "subvol/atomic_file.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

namespace {

// OpenVDB's own opening of files goes on after a short read and then trusts what it has not read; a stream that throws does
// not.
openvdb::GridPtrVecPtr read_grids(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file || std::filesystem::is_directory(path)) throw Error(ErrorCode::Io, "cannot be read", path.string());
    file.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    try {
        openvdb::initialize();
        return openvdb::io::Stream(file, /*delayLoad=*/false).getGrids();
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::InvalidInput, "is not a whole OpenVDB file: it ends too early", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::InvalidInput, std::string("is not a whole OpenVDB file: ") + error.what(), path.string());
    }
}

// io::File, which would be the usual way, does not notice a full disk: the stream has to be ours here too.
class ThrowingWriter : public openvdb::io::Archive {
public:
    void write_grids(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids) {
        std::ofstream file;
        file.exceptions(std::ios::failbit | std::ios::badbit);
        file.open(path, std::ios::binary);
        setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
        write(file, grids, /*seekable=*/true);
        file.close();
    }
};

}  // namespace

void write_vdb(const std::filesystem::path& path, std::span<const VdbGrid> grids) {
    AtomicFile file(path);
    try {
        openvdb::initialize();
        openvdb::GridCPtrVec written;
        for (const auto& grid : grids) written.push_back(grid.data().grid);
        ThrowingWriter().write_grids(file.path(), written);
    } catch (const std::ios_base::failure&) {
        throw Error(ErrorCode::Io, "cannot be written; the disk may be full", path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::Io, std::string("cannot be written: ") + error.what(), path.string());
    }
    file.commit();
}

std::vector<VdbGrid> read_vdb(const std::filesystem::path& path) {
    const auto grids = read_grids(path);
    std::vector<VdbGrid> result;
    std::string others;
    for (const auto& grid : *grids) {
        if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) {
            result.push_back(make_vdb_grid(std::move(floats)));
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
