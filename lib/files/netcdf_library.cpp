// SPDX-License-Identifier: Apache-2.0
#include "netcdf_source.h"
#include "subvol/error.h"

#ifdef SUBVOL_FOREIGN_NETCDF

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "hdf5_file.h"
#include "netcdf_functions.h"
#include "subvol/detail/module.h"

namespace subvol::detail {

namespace {

const NetcdfFunctions& library() {
    using Entry = const NetcdfFunctions* (*)();
    static const NetcdfFunctions& functions = *reinterpret_cast<Entry>(load_module("netcdf", "reading files of HDF5"))();
    return functions;
}

constexpr std::size_t kMostOfDeflate = 1040;  // 1032, and some bytes for the blocks

constexpr std::array<std::pair<nc_type, NumberType>, 11> kTypes{{{NC_BYTE, NumberType::Int8},
                                                                 {NC_CHAR, NumberType::UInt8},
                                                                 {NC_SHORT, NumberType::Int16},
                                                                 {NC_INT, NumberType::Int32},
                                                                 {NC_FLOAT, NumberType::Float32},
                                                                 {NC_DOUBLE, NumberType::Float64},
                                                                 {NC_UBYTE, NumberType::UInt8},
                                                                 {NC_USHORT, NumberType::UInt16},
                                                                 {NC_UINT, NumberType::UInt32},
                                                                 {NC_INT64, NumberType::Int64},
                                                                 {NC_UINT64, NumberType::UInt64}}};

class Netcdf4 : public NetcdfSource {
public:
    Netcdf4(std::string_view bytes, std::string_view file) : lock_(hdf5_mutex()), file_(file) {
        // The library takes a pointer to non-const, but does not change a file that is opened for reading.
        void* memory = const_cast<char*>(bytes.data());
        check(library().open_mem(std::string(file).c_str(), NC_NOWRITE, bytes.size(), memory, &id_));
        try {
            read_catalog();
        } catch (...) {
            library().close(id_);
            throw;
        }
    }
    ~Netcdf4() override { library().close(id_); }
    Netcdf4(const Netcdf4&) = delete;
    Netcdf4& operator=(const Netcdf4&) = delete;

    [[nodiscard]] std::string values(const NetcdfVariable& variable, std::span<const std::size_t> places) const override {
        std::vector<std::size_t> start(variable.lengths.size()), counts = variable.lengths;
        std::size_t count = size_of(variable.type);
        for (std::size_t d = 0; d < counts.size(); ++d) {
            if (d < places.size()) {
                start[d] = places[d];
                counts[d] = 1;
            }
            count *= counts[d];
        }
        if (count == 0) return {};
        check_chunks(variable, count);
        std::string bytes(count, '\0');
        check(library().get_vara(id_, variable.number, start.data(), counts.data(), bytes.data()));
        return bytes;
    }

    [[nodiscard]] std::size_t growth() const override { return kMostOfDeflate; }

private:
    /// Whole chunks are decompressed, however few of their values are needed.
    void check_chunks(const NetcdfVariable& variable, std::size_t needed) const {
        constexpr std::size_t kLargeChunk = std::size_t{64} << 20, kMostWasted = 16;
        int storage = NC_CONTIGUOUS, shuffled = 0, deflated = 0, level = 0;
        std::vector<std::size_t> lengths(std::max<std::size_t>(1, variable.lengths.size()));
        check(library().inq_var_chunking(id_, variable.number, &storage, lengths.data()));
        check(library().inq_var_deflate(id_, variable.number, &shuffled, &deflated, &level));
        if (storage != NC_CHUNKED) return;
        std::size_t chunk = size_of(variable.type);
        for (const std::size_t length : lengths) chunk *= length;  // below 2^32, as HDF5 demands
        if (deflated == 0 || chunk <= kLargeChunk || chunk / kMostWasted <= needed) return;
        throw Error(ErrorCode::InvalidInput,
                    "has chunks of " + std::to_string(chunk) + " bytes, of which " + std::to_string(needed) + " are needed",
                    std::string(file_), "smaller chunks, as nccopy -c makes them");
    }

    void read_catalog() {
        int count = 0;
        check(library().inq_nvars(id_, &count));
        for (int number = 0; number < count; ++number) read_variable(number);
        check(library().inq_ndims(id_, &count));
        std::vector<int> ids(static_cast<std::size_t>(count));
        check(library().inq_dimids(id_, &count, ids.data(), 0));
        for (const int dimension : ids) {
            std::array<char, NC_MAX_NAME + 1> name{};
            std::size_t length = 0;
            check(library().inq_dim(id_, dimension, name.data(), &length));
            dimensions.emplace(name.data(), length);
        }
    }

    // Reads a variable; those of user-defined types are left out.
    void read_variable(int number) {
        std::array<char, NC_MAX_NAME + 1> name{};
        nc_type type = NC_NAT;
        int rank = 0, attributes = 0;
        std::array<int, NC_MAX_VAR_DIMS> ids{};
        check(library().inq_var(id_, number, name.data(), &type, &rank, ids.data(), &attributes));
        const auto known = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& pair) { return pair.first == type; });
        if (known == kTypes.end()) return;
        NetcdfVariable variable{.type = known->second, .characters = type == NC_CHAR, .number = number};
        for (int d = 0; d < rank; ++d) {
            check(library().inq_dimlen(id_, ids[static_cast<std::size_t>(d)], &variable.lengths.emplace_back()));
        }
        for (int a = 0; a < attributes; ++a) read_attribute(variable, a);
        variables.emplace(name.data(), std::move(variable));
    }

    void read_attribute(NetcdfVariable& variable, int number) const {
        std::array<char, NC_MAX_NAME + 1> name{};
        nc_type type = NC_NAT;
        std::size_t length = 0;
        constexpr std::size_t kLongest = 1 << 16;  // HDF5's own limit
        check(library().inq_attname(id_, variable.number, number, name.data()));
        check(library().inq_att(id_, variable.number, name.data(), &type, &length));
        if (type != NC_CHAR || length > kLongest) return;
        std::string text(length, '\0');
        check(library().get_att_text(id_, variable.number, name.data(), text.data()));
        variable.texts.emplace(name.data(), text);
    }

    void check(int status) const {
        if (status == NC_NOERR) return;
        throw Error(ErrorCode::InvalidInput, "cannot be read: " + std::string(library().strerror(status)), std::string(file_));
    }

    std::scoped_lock<std::mutex> lock_;
    std::string_view file_;
    int id_ = -1;
};

}  // namespace

std::unique_ptr<NetcdfSource> open_netcdf4(std::string_view bytes, std::string_view file) {
    return std::make_unique<Netcdf4>(bytes, file);
}

}  // namespace subvol::detail

#else

namespace subvol::detail {

std::unique_ptr<NetcdfSource> open_netcdf4(std::string_view, std::string_view file) {
    throw Error(
        ErrorCode::MissingCapability, "this build cannot read HDF5 files", std::string(file),
        "it needs the netCDF library and the build option SUBVOL_NETCDF; nccopy -6 converts to a format that it can read");
}

}  // namespace subvol::detail

#endif
