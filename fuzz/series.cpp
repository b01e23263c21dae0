// SPDX-License-Identifier: Apache-2.0
// The readers of files that list others, beside two good pieces: the first byte says which of the lists the rest is.

#include "case_folder.h"
#include "io/mesh_io/vtu_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

namespace {

std::vector<CaseFile> files() {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
    test::VtuText vtu;
    const std::string one = vtu.file(vtu.piece(mesh, ""));
    for (Vec3& x : mesh.points) x.x += 1;
    test::VtuText other;
    const std::string image =
        "<VTKFile type=\"ImageData\"><ImageData Spacing=\".5 .5 .5\"><Piece Extent=\"0 2 0 2 0 2\"/></ImageData></VTKFile>";
    return {{'1', "1.vtu", one},   {'2', "2.vtu", other.file(other.piece(mesh, ""))},
            {'3', "3.vti", image}, {'d', "a.pvd", ""},
            {'s', "a.series", ""}, {'p', "a.pvtu", ""},
            {'m', "a.vtm", ""},    {'h', "a.vth", ""}};
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static fuzz::CaseFolder folder("series", fuzz::files());
    folder.put(data, size);
    const char letter = size == 0 ? 'd' : static_cast<char>(data[0]);
    return fuzz::run([&] {
        const char* name = letter == 's'   ? "a.series"
                           : letter == 'p' ? "a.pvtu"
                           : letter == 'm' ? "a.vtm"
                           : letter == 'h' ? "a.vth"
                                           : "a.pvd";
        const ReadResult result = read_mesh(folder.path(name));
        static_cast<void>(inspect(result.mesh));
    });
}
