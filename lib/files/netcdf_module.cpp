// SPDX-License-Identifier: Apache-2.0
// The module subvol_netcdf.so. netCDF brings 35 libraries: HDF5, and others to fetch files from the network.
#include "netcdf_functions.h"
#include "subvol/version.h"

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::NetcdfFunctions* subvol_netcdf() {
    static const subvol::detail::NetcdfFunctions functions{
        .open_mem = &nc_open_mem,
        .close = &nc_close,
        .strerror = &nc_strerror,
        .get_vara = &nc_get_vara,
        .get_att_text = &nc_get_att_text,
        .inq_nvars = &nc_inq_nvars,
        .inq_ndims = &nc_inq_ndims,
        .inq_dimids = &nc_inq_dimids,
        .inq_dim = &nc_inq_dim,
        .inq_dimlen = &nc_inq_dimlen,
        .inq_var = &nc_inq_var,
        .inq_attname = &nc_inq_attname,
        .inq_att = &nc_inq_att,
        .inq_var_chunking = &nc_inq_var_chunking,
        .inq_var_deflate = &nc_inq_var_deflate,
    };
    return &functions;
}
}
