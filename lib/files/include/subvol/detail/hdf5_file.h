// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "subvol/detail/atomic_file.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/number_type.h"

namespace subvol::detail {

/// A dataset of an HDF5 file.
struct Hdf5Dataset {
    NumberType type = NumberType::Float64;
    std::vector<std::size_t> lengths;  ///< lengths of its dimensions, the slowest first
    std::size_t most_bytes = 0;        ///< the most bytes of values that its storage can have
    std::size_t compressed_chunk = 0;  ///< bytes that are decompressed together, 0 if nothing is compressed
    std::uint64_t address = 0;         ///< the same by all names of the dataset
    bool characters = false;           ///< it consists of characters instead of numbers
    bool grows = false;                ///< its first dimension is unlimited
};

/// An open HDF5 file. Paths are those inside of it, such as "/VTKHDF/Points".
class Hdf5Source {
public:
    virtual ~Hdf5Source() = default;

    /// The names in a group, in order; none if there is no such group.
    [[nodiscard]] virtual std::vector<std::string> names(const std::string& group) const = 0;
    /// Nothing if there is no such dataset, or it consists neither of numbers nor of single characters.
    [[nodiscard]] virtual std::optional<Hdf5Dataset> find(const std::string& path) const = 0;
    /// The bytes of a block of values, in this machine's byte order. starts, counts: along each dimension, checked by the
    /// caller
    ///
    /// returns: nothing if the file is damaged there
    [[nodiscard]] virtual std::optional<std::string> values(const std::string& path, const Hdf5Dataset& dataset,
                                                            std::span<const std::size_t> starts,
                                                            std::span<const std::size_t> counts) const = 0;
    [[nodiscard]] virtual std::optional<std::string> text(const std::string& object, const std::string& attribute) const = 0;
    [[nodiscard]] virtual std::vector<std::int64_t> integers(const std::string& object, const std::string& attribute) const = 0;
    /// The numbers of an attribute, of any type; none if it has others, or too many.
    [[nodiscard]] virtual std::vector<double> reals(const std::string& object, const std::string& attribute) const = 0;
};

/// throws: Error(Io) if the file cannot be opened, Error(InvalidInput) if it is not an HDF5 file, Error(MissingCapability) if
///         the build has no HDF5 library
[[nodiscard]] std::unique_ptr<Hdf5Source> open_hdf5(const std::filesystem::path& path);

/// A new HDF5 file that appears complete or not at all. Every failure is an Error(Io) that names the file.
class Hdf5Output {
public:
    /// throws: also Error(MissingCapability) if the build has no HDF5 library
    explicit Hdf5Output(const std::filesystem::path& target);
    ~Hdf5Output();
    Hdf5Output(const Hdf5Output&) = delete;
    Hdf5Output& operator=(const Hdf5Output&) = delete;

    void group(const std::string& path);
    /// A dataset of numbers, compressed; its groups are made as they are needed. columns: 0 for a list, else the numbers of a
    /// row
    template <class T>
    void put(const std::string& path, std::span<const T> values, std::size_t columns = 0) {
        write(path, number_type_of<T>(), columns, values.data(), values.size());
    }
    /// Attributes of a group or dataset. text: not empty
    void attribute(const std::string& object, const std::string& name, const std::string& text);
    void attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values);
    /// Closes the file and gives it its final name.
    void commit();

private:
    template <class T>
    static constexpr NumberType number_type_of() {
        if constexpr (std::is_same_v<T, double>) return NumberType::Float64;
        if constexpr (std::is_same_v<T, float>) return NumberType::Float32;
        if constexpr (std::is_same_v<T, std::int64_t>) return NumberType::Int64;
        if constexpr (std::is_same_v<T, std::uint8_t>) return NumberType::UInt8;
    }
    void write(const std::string& path, NumberType type, std::size_t columns, const void* values, std::size_t count);
    void check(std::int64_t result) const;

    std::filesystem::path target_;
    AtomicFile file_;
    [[maybe_unused]] std::int64_t open_ = -1;  // not used in builds without HDF5
};

/// Datasets of numbers in an HDF5 file, checked. Every failure is an Error(InvalidInput) that names the dataset.
///
/// Never reads more values than the storage of a dataset can have. A row is all values at a place along the first dimension.
class Hdf5File {
public:
    Hdf5File(std::unique_ptr<Hdf5Source> source, std::string file);

    /// From now on values may be read as often as tables have columns, of which each may be an array of its own.
    void allow_columns() { most_times_ = 256; }

    /// A dataset of numbers or of characters.
    [[nodiscard]] std::optional<Hdf5Dataset> find(const std::string& path) const { return source_->find(path); }
    /// Whether there is such a dataset of numbers.
    [[nodiscard]] bool has(const std::string& path) const {
        const auto found = find(path);
        return found && !found->characters;
    }
    [[nodiscard]] std::vector<std::string> names(const std::string& group) const { return source_->names(group); }
    [[nodiscard]] Hdf5Dataset dataset(const std::string& path) const;
    [[nodiscard]] std::size_t rows(const std::string& path) const;
    /// The number of values in a row.
    [[nodiscard]] std::size_t columns(const std::string& path) const;

    /// So many rows.
    [[nodiscard]] std::vector<double> reals(const std::string& path, std::size_t first, std::size_t count) const;
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& path, std::size_t first, std::size_t count) const;
    /// All values.
    [[nodiscard]] std::vector<double> reals(const std::string& path) const { return reals(path, 0, rows(path)); }
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& path) const { return integers(path, 0, rows(path)); }

    /// The bytes of a block of values, in this machine's byte order. starts, counts: along each dimension, inside the dataset
    [[nodiscard]] std::string block(const std::string& path, const Hdf5Dataset& dataset, std::span<const std::size_t> starts,
                                    std::span<const std::size_t> counts) const;

    [[nodiscard]] std::optional<std::string> text(const std::string& object, const std::string& attribute) const {
        return source_->text(object, attribute);
    }
    [[nodiscard]] std::vector<std::int64_t> numbers(const std::string& object, const std::string& attribute) const {
        return source_->integers(object, attribute);
    }
    [[nodiscard]] std::vector<double> real_numbers(const std::string& object, const std::string& attribute) const {
        return source_->reals(object, attribute);
    }

    [[nodiscard]] const std::string& name() const { return file_; }
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

private:
    [[nodiscard]] std::string bytes(const std::string& path, const Hdf5Dataset& dataset, std::size_t first,
                                    std::size_t count) const;

    void count_read(const Hdf5Dataset& dataset, std::size_t bytes) const;

    std::unique_ptr<Hdf5Source> source_;
    std::string file_;
    std::size_t most_times_ = NamedFiles::kMostTimes;
    mutable std::set<std::uint64_t> met_;       // addresses of datasets
    mutable std::size_t there_ = 0, read_ = 0;  // bytes of the file and of these datasets, and those that were read
};

}  // namespace subvol::detail
