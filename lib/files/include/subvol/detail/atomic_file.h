// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "subvol/detail/unfinished_files.h"

namespace subvol::detail {

/// Where a file is written that a user names.
///
/// file:   the name, with symbolic links followed to their end, whether there is a file or not
/// stream: a device, a pipe, or a link to an open file, such as /dev/stdout: it takes bytes, and nothing can replace it
struct OutputPlace {
    std::filesystem::path file;
    bool stream = false;
};

/// throws: Error(Io) if links go round in a circle
[[nodiscard]] OutputPlace output_place(const std::filesystem::path& target);

/// A file that appears complete or not at all: write to `path()`, then `commit()` gives it its final name. Without a commit the
/// destructor removes it. The temporary name keeps the extension, which some libraries use to choose the format.
///
/// A symbolic link stays as it is, as with cp: the file that it points to is replaced, by a temporary file in that file's
/// folder. Other names of that file (hard links) keep the old content. A device or a pipe gets the bytes of the complete file,
/// which is first written to the folder for temporary files: most formats are not written from front to back.
class AtomicFile {
public:
    /// throws: Error(Io) if the folder of the file does not exist, or if it is a folder itself
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }

    /// throws: Error(Io) if the rename fails, or the device or pipe does not take all bytes
    void commit();

private:
    std::filesystem::path target_;
    OutputPlace place_;
    std::filesystem::path temporary_;
    std::optional<UnfinishedFile> unfinished_;
    bool committed_ = false;
};

/// Writes a text to a temporary file, then renames it.
///
/// throws: Error(Io)
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace subvol::detail
