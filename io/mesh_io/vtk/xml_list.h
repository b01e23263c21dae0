// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <utility>

#include "collection.h"
#include "mesh_arrays.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml.h"

namespace subvol::detail {

/// A VTK XML file that names other files.
class XmlList {
public:
    /// type, needed: as for VtkXml
    XmlList(const std::filesystem::path& path, const std::string& type, const std::string& needed)
        : XmlList(path, read_text(path), type, needed) {}
    XmlList(const std::filesystem::path& path, std::string text, const std::string& type, const std::string& needed)
        : path_(path), file_(path.string()), text_(std::move(text)), xml_(text_, file_, type, needed) {}

    [[nodiscard]] const VtkXml& xml() const { return xml_; }

    /// The file that an attribute of an element names.
    [[nodiscard]] ListedFile file(const pugi::xml_node& node, const char* attribute, std::string block) {
        std::string place = place_of(node);
        auto path = named_file(path_.parent_path(), as_utf8(node.attribute(attribute).as_string()), [&] { return place; });
        return {std::move(path), std::move(block), std::move(place)};
    }

    /// What its field data say, of which nothing belongs to points or cells of a single file.
    [[nodiscard]] ListRemarks remarks() const {
        ListRemarks remarks;
        for (const pugi::xml_node& parent : {xml_.data_set(), xml_.data_set().parent()}) {  // VTK 9.1 writes both
            for (const auto& element : parent.children("FieldData")) {
                for (const auto& array : element.children()) {
                    const std::string name = as_utf8(array.attribute("Name").as_string());
                    MeshFile of_array;
                    if (is_time_array(name) && xml_.arrays().size(array) == 1)
                        xml_.arrays().each_real(array, [&](auto values) { take_time(name, values, of_array); });
                    if (of_array.time) {
                        remarks.time = of_array.time;
                    } else {
                        remarks.ignored.push_back(ignored_field_data(name));
                    }
                }
            }
        }
        return remarks;
    }

    /// The file and the line of an element. Elements come in the order of the text: each line is counted once.
    [[nodiscard]] std::string place_of(const pugi::xml_node& node) {
        const std::size_t place = std::min(xml_.place(node), text_.size());
        if (place < counted_) counted_ = lines_ = 0;
        const auto at = [&](std::size_t offset) { return text_.begin() + static_cast<std::ptrdiff_t>(offset); };
        lines_ += static_cast<std::size_t>(std::count(at(counted_), at(place), '\n'));
        counted_ = place;
        return file_ + ", line " + std::to_string(1 + lines_);
    }

private:
    std::filesystem::path path_;
    std::string file_, text_;
    VtkXml xml_;
    std::size_t counted_ = 0, lines_ = 0;  // bytes of the text, and the lines that end in them
};

}  // namespace subvol::detail
