// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

#include "subvol/detail/atomic_file.h"

namespace subvol::detail {

/// A file that appears complete or not at all. Every failure, such as a full disk, is an Error(Io) that names the file.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    template <class T>
    void write_values(std::span<const T> values) {
        write({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    }
    /// The number of bytes written so far.
    [[nodiscard]] std::uint64_t position() const;
    /// Overwrites bytes that are already written.
    void overwrite(std::uint64_t position, std::string_view text);
    /// Writes at a place, also beyond the end; the next bytes are written after them.
    void write_at(std::uint64_t position, std::string_view text);
    void seek(std::uint64_t position);
    /// Closes the file; nothing can be written afterwards.
    void close();
    /// Closes the file and gives it its final name.
    void commit(Sync sync = Sync::Now);

private:
    [[noreturn]] void fail(int error) const;

    std::filesystem::path target_;
    AtomicFile file_;
    std::FILE* stream_;
};

}  // namespace subvol::detail
