// SPDX-License-Identifier: Apache-2.0
// A build without HDF5's library.

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace hdf5_missing_test {

using Hdf5Missing = TempFolder;

TEST_F(Hdf5Missing, IsSaid) {
    std::vector<std::string> names{"a.vtkhdf"};
#ifdef SUBVOL_SOLVERS
    names.insert(names.end(), {"a.e", "a.exo", "a.ex2", "a.g"});
#endif
    for (const std::string& name : names) {
        const auto file = write(name, "\x89HDF\r\n\x1a\n");
        EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(file)); }, ErrorCode::MissingCapability),
                    testing::HasSubstr(name + ": this build cannot read HDF5 files"));
    }
}

}  // namespace hdf5_missing_test

}  // namespace subvol::test
