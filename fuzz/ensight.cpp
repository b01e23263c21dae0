// SPDX-License-Identifier: Apache-2.0
// The reader of EnSight cases: the first byte says which of the files the rest is.

#include "case_folder.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

namespace {

const char* const kGeometry =
    "a\nb\nnode id assign\nelement id "
    "assign\npart\n1\np\ncoordinates\n8\n0\n1\n1\n0\n0\n1\n1\n0\n0\n0\n1\n1\n0\n0\n1\n1\n0\n0\n0\n0\n1\n1\n1\n1\n"
    "hexa8\n1\n1 2 3 4 5 6 7 8\n";
const char* const kValues = "T\npart\n1\ncoordinates\n1\n2\n3\n4\n5\n6\n7\n8\n";
const char* const kCase = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: geo\nVARIABLE\nscalar per node: T val\n";

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static fuzz::CaseFolder folder("ensight",
                                   {{'g', "geo", fuzz::kGeometry}, {'v', "val", fuzz::kValues}, {'c', "a.case", fuzz::kCase}});
    folder.put(data, size);
    return fuzz::run([&] {
        const ReadResult result = read_mesh(folder.path("a.case"));
        static_cast<void>(inspect(result.mesh));
    });
}
