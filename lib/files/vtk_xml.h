// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "text_scanner.h"
#include "vtu_arrays.h"

namespace subvol::detail {

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
