// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace subvol::detail {

/// Remembers a temporary file while it exists, so that a program that must end at once can remove it.
///
/// with_folder: its folder was made for it alone
class UnfinishedFile {
public:
    UnfinishedFile(const std::filesystem::path& file, bool with_folder);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

    struct Place;

private:
    Place* place_ = nullptr;  // null: there are thousands already, or the name is too long
};

/// Removes all files that are remembered. May be called by a signal's handler; the program should end after it.
void remove_unfinished_files() noexcept;

/// Makes `remove_unfinished_files` call another one: that of a module, which has its own copy of this library and its own
/// files.
void remove_unfinished_files_of(void (*module)() noexcept);

}  // namespace subvol::detail
