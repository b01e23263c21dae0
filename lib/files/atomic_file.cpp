// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/atomic_file.h"

#include <unistd.h>

#include <system_error>

#include "subvol/error.h"

namespace subvol::detail {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + folder.string() + "\" does not exist", target_.string());
    }
    if (fs::is_directory(target_, error)) throw Error(ErrorCode::Io, "is a folder; a file name is needed", target_.string());
    temporary_ = folder / ("." + target_.stem().string() + "." + std::to_string(::getpid()) + target_.extension().string());
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) throw Error(ErrorCode::Io, "cannot be written: " + error.message(), target_.string());
    committed_ = true;
}

}  // namespace subvol::detail
