// SPDX-License-Identifier: Apache-2.0
// The reader of OpenFOAM cases: the first byte says which of the files the rest is.

#include "case_folder.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

namespace {

std::string file(const std::string& type, const std::string& rest) {
    return "FoamFile { version 2.0; format ascii; class " + type + "; arch \"LSB;label=32;scalar=64\"; object x; }\n" + rest;
}

// Two cubes beside each other.
std::vector<CaseFile> files() {
    const std::string points =
        "12 ((0 0 0) (1 0 0) (2 0 0) (0 1 0) (1 1 0) (2 1 0) (0 0 1) (1 0 1) (2 0 1) (0 1 1) (1 1 1) (2 1 1))";
    const std::string faces =
        "11 (4(1 4 10 7) 4(0 6 9 3) 4(0 3 4 1) 4(6 7 10 9) 4(0 1 7 6) 4(3 9 10 4) 4(2 5 11 8) 4(1 4 5 2) 4(7 8 11 10) "
        "4(1 2 8 7) 4(4 10 11 5))";
    return {{'p', "constant/polyMesh/points", file("vectorField", points)},
            {'f', "constant/polyMesh/faces", file("faceList", faces)},
            {'o', "constant/polyMesh/owner", file("labelList", "11 (0 0 0 0 0 0 1 1 1 1 1)")},
            {'n', "constant/polyMesh/neighbour", file("labelList", "1 (1)")},
            {'T', "0/T", file("volScalarField", "internalField nonuniform List<scalar> 2 (1 2);\n")},
            {'U', "0/U", file("volVectorField", "internalField uniform (1 2 3);\n")}};
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static fuzz::CaseFolder folder("foam", fuzz::files());
    folder.put(data, size);
    return fuzz::run([&] {
        const ReadResult result = read_mesh(folder.path("."));
        static_cast<void>(inspect(result.mesh));
    });
}
