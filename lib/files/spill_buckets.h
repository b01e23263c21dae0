// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "spill_file.h"

namespace subvol::detail {

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
