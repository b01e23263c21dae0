// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "number_type.h"

namespace subvol::detail {

/// A variable of a netCDF file: a block of numbers or of characters.
///
/// lengths: of its dimensions, the slowest first
/// texts:   its text attributes
/// begin:   in a classic file the byte at which its values begin; for a record variable those of the first record
/// number:  its number in the netCDF library
struct NetcdfVariable {
    NumberType type = NumberType::Int8;
    bool characters = false;
    bool record = false;
    std::vector<std::size_t> lengths{};
    std::map<std::string, std::string> texts{};
    std::size_t begin = 0;
    int number = 0;
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
    [[nodiscard]] virtual std::string values(const NetcdfVariable& variable, std::span<const std::size_t> places) const = 0;

    /// The largest number of bytes of values that one byte of the file can decompress to.
    [[nodiscard]] virtual std::size_t growth() const = 0;
};

/// A file of the classic format: CDF-1, CDF-2 or CDF-5. bytes, file: must outlive it
[[nodiscard]] std::unique_ptr<NetcdfSource> open_classic_netcdf(std::string_view bytes, std::string_view file);

/// A netCDF-4 file, which is HDF5, by the netCDF library.
///
/// throws: Error(MissingCapability) if the build has no netCDF library
[[nodiscard]] std::unique_ptr<NetcdfSource> open_netcdf4(std::string_view bytes, std::string_view file);

}  // namespace subvol::detail
