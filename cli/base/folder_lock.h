// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace subvol::cli {

/// Keeps other runs of this program out of a folder for as long as it lives, or the process does. Nothing is written. Where the
/// file system knows no locks, nobody is kept out.
class FolderLock {
public:
    /// throws: Error(InvalidInput) if another run has it, Error(Io) if it cannot be opened
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int file_;
};

}  // namespace subvol::cli
