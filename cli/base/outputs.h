// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace subvol::cli {

/// Checks an output before any work is done for it: the file name ends in one of `extensions`; the folder of the file, or of
/// the one that it links to, exists and is writable, and so is the file, if there is one.
///
/// throws: Error(InvalidInput), Error(Io)
void check_output(const std::filesystem::path& path, const std::vector<std::string>& extensions);

/// Creates a folder for outputs, and those above it, unless they exist.
///
/// throws: Error(Io) if it cannot be created or is not writable
void make_folder(const std::filesystem::path& path);

/// Keeps other runs of this program out of a folder while it exists, at most as long as the process. Writes nothing. Where the
/// file system has no locks, it keeps nobody out.
class FolderLock {
public:
    /// throws: Error(InvalidInput) if another run holds the lock, Error(Io) if the folder cannot be opened
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int file_;
};

}  // namespace subvol::cli
