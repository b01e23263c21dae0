// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "subvol/detail/flat_array.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

/// Records sorted by a key whose leading part is a small integer: bucket b is records[offsets[b] .. offsets[b+1]).
template <class Record>
struct Buckets {
    FlatArray<std::size_t> offsets;
    FlatArray<Record> records;
};

/// Sorts the records that emit(i, sink) passes to sink(record) for i in [0, count): into buckets by bucket(record), and within
/// a bucket by operator<.
///
/// emit is called twice for every i and must give the same records both times. All records must differ, so that the result does
/// not depend on the number of threads.
template <class Record, class Emit, class Bucket>
Buckets<Record> bucket_sort(std::size_t count, std::size_t bucket_count, const Emit& emit, const Bucket& bucket) {
    Buckets<Record> result;
    auto& offsets = result.offsets;
    offsets.assign(bucket_count + 1, 0);
    parallel_each(count, [&](std::size_t i) {
        emit(i, [&](const Record& record) {
            std::atomic_ref(offsets[bucket(record) + 1]).fetch_add(1, std::memory_order_relaxed);
        });
    });
    for (std::size_t b = 0; b < bucket_count; ++b) offsets[b + 1] += offsets[b];

    result.records.resize(offsets.back());
    auto next = offsets;
    parallel_each(count, [&](std::size_t i) {
        emit(i, [&](const Record& record) {
            result.records[std::atomic_ref(next[bucket(record)]).fetch_add(1, std::memory_order_relaxed)] = record;
        });
    });
    const auto begin = result.records.begin();
    parallel_each(bucket_count, [&](std::size_t b) {
        std::sort(begin + static_cast<std::ptrdiff_t>(offsets[b]), begin + static_cast<std::ptrdiff_t>(offsets[b + 1]));
    });
    return result;
}

/// The starts of the groups of equal keys in sorted records, plus the end.
template <class Record, class Same>
FlatArray<std::size_t> group_starts(const FlatArray<Record>& records, const Same& same) {
    return numbers_where<FlatArray<std::size_t>>(
        records.size() + 1, [&](std::size_t i) { return i == 0 || i == records.size() || !same(records[i - 1], records[i]); });
}

}  // namespace subvol::detail
