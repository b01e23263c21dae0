// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "subvol/detail/number_type.h"
#include "subvol/detail/output_file.h"

namespace subvol::detail {

/// Takes the values of a variable, and writes them with the first byte first.
class NetcdfValues {
public:
    explicit NetcdfValues(OutputFile& out) : out_(&out) {}

    void put(double value);
    void put(std::int32_t value);
    /// Characters, followed by as many zeros as make them so long.
    void put(std::string_view text, std::size_t length);
    /// Writes what is left, to a multiple of four bytes.
    void finish();

private:
    void put_bytes(std::uint64_t bits, std::size_t bytes);
    void flush();

    OutputFile* out_;
    std::string buffer_;
    std::uint64_t written_ = 0;
};

/// A file of netCDF's classic format: what it has is named first, then all is written from front to back. A dimension without a
/// length is that of the records, of which there is one.
class ClassicNetcdfFile {
public:
    enum class Kind : std::uint8_t { Characters, Integers, Reals };
    using AttributeValue = std::variant<std::string, std::int32_t, float>;
    using Attributes = std::vector<std::pair<std::string, AttributeValue>>;

    /// returns: its number
    std::size_t dimension(std::string name, std::size_t length);
    void attribute(std::string name, AttributeValue value) { attributes_.emplace_back(std::move(name), std::move(value)); }
    /// dimensions: their numbers; put: gives all values, one record of them
    void variable(std::string name, Kind kind, std::vector<std::size_t> dimensions, std::function<void(NetcdfValues&)> put,
                  Attributes attributes = {});

    /// most: the most bytes of a variable in the version with 64-bit offsets; if one has more, all numbers have 64 bits
    void write(OutputFile& out, std::uint64_t most = kMostBytes) const;

    static constexpr std::uint64_t kMostBytes = 0xFFFF'FFFC;

private:
    struct Variable {
        std::string name;
        Kind kind;
        std::vector<std::size_t> dimensions;
        std::function<void(NetcdfValues&)> put;
        Attributes attributes;
    };
    struct Dimension {
        std::string name;
        std::size_t length;
    };

    [[nodiscard]] bool has_records(const Variable& variable) const;
    [[nodiscard]] std::uint64_t bytes_of(const Variable& variable) const;
    [[nodiscard]] std::string header(bool wide, std::span<const std::uint64_t> begins) const;

    std::vector<Dimension> dimensions_;
    std::vector<Variable> variables_;
    Attributes attributes_;
};

}  // namespace subvol::detail
