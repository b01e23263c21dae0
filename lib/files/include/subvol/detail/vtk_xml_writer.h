// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "subvol/detail/output_file.h"

namespace subvol::detail {

/// A text as the value of an attribute: escaped, with an underscore for each control character, which XML does not allow.
[[nodiscard]] std::string attribute_value(std::string_view text);

template <class Number>
inline constexpr const char* kVtkType = nullptr;
template <>
inline constexpr const char* kVtkType<float> = "Float32";
template <>
inline constexpr const char* kVtkType<double> = "Float64";
template <>
inline constexpr const char* kVtkType<std::uint8_t> = "UInt8";
template <>
inline constexpr const char* kVtkType<std::int64_t> = "Int64";

/// Writes a VTK XML file, element by element. Arrays are inline, compressed by zlib and in base64: small, and well-formed XML.
/// They are not appended to the file, since ParaView 5.11 cannot read appended data with recent versions of expat.
class VtkXmlWriter {
public:
    /// Begins the file. out: must outlive it; data_set: "PolyData" and the like
    VtkXmlWriter(OutputFile& out, const std::string& data_set);

    void line(const std::string& text) { out_.write(text + "\n"); }

    template <class Number>
    void array(std::string_view name, std::size_t components, std::span<const Number> values) {
        write_array(kVtkType<Number>, name, components, values.size_bytes(), bytes_of(values));
    }
    /// The same for values that are computed while they are written. value(i): the i-th value; called by several threads
    template <class Number, class Value>
    void made_array(std::string_view name, std::size_t components, std::size_t count, const Value& value) {
        write_array(kVtkType<Number>, name, components, count * sizeof(Number),
                    [&](std::size_t first, std::span<std::byte> block) {
                        for (std::size_t i = 0; i < block.size() / sizeof(Number); ++i) {
                            const Number number = value(first / sizeof(Number) + i);
                            std::memcpy(block.data() + i * sizeof(Number), &number, sizeof(Number));
                        }
                    });
    }
    /// An array of one component, for FieldData.
    template <class Number>
    void field(std::string_view name, std::span<const Number> values) {
        write_array(kVtkType<Number>, name, 1, values.size_bytes(), bytes_of(values), values.size());
    }
    /// An array of strings, for FieldData.
    void strings(std::string_view name, std::span<const std::string> values);

    /// Ends the file; the caller then commits `out`.
    void end();

private:
    using Fill = std::function<void(std::size_t first_byte, std::span<std::byte> block)>;
    /// tuples: to be said, as FieldData needs it
    void write_array(const char* type, std::string_view name, std::size_t components, std::size_t bytes, const Fill& fill,
                     std::optional<std::size_t> tuples = {});

    template <class Number>
    static Fill bytes_of(std::span<const Number> values) {
        return [values](std::size_t first, std::span<std::byte> block) {
            std::memcpy(block.data(), reinterpret_cast<const std::byte*>(values.data()) + first, block.size());
        };
    }

    OutputFile& out_;
    std::string data_set_;
};

}  // namespace subvol::detail
