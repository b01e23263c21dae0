// SPDX-License-Identifier: Apache-2.0
#include "outputs.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "subvol/detail/atomic_file.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

void check_writable(const std::filesystem::path& folder, const std::string& output) {
    if (::access(folder.c_str(), W_OK | X_OK) == 0) return;
    throw Error(ErrorCode::Io, "cannot be written: " + std::generic_category().message(errno), output);
}

}  // namespace

void check_output(const std::filesystem::path& path, const std::vector<std::string>& extensions) {
    check_choice(path.string(), path.extension().string(), extensions);
    (void)detail::writable_place(path);
}

void make_folder(const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) throw Error(ErrorCode::Io, "the folder cannot be created: " + error.message(), path.string());
    check_writable(path, path.string());
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {  // NOLINT(cppcoreguidelines-pro-type-vararg)
    if (file_ < 0) {
        throw Error(ErrorCode::Io, "the folder cannot be opened: " + std::generic_category().message(errno), folder.string());
    }
    if (flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    close(file_);
    throw Error(ErrorCode::InvalidInput, "another run is writing here", folder.string(), "wait for it, or use another folder");
}

FolderLock::~FolderLock() {
    close(file_);
}

}  // namespace subvol::cli
