// SPDX-License-Identifier: Apache-2.0
#include "netcdf_source.h"
#include "subvol/error.h"

namespace subvol::detail {

std::unique_ptr<NetcdfSource> open_netcdf4(std::string_view, std::string_view file) {
    throw Error(
        ErrorCode::MissingCapability, "this build cannot read HDF5 files", std::string(file),
        "it needs the netCDF library and the build option SUBVOL_NETCDF; nccopy -6 converts to a format that it can read");
}

}  // namespace subvol::detail
