#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "text_scanner.h"
#include "vtk_numbers.h"
#include "vtu_bytes.h"

namespace subvol {

/// How a VTK XML file stores its arrays.
///
/// appended: what follows the underscore of AppendedData; empty if there is none
struct VtuEncoding {
    std::endian order = std::endian::little;
    NumberType header = NumberType::UInt32;
    Compressor compressor = Compressor::None;
    std::string_view appended;
    bool appended_base64 = false;
};

/// Reads the values of DataArray elements, however they are stored. in: over the whole file, for the places of failures
class VtuArrays {
public:
    VtuArrays(std::string_view text, std::string_view file, const TextScanner& in, const VtuEncoding& encoding)
        : text_(text), file_(file), in_(in), encoding_(encoding) {}

    /// All values of an array; the caller knows how many there should be.
    [[nodiscard]] std::vector<double> reals(const pugi::xml_node& array) const;
    [[nodiscard]] std::vector<std::int64_t> integers(const pugi::xml_node& array) const;

    [[noreturn]] void fail(const pugi::xml_node& array, const std::string& message, const std::string& allowed = {}) const;

private:
    [[nodiscard]] NumberType type_of(const pugi::xml_node& array) const;
    [[nodiscard]] std::string_view content(const pugi::xml_node& array) const;
    [[nodiscard]] TextScanner words(const pugi::xml_node& array) const;
    [[nodiscard]] std::string bytes(const pugi::xml_node& array) const;
    [[nodiscard]] ByteSource source(const pugi::xml_node& array) const;
    [[nodiscard]] std::uint64_t header_number(const pugi::xml_node& array, ByteSource& from) const;
    [[nodiscard]] std::string plain_block(const pugi::xml_node& array, ByteSource from) const;
    [[nodiscard]] std::string compressed_blocks(const pugi::xml_node& array, ByteSource from) const;

    std::string_view text_;
    std::string_view file_;
    const TextScanner& in_;
    const VtuEncoding& encoding_;
};

/// An attribute that is a count or an offset; white space around it is VTK's habit. nothing: it is missing or no such number
[[nodiscard]] std::optional<std::uint64_t> number_attribute(const pugi::xml_node& node, const char* name);

/// The name of a DataArray for messages, in quotes.
[[nodiscard]] std::string name_of(const pugi::xml_node& array);

}  // namespace subvol
