#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "output_file.h"

namespace subvol {

[[nodiscard]] std::string xml_escaped(std::string_view text);

/// The header of a VTK XML file: its arrays in the order in which their blocks are appended.
class VtkXmlHeader {
public:
    /// data_set: "PolyData" and the like; compressor: VTK's name of one, if the blocks are compressed
    explicit VtkXmlHeader(const std::string& data_set, const std::string& compressor = {});

    void line(const std::string& text) { text_ += text + "\n"; }
    /// block_size: bytes, or characters, that its block takes
    void array(const std::string& type, std::string_view name, std::size_t components, std::size_t block_size);

    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
    std::size_t offset_ = 0;
};

template <class Number>
inline constexpr const char* kVtkType = nullptr;
template <>
inline constexpr const char* kVtkType<float> = "Float32";
template <>
inline constexpr const char* kVtkType<double> = "Float64";
template <>
inline constexpr const char* kVtkType<std::int64_t> = "Int64";

/// Collects a VTK XML file whose arrays are appended, compressed by zlib and in base64: small, and well-formed XML.
class VtkXmlWriter {
public:
    explicit VtkXmlWriter(const std::string& data_set);

    void line(const std::string& text) { header_.line(text); }
    template <class Number>
    void array(std::string_view name, std::size_t components, std::span<const Number> values) {
        append(kVtkType<Number>, name, components, std::as_bytes(values));
    }
    /// An array of strings, for FieldData.
    void strings(std::string_view name, std::span<const std::string> values);

    /// Writes all; the file is then to be committed.
    void write(OutputFile& out, const std::string& data_set_end) const;

private:
    void append(const char* type, std::string_view name, std::size_t components, std::span<const std::byte> bytes);

    VtkXmlHeader header_;
    std::string appended_;
};

}  // namespace subvol
