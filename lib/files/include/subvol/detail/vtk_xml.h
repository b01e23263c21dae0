// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/named_files.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtu_bytes.h"

namespace subvol::detail {

/// How a VTK XML file stores its arrays.
struct VtuEncoding {
    std::endian order = std::endian::little;
    NumberType header = NumberType::UInt32;
    Compressor compressor = Compressor::None;
    std::string_view appended;  ///< the text after the underscore of AppendedData; empty if there is none
    bool appended_base64 = false;
};

/// A shortened copy of a long text for an XML parser: of the text between two tags only the beginning of the first word is
/// kept, so that arrays are not in memory twice.
class XmlTags {
public:
    /// text: need not outlive it
    explicit XmlTags(std::string_view text = {});

    /// The shortened text, which the parser may change in place.
    [[nodiscard]] std::string& text() { return tags_; }

    /// The offset in the whole text that belongs to an offset in `text()`.
    [[nodiscard]] std::size_t place(std::size_t offset) const;

private:
    struct Cut {
        std::size_t offset;  // in tags_
        std::size_t length;  // of all the text that is left out up to here
    };
    std::string tags_;
    std::vector<Cut> cuts_;
};

/// Reads the values of DataArray elements in every encoding. in: a scanner of the whole file, for error messages
class VtuArrays {
public:
    VtuArrays(std::string_view text, std::string_view file, const TextScanner& in, const XmlTags& tags,
              const VtuEncoding& encoding)
        : text_(text), file_(file), in_(in), tags_(tags), encoding_(encoding) {}

    /// The number of values of an array; the caller compares it with the expected number before it reads them.
    [[nodiscard]] std::size_t size(const pugi::xml_node& array) const;

    /// Whether the values have an integer type.
    [[nodiscard]] bool has_integers(const pugi::xml_node& array) const;

    /// Calls take(values) for consecutive parts of an array, so that the whole array need not be in memory.
    void each_real(const pugi::xml_node& array, const std::function<void(std::span<const double>)>& take) const;
    void each_integer(const pugi::xml_node& array, const std::function<void(std::span<const std::int64_t>)>& take) const;

    /// All values of an array.
    [[nodiscard]] std::vector<double> reals(const pugi::xml_node& array) const;
    [[nodiscard]] std::vector<std::int64_t> integers(const pugi::xml_node& array) const;

    /// The offset of an element in the text.
    [[nodiscard]] std::size_t place(const pugi::xml_node& node) const;
    [[noreturn]] void fail(const pugi::xml_node& array, const std::string& message, const std::string& allowed = {}) const;

private:
    struct Layout {
        std::uint64_t bytes = 0;                     ///< bytes of all values
        std::uint64_t block = 0;                     ///< bytes of a block, after decompression
        std::uint64_t last = 0;                      ///< bytes of the last block, after decompression
        std::vector<std::uint64_t> compressed = {};  ///< bytes of each compressed block
    };
    using TakeBytes = std::function<void(std::string_view)>;

    [[nodiscard]] NumberType type_of(const pugi::xml_node& array) const;
    [[nodiscard]] std::string_view content(const pugi::xml_node& array) const;
    [[nodiscard]] TextScanner words(const pugi::xml_node& array) const;
    [[nodiscard]] ByteSource source(const pugi::xml_node& array) const;
    [[nodiscard]] std::uint64_t header_number(const pugi::xml_node& array, ByteSource& from) const;
    [[nodiscard]] Layout layout(const pugi::xml_node& array, ByteSource& from) const;
    void count(NamedFiles& counts, const pugi::xml_node& array, std::size_t there, std::size_t taken) const;
    [[noreturn]] void fail_bytes(const pugi::xml_node& array, std::uint64_t bytes, const ByteSource& from) const;
    void each_block(const pugi::xml_node& array, const TakeBytes& take) const;
    void plain_blocks(const pugi::xml_node& array, std::uint64_t size, ByteSource from, const TakeBytes& take) const;
    void compressed_blocks(const pugi::xml_node& array, const Layout& layout, ByteSource from, const TakeBytes& take) const;

    std::string_view text_;
    std::string_view file_;
    const TextScanner& in_;
    const XmlTags& tags_;
    const VtuEncoding& encoding_;
    mutable NamedFiles encoded_, decoded_;  // arrays may name the same appended bytes
};

/// The value of an attribute that is a count or an offset; VTK may put white space around it. Nothing if it is missing or not
/// such a number.
[[nodiscard]] std::optional<std::uint64_t> number_attribute(const pugi::xml_node& node, const char* name);

/// The name of a DataArray for messages, in quotes.
[[nodiscard]] std::string name_of(const pugi::xml_node& array);

/// A VTK XML file: its elements and the values of its arrays. Every failure is an Error(InvalidInput) that names the place.
class VtkXml {
public:
    /// text, file: must outlive it; type: of the expected data set; needed: a description of it, for the error message
    VtkXml(std::string_view text, std::string_view file, const std::string& type, const std::string& needed);
    VtkXml(const VtkXml&) = delete;
    VtkXml& operator=(const VtkXml&) = delete;

    /// The element named as the type.
    [[nodiscard]] const pugi::xml_node& data_set() const { return data_set_; }
    [[nodiscard]] const VtuArrays& arrays() const { return arrays_; }
    [[nodiscard]] const TextScanner& in() const { return in_; }

    /// Whether the version of the file is less than this one.
    [[nodiscard]] bool is_older_than(int major, int minor) const;

    /// The largest possible size of all arrays after decompression, in bytes.
    [[nodiscard]] std::size_t most_bytes() const { return largest_size(encoding_.compressor, text_.size()); }

    /// The value of an attribute that counts points or cells.
    [[nodiscard]] std::size_t count(const pugi::xml_node& piece, const char* name) const;
    /// The array of that name; fails if there is none.
    [[nodiscard]] pugi::xml_node array(const pugi::xml_node& parent, const char* name) const;
    /// The array of the points' coordinates, three for each.
    [[nodiscard]] pugi::xml_node coordinates(const pugi::xml_node& piece, std::size_t points) const;
    void expect_size(const pugi::xml_node& array, std::size_t size, std::size_t needed, const std::string& what) const;
    /// The offset of an element in the text.
    [[nodiscard]] std::size_t place(const pugi::xml_node& node) const { return arrays_.place(node); }
    [[noreturn]] void fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed = {}) const;

private:
    [[nodiscard]] pugi::xml_node parse(const std::string& type, const std::string& needed);
    void find_appended(std::size_t tag_end);
    void read_encoding(const pugi::xml_node& root);

    std::string_view text_;
    TextScanner in_;
    XmlTags tags_;
    pugi::xml_document document_;
    VtuEncoding encoding_;
    VtuArrays arrays_;
    pugi::xml_node data_set_;
};

}  // namespace subvol::detail
