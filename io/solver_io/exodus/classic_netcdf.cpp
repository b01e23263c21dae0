// SPDX-License-Identifier: Apache-2.0
#include "classic_netcdf.h"

#include <algorithm>
#include <bit>

namespace subvol::detail {
namespace {

constexpr std::uint64_t kUnit = 4;  // all begins at a multiple of so many bytes
constexpr std::uint64_t kDimensionList = 10, kVariableList = 11, kAttributeList = 12;
constexpr std::uint64_t kCharacterType = 2, kIntegerType = 4, kFloatType = 5, kDoubleType = 6;

std::uint64_t filled(std::uint64_t bytes) {
    return (bytes + kUnit - 1) / kUnit * kUnit;
}

/// The header of a file. wide: numbers have 64 bits, else 32
class HeaderText {
public:
    explicit HeaderText(bool wide) : wide_(wide) {}

    void put(std::uint64_t number, std::size_t bytes) {
        for (std::size_t b = bytes; b-- > 0;) text_ += static_cast<char>(number >> (8 * b) & 0xFF);
    }
    void put_type(std::uint64_t type) { put(type, 4); }
    void put_count(std::uint64_t number) { put(number, wide_ ? 8 : 4); }
    void put_offset(std::uint64_t offset) { put(offset, 8); }
    void put_list(std::uint64_t kind, std::size_t count) {
        put_type(count > 0 ? kind : 0);
        put_count(count);
    }
    void put_text(std::string_view text) {
        put_count(text.size());
        text_.append(text).append(filled(text.size()) - text.size(), '\0');
    }
    void put_attributes(const ClassicNetcdfFile::Attributes& attributes) {
        put_list(kAttributeList, attributes.size());
        for (const auto& [name, value] : attributes) {
            put_text(name);
            if (const auto* text = std::get_if<std::string>(&value)) {
                put_type(kCharacterType);
                put_text(*text);
            } else if (const auto* integer = std::get_if<std::int32_t>(&value)) {
                put_type(kIntegerType);
                put_count(1);
                put(std::bit_cast<std::uint32_t>(*integer), sizeof *integer);
            } else {
                put_type(kFloatType);
                put_count(1);
                put(std::bit_cast<std::uint32_t>(std::get<float>(value)), sizeof(float));
            }
        }
    }
    [[nodiscard]] std::string& text() { return text_; }

private:
    bool wide_;
    std::string text_;
};

}  // namespace

void NetcdfValues::put_bytes(std::uint64_t bits, std::size_t bytes) {
    constexpr std::size_t kFlush = 1 << 16;
    for (std::size_t b = bytes; b-- > 0;) buffer_ += static_cast<char>(bits >> (8 * b) & 0xFF);
    if (buffer_.size() > kFlush) flush();
}

void NetcdfValues::put(double value) {
    put_bytes(std::bit_cast<std::uint64_t>(value), sizeof value);
}

void NetcdfValues::put(std::int32_t value) {
    put_bytes(std::bit_cast<std::uint32_t>(value), sizeof value);
}

void NetcdfValues::put(std::string_view text, std::size_t length) {
    text = text.substr(0, length);
    buffer_.append(text).append(length - text.size(), '\0');
}

void NetcdfValues::flush() {
    out_->write(buffer_);
    written_ += buffer_.size();
    buffer_.clear();
}

void NetcdfValues::finish() {
    written_ += buffer_.size();
    buffer_.append(filled(written_) - written_, '\0');
    out_->write(buffer_);
    buffer_.clear();
    written_ = 0;
}

std::size_t ClassicNetcdfFile::dimension(std::string name, std::size_t length) {
    dimensions_.push_back({std::move(name), length});
    return dimensions_.size() - 1;
}

void ClassicNetcdfFile::variable(std::string name, Kind kind, std::vector<std::size_t> dimensions,
                                 std::function<void(NetcdfValues&)> put, Attributes attributes) {
    variables_.push_back({std::move(name), kind, std::move(dimensions), std::move(put), std::move(attributes)});
}

bool ClassicNetcdfFile::has_records(const Variable& variable) const {
    return !variable.dimensions.empty() && dimensions_[variable.dimensions.front()].length == 0;
}

std::uint64_t ClassicNetcdfFile::bytes_of(const Variable& variable) const {
    std::uint64_t bytes = variable.kind == Kind::Characters ? 1 : variable.kind == Kind::Integers ? 4 : sizeof(double);
    for (const std::size_t d : variable.dimensions) bytes *= std::max<std::uint64_t>(1, dimensions_[d].length);
    return bytes;
}

std::string ClassicNetcdfFile::header(bool wide, std::span<const std::uint64_t> begins) const {
    constexpr std::uint64_t kTooLong = 0xFFFF'FFFF;  // for the size of a variable, which readers compute anyway
    HeaderText to(wide);
    to.text() = wide ? "CDF\5" : "CDF\2";
    to.put_count(std::ranges::any_of(dimensions_, [](const Dimension& dimension) { return dimension.length == 0; }) ? 1 : 0);
    to.put_list(kDimensionList, dimensions_.size());
    for (const Dimension& dimension : dimensions_) {
        to.put_text(dimension.name);
        to.put_count(dimension.length);
    }
    to.put_attributes(attributes_);
    to.put_list(kVariableList, variables_.size());
    for (std::size_t v = 0; v < variables_.size(); ++v) {
        const Variable& variable = variables_[v];
        to.put_text(variable.name);
        to.put_count(variable.dimensions.size());
        for (const std::size_t d : variable.dimensions) to.put_count(d);
        to.put_attributes(variable.attributes);
        to.put_type(variable.kind == Kind::Characters ? kCharacterType
                    : variable.kind == Kind::Integers ? kIntegerType
                                                      : kDoubleType);
        const std::uint64_t bytes = filled(bytes_of(variable));
        to.put_count(wide ? bytes : std::min(bytes, kTooLong));
        to.put_offset(begins[v]);
    }
    return std::move(to.text());
}

void ClassicNetcdfFile::write(OutputFile& out, std::uint64_t most) const {
    const bool wide = std::ranges::any_of(variables_, [&](const Variable& variable) { return bytes_of(variable) > most; });
    // First those without records.
    std::vector<std::size_t> order;
    for (const bool records : {false, true}) {
        for (std::size_t v = 0; v < variables_.size(); ++v) {
            if (has_records(variables_[v]) == records) order.push_back(v);
        }
    }
    std::vector<std::uint64_t> begins(variables_.size());
    std::uint64_t next = header(wide, begins).size();
    for (const std::size_t v : order) {
        begins[v] = next;
        next += filled(bytes_of(variables_[v]));
    }
    out.write(header(wide, begins));
    NetcdfValues values(out);
    for (const std::size_t v : order) {
        variables_[v].put(values);
        values.finish();
    }
}

}  // namespace subvol::detail
