// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
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

/// Records that are put into buckets and read back one bucket at a time: what is sorted or joined outside memory.
template <class Record>
class SpillBuckets {
public:
    /// folder: as of SpillFile. buckets: at least 1; each waits with some 1000 records in memory
    SpillBuckets(std::filesystem::path folder, std::size_t buckets)
        : file_(std::move(folder), sizeof(Record)), waiting_(buckets), parts_(buckets) {}

    [[nodiscard]] std::size_t size() const { return parts_.size(); }

    void add(std::size_t bucket, const Record& record) {
        waiting_[bucket].push_back(record);
        if (waiting_[bucket].size() == kWaiting) flush(bucket);
    }

    /// All records of a bucket, in the order in which they were added.
    [[nodiscard]] std::vector<Record> take(std::size_t bucket) {
        std::vector<Record> records;
        std::size_t count = waiting_[bucket].size();
        for (const auto& [first, size] : parts_[bucket]) count += size;
        records.reserve(count);
        for (const auto& [first, size] : parts_[bucket]) {
            const std::size_t before = records.size();
            records.resize(before + size);
            file_.read(first, records_of(records).subspan(before * sizeof(Record)));
        }
        records.insert(records.end(), waiting_[bucket].begin(), waiting_[bucket].end());
        waiting_[bucket] = {};
        parts_[bucket] = {};
        return records;
    }

private:
    static constexpr std::size_t kWaiting = 1024;  // records of a bucket

    void flush(std::size_t bucket) {
        file_.write(written_, records_of(waiting_[bucket]));
        parts_[bucket].emplace_back(written_, waiting_[bucket].size());
        written_ += waiting_[bucket].size();
        waiting_[bucket].clear();
    }

    SpillFile file_;
    std::uint64_t written_ = 0;
    std::vector<std::vector<Record>> waiting_;
    std::vector<std::vector<std::pair<std::uint64_t, std::size_t>>> parts_;  // of each bucket: first record and count
};

}  // namespace subvol::detail
