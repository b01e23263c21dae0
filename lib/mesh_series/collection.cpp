// SPDX-License-Identifier: Apache-2.0
#include "collection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "subvol/detail/json_depth.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "trimmed.h"
#include "vtk_xml.h"

namespace subvol::detail {

namespace {

constexpr int kMostNested = 32;

// Puts files with the same time into one step, and the steps in order.
class Steps {
public:
    void add(double time, ListedFile file) { steps_[time].push_back(std::move(file)); }

    [[nodiscard]] Collection collection() && {
        Collection collection;
        for (auto& [time, files] : steps_) {
            collection.times.push_back(time);
            collection.files.push_back(std::move(files));
        }
        return collection;
    }

private:
    std::map<double, std::vector<ListedFile>> steps_;
};

class XmlList {
public:
    XmlList(const std::filesystem::path& path, const std::string& type, const std::string& needed)
        : path_(path), file_(path.string()), text_(read_text(path)), xml_(text_, file_, type, needed) {}

    [[nodiscard]] const VtkXml& xml() const { return xml_; }
    [[nodiscard]] ListedFile file(const pugi::xml_node& node, const char* attribute, std::string block) {
        std::string place = place_of(node);
        auto path = named_file(path_.parent_path(), as_utf8(node.attribute(attribute).as_string()), [&] { return place; });
        return {std::move(path), std::move(block), std::move(place)};
    }

private:
    // Elements come in the order of the text: each line is counted once.
    [[nodiscard]] std::string place_of(const pugi::xml_node& node) {
        const std::size_t place = std::min(xml_.place(node), text_.size());
        if (place < counted_) counted_ = lines_ = 0;
        const auto at = [&](std::size_t offset) { return text_.begin() + static_cast<std::ptrdiff_t>(offset); };
        lines_ += static_cast<std::size_t>(std::count(at(counted_), at(place), '\n'));
        counted_ = place;
        return file_ + ", line " + std::to_string(1 + lines_);
    }

    std::filesystem::path path_;
    std::string file_, text_;
    VtkXml xml_;
    std::size_t counted_ = 0, lines_ = 0;  // bytes of the text, and the lines that end in them
};

// The blocks of a composite data set, and those of its blocks. name: of the element, with a slash; empty for the first
void add_blocks(XmlList& list, const pugi::xml_node& element, const std::string& name, int depth,
                std::vector<ListedFile>& files) {
    if (depth > kMostNested) list.xml().fail_at(element, "blocks are nested too deeply");
    if (name.size() > kLongestBlock) list.xml().fail_at(element, "the name of a block is too long", kBlockLimit);
    int count = 0;
    for (const auto& child : element.children()) {
        const std::string own = printable(as_utf8(child.attribute("name").as_string()));
        const std::string index = printable(as_utf8(child.attribute("index").as_string(std::to_string(count++).c_str())));
        if (std::string_view(child.name()) == "DataSet") {
            if (!child.attribute("file")) continue;  // an empty block
            const bool of_piece = std::string_view(element.name()) == "Piece" && !name.empty();
            files.push_back(
                list.file(child, "file",
                          own.empty() && of_piece ? name : name + (name.empty() ? "" : "/") + (own.empty() ? index : own)));
        } else {
            const std::string inner = own.empty() ? index : own;
            add_blocks(list, child, name.empty() ? inner : name + "/" + inner, depth + 1, files);
        }
    }
}

}  // namespace

Collection read_pvd(const std::filesystem::path& path) {
    XmlList list(path, "Collection", "a list of files with their times is needed");
    Steps steps;
    for (const auto& node : list.xml().data_set().children("DataSet")) {
        const auto time = number_from(trimmed(node.attribute("timestep").as_string("0")));
        if (!time || !std::isfinite(*time)) list.xml().fail_at(node, "its timestep is not a number");
        std::string name = printable(as_utf8(node.attribute("name").as_string()));
        if (name.size() > kLongestBlock) list.xml().fail_at(node, "the name of a block is too long", kBlockLimit);
        steps.add(*time, list.file(node, "file", std::move(name)));
    }
    Collection collection = std::move(steps).collection();
    if (collection.times.empty()) list.xml().fail_at(list.xml().data_set(), "it lists no files");
    return collection;
}

Collection read_series_list(const std::filesystem::path& path) {
    const std::string file = path.string(), text = read_text(path);
    const auto fail = [&](const std::string& message) {
        throw Error(ErrorCode::InvalidInput, message, file, R"({"files": [{"name": "a.vtu", "time": 0}, …]} is needed)");
    };
    const auto json = nlohmann::json::parse(of_limited_depth(text, file), nullptr, false);
    if (json.is_discarded()) fail("not well-formed JSON");
    if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) fail("it has no list \"files\"");
    Steps steps;
    std::size_t number = 0;
    for (const auto& entry : json["files"]) {
        const std::string place = "entry " + std::to_string(number) + " of \"files\"";
        const bool sound = entry.is_object() && entry.contains("name") && entry["name"].is_string() &&
                           (!entry.contains("time") || entry["time"].is_number());
        if (!sound) fail(place + " has no name, or its time is not a number");
        const double time = entry.contains("time") ? entry["time"].get<double>() : static_cast<double>(number);
        auto named = named_file(path.parent_path(), entry["name"].get<std::string>(), [&] { return file + ", " + place; });
        steps.add(time, {std::move(named), {}, file + ", " + place});
        ++number;
    }
    if (number == 0) fail("it lists no files");
    return std::move(steps).collection();
}

Collection read_pieces_list(const std::filesystem::path& path) {
    const std::string extension = upper_case(path.extension().string());
    const std::string type = extension == ".PVTS"   ? "PStructuredGrid"
                             : extension == ".PVTR" ? "PRectilinearGrid"
                             : extension == ".PVTI" ? "PImageData"
                                                    : "PUnstructuredGrid";
    XmlList list(path, type, "the pieces of a volume mesh are needed");
    Collection collection{{0}, {{}}};
    for (const auto& node : list.xml().data_set().children("Piece")) {
        collection.files[0].push_back(list.file(node, "Source", {}));
    }
    if (collection.files[0].empty()) list.xml().fail_at(list.xml().data_set(), "it lists no pieces");
    return collection;
}

Collection read_blocks_list(const std::filesystem::path& path) {
    XmlList list(path, "vtkMultiBlockDataSet", "blocks of volume meshes are needed");
    Collection collection{{0}, {{}}};
    add_blocks(list, list.xml().data_set(), {}, 0, collection.files[0]);
    if (collection.files[0].empty()) list.xml().fail_at(list.xml().data_set(), "it lists no blocks");
    return collection;
}

std::vector<double> pvd_times(const std::filesystem::path& path) {
    return read_pvd(path).times;
}

std::vector<double> series_list_times(const std::filesystem::path& path) {
    return read_series_list(path).times;
}

}  // namespace subvol::detail
