// SPDX-License-Identifier: Apache-2.0
// The reader of EnSight cases: the first byte says which of the files the rest is.

#include "ensight/ensight_io.h"

#include <unistd.h>

#include "input.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

namespace {

const std::string kGeometry =
    "a\nb\nnode id assign\nelement id "
    "assign\npart\n1\np\ncoordinates\n8\n0\n1\n1\n0\n0\n1\n1\n0\n0\n0\n1\n1\n0\n0\n1\n1\n0\n0\n0\n0\n1\n1\n1\n1\n"
    "hexa8\n1\n1 2 3 4 5 6 7 8\n";
const std::string kValues = "T\npart\n1\ncoordinates\n1\n2\n3\n4\n5\n6\n7\n8\n";
const std::string kCase = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: geo\nVARIABLE\nscalar per node: T val\n";

std::filesystem::path folder() {
    static const std::filesystem::path path = [] {
        auto made = std::filesystem::temp_directory_path() / ("fuzz_ensight_" + std::to_string(::getpid()));
        std::filesystem::create_directories(made);
        return made;
    }();
    return path;
}

void write(const char* name, std::string_view text) {
    std::ofstream(folder() / name, std::ios::binary) << text;
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    if (size == 0) return 0;
    const std::string_view rest = fuzz::text_of(data + 1, size - 1);
    fuzz::write("geo", data[0] == 'g' ? rest : fuzz::kGeometry);
    fuzz::write("val", data[0] == 'v' ? rest : fuzz::kValues);
    fuzz::write("a.case", data[0] == 'c' ? rest : fuzz::kCase);
    return fuzz::run([&] {
        const ReadResult result = detail::read_ensight(fuzz::folder() / "a.case", {});
        validate(result.mesh);
        static_cast<void>(inspect(result.mesh));
    });
}
