// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/hdf5_file.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostColumns = 1 << 16;

std::size_t columns_of(const Hdf5Dataset& dataset) {
    std::size_t columns = 1;
    for (std::size_t d = 1; d < dataset.lengths.size(); ++d) {
        if (dataset.lengths[d] > kMostColumns / columns) return kMostColumns + 1;
        columns *= dataset.lengths[d];
        if (columns == 0) return 0;
    }
    return columns;
}

std::size_t rows_of(const Hdf5Dataset& dataset) {
    return dataset.lengths.empty() ? 1 : dataset.lengths[0];
}

}  // namespace

Hdf5File::Hdf5File(std::unique_ptr<Hdf5Source> source, std::string file) : source_(std::move(source)), file_(std::move(file)) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file_, none);
    if (!none) there_ = size;
}

// Links may give one dataset any number of names.
void Hdf5File::count_read(const Hdf5Dataset& dataset, std::size_t bytes) const {
    if (met_.insert(dataset.address).second) {
        there_ += std::min(dataset.most_bytes, rows_of(dataset) * columns_of(dataset) * size_of(dataset.type));
    }
    read_ += bytes;
    if (read_ <= NamedFiles::kFewBytes || (read_ - NamedFiles::kFewBytes) / most_times_ <= there_) return;
    fail("what it names again and again is too much", "at most " + std::to_string(most_times_) + " times its bytes are read");
}

Hdf5Dataset Hdf5File::dataset(const std::string& path) const {
    auto found = source_->find(path);
    if (!found || found->characters) fail("there is no dataset of numbers " + in_quotes(path));
    return *std::move(found);
}

std::size_t Hdf5File::rows(const std::string& path) const {
    return rows_of(dataset(path));
}

std::size_t Hdf5File::columns(const std::string& path) const {
    const std::size_t columns = columns_of(dataset(path));
    if (columns > kMostColumns) fail(in_quotes(path) + " has too many columns", "at most " + std::to_string(kMostColumns));
    return columns;
}

std::string Hdf5File::bytes(const std::string& path, const Hdf5Dataset& dataset, std::size_t first, std::size_t count) const {
    const std::size_t rows = rows_of(dataset);
    if (first > rows || count > rows - first) {
        fail(in_quotes(path) + " has " + counted(rows, "row", "rows") + "; " + std::to_string(count) + " from row " +
             std::to_string(first) + " on are needed");
    }
    if (columns_of(dataset) > kMostColumns) fail(in_quotes(path) + " has fewer values than its size says");
    std::vector<std::size_t> starts(dataset.lengths.size()), counts = dataset.lengths;
    if (!starts.empty()) {
        starts[0] = first;
        counts[0] = count;
    }
    return block(path, dataset, starts, counts);
}

std::string Hdf5File::block(const std::string& path, const Hdf5Dataset& dataset, std::span<const std::size_t> starts,
                            std::span<const std::size_t> counts) const {
    constexpr std::size_t kFew = 1 << 20;  // values that are not stored have a default
    constexpr std::size_t kLargeChunk = std::size_t{64} << 20, kMostWasted = 16;
    const std::size_t most = std::max(kFew, dataset.most_bytes);
    std::size_t needed = size_of(dataset.type);
    if (std::find(counts.begin(), counts.end(), 0) != counts.end()) return {};
    for (const std::size_t count : counts) {
        if (count > most / needed) fail(in_quotes(path) + " has fewer values than its size says");
        needed *= count;
    }
    if (dataset.compressed_chunk > kLargeChunk && dataset.compressed_chunk / kMostWasted > needed) {
        fail(in_quotes(path) + " has chunks of " + std::to_string(dataset.compressed_chunk) + " bytes, of which " +
                 std::to_string(needed) + " are needed",
             "smaller chunks, as h5repack makes them");
    }
    count_read(dataset, needed);
    auto bytes = source_->values(path, dataset, starts, counts);
    if (!bytes || bytes->size() != needed) fail(in_quotes(path) + " cannot be read: the file is damaged");
    return *std::move(bytes);
}

std::vector<double> Hdf5File::reals(const std::string& path, std::size_t first, std::size_t count) const {
    const Hdf5Dataset found = dataset(path);
    return reals_from(bytes(path, found, first, count), found.type, std::endian::native);
}

std::vector<std::int64_t> Hdf5File::integers(const std::string& path, std::size_t first, std::size_t count) const {
    const Hdf5Dataset found = dataset(path);
    if (!is_integer(found.type)) fail(in_quotes(path) + " does not consist of integers");
    return integers_from(bytes(path, found, first, count), found.type, std::endian::native);
}

void Hdf5File::fail(const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, message, file_, allowed);
}

}  // namespace subvol::detail
