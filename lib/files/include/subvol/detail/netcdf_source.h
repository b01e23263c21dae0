// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/number_type.h"

namespace subvol::detail {

/// A variable of a netCDF file: a block of numbers or of characters.
struct NetcdfVariable {
    NumberType type = NumberType::Int8;
    bool characters = false;
    bool record = false;                 ///< the first dimension is the unlimited one
    std::vector<std::size_t> lengths{};  ///< lengths of its dimensions, the slowest first
    /// In a classic file the byte at which its values begin; for a record variable those of the first record
    std::size_t begin = 0;
};

/// An open netCDF file.
class NetcdfSource {
public:
    virtual ~NetcdfSource() = default;

    /// Dimensions with their lengths, and variables, by name.
    std::map<std::string, std::size_t, std::less<>> dimensions;
    std::map<std::string, NetcdfVariable, std::less<>> variables;

    /// The bytes of the values at given places along the first dimensions and at all places along the others, in this machine's
    /// byte order. For a record variable at least one place is given. The caller has checked that the places exist and that the
    /// file can have that many values.
    ///
    /// throws: Error(InvalidInput) if the file is too short or damaged there
    [[nodiscard]] virtual std::string values(const std::string& variable, std::span<const std::size_t> places) const = 0;

    /// A text attribute of a variable; empty if there is none.
    [[nodiscard]] virtual std::string attribute(const std::string& variable, const std::string& name) const = 0;

    /// The largest number of bytes of values that one byte of the file can decompress to.
    [[nodiscard]] virtual std::size_t growth() const = 0;
};

/// A file of the classic format: CDF-1, CDF-2 or CDF-5. bytes, file: must outlive it
[[nodiscard]] std::unique_ptr<NetcdfSource> open_classic_netcdf(std::string_view bytes, std::string_view file);

/// A netCDF-4 file, which is an HDF5 file with a dataset for each variable and each dimension.
///
/// throws: as `open_hdf5`
[[nodiscard]] std::unique_ptr<NetcdfSource> open_netcdf4(const std::filesystem::path& path);

}  // namespace subvol::detail
