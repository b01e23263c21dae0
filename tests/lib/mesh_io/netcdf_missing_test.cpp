// SPDX-License-Identifier: Apache-2.0
// A build without netCDF's library.

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace netcdf_missing_test {

using NetcdfMissing = TempFolder;

TEST_F(NetcdfMissing, IsSaidOfFilesOfHdf5) {
    for (const std::string name : {"a.e", "a.exo", "a.ex2", "a.g"}) {
        const auto file = write(name, "\x89HDF\r\n");
        EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(file)); }, ErrorCode::MissingCapability),
                    testing::HasSubstr(name + ": this build cannot read HDF5 files"));
    }
}

}  // namespace netcdf_missing_test

}  // namespace subvol::test
