// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

#include "subvol/detail/atomic_file.h"

namespace subvol::detail {

/// A file to be written whole or not at all. Every failure, a full disk too, is an Error(Io) that names the file.
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
    /// How many bytes are written: where the next one goes.
    [[nodiscard]] std::uint64_t position() const;
    /// Writes over what stands at a position already.
    void overwrite(std::uint64_t position, std::string_view text);
    /// Flushes; nothing can be written after that.
    void close();
    /// Closes and gives the file its name.
    void commit();

private:
    [[noreturn]] void fail(int error) const;

    std::filesystem::path target_;
    AtomicFile file_;
    std::FILE* stream_;
};

}  // namespace subvol::detail
