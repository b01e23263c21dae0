// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

/// Tests of what is read from texts.
class MeshFiles : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& name, const std::string& text, const ReadOptions& options = {}) const {
        return read_mesh(write(name, text), options);
    }

    [[nodiscard]] std::string read_error(const std::string& name, const std::string& text) const {
        return error_of([&] { static_cast<void>(read(name, text)); });
    }
};

inline void expect_same_geometry(const HexMesh& a, const HexMesh& b) {
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.cells, b.cells);
}

}  // namespace subvol::test
