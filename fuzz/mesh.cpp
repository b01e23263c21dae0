// One of the readers of meshes; what it reads has to be valid and fit to be measured.

#include "input.h"
#include "mesh_file.h"
#include "subvol/mesh_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        const subvol::ReadResult read = subvol::SUBVOL_FUZZ_READER(subvol::fuzz::text_of(data, size), "file", {});
        validate(read.mesh);
        static_cast<void>(inspect(read.mesh));
    });
}
