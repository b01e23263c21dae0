// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace subvol::detail {

/// A file that appears complete or not at all: write to `path()`, then `commit()` renames it to its final name. Without a
/// commit the destructor removes it. The temporary name keeps the extension, which some libraries use to choose the format.
class AtomicFile {
public:
    /// throws: Error(Io) if the folder of `target` does not exist
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }

    /// throws: Error(Io) if the rename fails
    void commit();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

/// Writes a text to a temporary file, then renames it.
///
/// throws: Error(Io)
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace subvol::detail
