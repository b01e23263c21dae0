// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netcdf.h>
#include <netcdf_mem.h>

namespace subvol::detail {

/// The functions of netCDF's library that we use, as the module finds them.
struct NetcdfFunctions {
    decltype(&nc_open_mem) open_mem;
    decltype(&nc_close) close;
    decltype(&nc_strerror) strerror;
    decltype(&nc_get_vara) get_vara;
    decltype(&nc_get_att_text) get_att_text;
    decltype(&nc_inq_nvars) inq_nvars;
    decltype(&nc_inq_ndims) inq_ndims;
    decltype(&nc_inq_dimids) inq_dimids;
    decltype(&nc_inq_dim) inq_dim;
    decltype(&nc_inq_dimlen) inq_dimlen;
    decltype(&nc_inq_var) inq_var;
    decltype(&nc_inq_attname) inq_attname;
    decltype(&nc_inq_att) inq_att;
    decltype(&nc_inq_var_chunking) inq_var_chunking;
    decltype(&nc_inq_var_deflate) inq_var_deflate;
};

}  // namespace subvol::detail
