// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/hdf5_file.h"
#include "subvol/detail/named_files.h"

namespace subvol::detail {

/// An XDMF file: its elements, and the values of its data items wherever they are: in the text, in HDF5 or in binary files.
class XdmfFile {
public:
    /// text: must outlive it; path: its file, in whose folder the files of values are
    XdmfFile(std::string_view text, const std::filesystem::path& path);

    /// The element Domain.
    [[nodiscard]] pugi::xml_node domain() const { return domain_; }
    /// The children of that name, also those that a grid includes from elsewhere in the file.
    [[nodiscard]] std::vector<pugi::xml_node> children(const pugi::xml_node& parent, const char* name) const;
    /// The first of them; may be none.
    [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;

    /// All values of a data item.
    [[nodiscard]] std::vector<double> values(const pugi::xml_node& item);
    /// The values of all data items of an element, which has so many of them.
    [[nodiscard]] std::vector<std::vector<double>> items(const pugi::xml_node& element, std::size_t count);
    /// Counts bytes that are made of few numbers; fails if they are too many for this file.
    void make(const pugi::xml_node& node, std::size_t bytes) {
        named_.take({}, 0, bytes, [&] { return place_of(node); });
    }
    /// The numbers of an attribute such as Dimensions; empty if there is none.
    [[nodiscard]] std::vector<std::size_t> sizes(const pugi::xml_node& node, const char* attribute) const;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[noreturn]] void fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed = {}) const;

private:
    [[nodiscard]] pugi::xml_node resolved(pugi::xml_node node) const;
    [[nodiscard]] std::vector<pugi::xml_node> included(const pugi::xml_node& node) const;
    [[nodiscard]] std::vector<double> words(const pugi::xml_node& item);
    struct Dataset {
        const Hdf5File* file;
        std::string path;
    };
    [[nodiscard]] std::vector<pugi::xml_node> at_path(const pugi::xml_node& node, std::string_view path) const;
    [[nodiscard]] std::string place_of(const pugi::xml_node& node) const;
    void visit(const pugi::xml_node& node, std::size_t count) const;
    [[nodiscard]] Dataset dataset_of(const pugi::xml_node& item);
    [[nodiscard]] std::vector<double> of_hdf5(const pugi::xml_node& item, std::size_t first, std::optional<std::size_t> count);
    [[nodiscard]] std::vector<double> of_binary(const pugi::xml_node& item, std::size_t count);
    [[nodiscard]] std::vector<double> of_slab(const pugi::xml_node& item);
    void take(const pugi::xml_node& item, const std::string& source, std::size_t there, std::size_t taken);
    [[nodiscard]] std::filesystem::path beside(const pugi::xml_node& item, const std::string& file);

    std::filesystem::path path_;
    std::string name_;
    std::optional<std::string> expanded_;  // the text with the values of the entities that it declares
    std::string_view text_;
    pugi::xml_document document_;
    pugi::xml_node domain_;
    std::map<std::string, std::unique_ptr<Hdf5File>> heavy_;                         // by their identities
    NamedFiles named_;                                                               // the sources of values
    mutable std::map<std::string, std::vector<pugi::xml_node>, std::less<>> paths_;  // that were followed
    mutable std::size_t visited_ = 0;                                                // elements, on the way of all paths
    int depth_ = 0;
};

/// An attribute's text in capitals, of the first of these names that the element has; empty if it has none.
[[nodiscard]] std::string kind_of(const pugi::xml_node& node, std::initializer_list<const char*> names);

}  // namespace subvol::detail
