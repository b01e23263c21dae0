// SPDX-License-Identifier: Apache-2.0
#include "folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "subvol/error.h"

namespace subvol::cli {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {  // NOLINT(cppcoreguidelines-pro-type-vararg)
    if (file_ < 0) {
        throw Error(ErrorCode::Io, "the folder cannot be opened: " + std::generic_category().message(errno), folder.string());
    }
    if (flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    close(file_);
    throw Error(ErrorCode::InvalidInput, "another run is writing here", folder.string(), "wait for it, or take another folder");
}

FolderLock::~FolderLock() {
    close(file_);
}

}  // namespace subvol::cli
