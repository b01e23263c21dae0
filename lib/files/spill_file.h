// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// A table on disk of records of one length, for what does not fit into memory. Its file has no name, so nothing is left of it
/// however the program ends. Records that were never written are zeros.
///
/// Every failure, such as a full disk, is an Error(Io) that names the folder.
class SpillFile {
public:
    /// folder: in which the file lies. record_bytes: at least 1
    SpillFile(std::filesystem::path folder, std::size_t record_bytes);
    ~SpillFile();
    SpillFile(const SpillFile&) = delete;
    SpillFile& operator=(const SpillFile&) = delete;

    [[nodiscard]] std::size_t record_bytes() const { return record_bytes_; }

    void write(std::uint64_t first, std::span<const char> records);
    void read(std::uint64_t first, std::span<char> records) const;

    /// Records with ascending numbers; neighbours are written and read together.
    void write_some(std::span<const Index> numbers, std::span<const char> records);
    void read_some(std::span<const Index> numbers, std::span<char> records) const;

private:
    [[noreturn]] void fail(const char* what, int error) const;
    void write_bytes(std::uint64_t at, std::span<const char> bytes);
    void read_bytes(std::uint64_t at, std::span<char> bytes) const;

    std::filesystem::path folder_;
    std::size_t record_bytes_;
    int file_ = -1;
};

/// Values as the records that a SpillFile takes.
template <class T>
[[nodiscard]] std::span<const char> records_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
template <class T>
[[nodiscard]] std::span<char> records_of(std::vector<T>& values) {
    return {reinterpret_cast<char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace subvol::detail
