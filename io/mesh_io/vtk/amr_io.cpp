// SPDX-License-Identifier: Apache-2.0
// Reads adaptive mesh refinement of VTK XML: a list of levels and boxes, each with the image that has its values.
//
//     list → levels and boxes, checked → images, each compared with its box → mesh of the finest cells
//
// Where the boxes do not overlap, the list has none: these images are blocks as those of any other list.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "amr_grid.h"
#include "assemble.h"
#include "formats.h"
#include "join_pieces.h"
#include "mesh_arrays.h"
#include "subvol/error.h"
#include "xml_list.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kOverlapping = "vtkOverlappingAMR", kNotOverlapping = "vtkNonOverlappingAMR",
                           kBoxes = "vtkHierarchicalBoxDataSet";

// The type that the root element names; the first one if none of these is there.
std::string type_of_amr(std::string_view text) {
    const std::size_t begin = text.find("<VTKFile");
    const std::string_view root =
        text.substr(std::min(begin, text.size()), text.find('>', std::min(begin, text.size())) - begin);
    for (const std::string_view type : {kNotOverlapping, kBoxes}) {
        if (root.find(type) != std::string_view::npos) return std::string(type);
    }
    return std::string(kOverlapping);
}

template <class Number, std::size_t N>
std::array<Number, N> numbers_of(const XmlList& list, const pugi::xml_node& node, const char* name) {
    const std::string_view text = node.attribute(name).as_string();
    std::array<Number, N> numbers{};
    TextScanner words(text, {}, TextScanner::Comments::None);
    bool sound = true;
    for (Number& number : numbers) {
        const std::string_view word = words.word();
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        sound = sound && error == std::errc() && stop == word.data() + word.size();
    }
    if (!sound || !words.at_end()) {
        list.xml().fail_at(node, "its " + std::string(name) + " is " + in_quotes(text),
                           std::to_string(N) + (std::is_integral_v<Number> ? " integers" : " numbers") + " are needed");
    }
    return numbers;
}

class AmrReader {
public:
    AmrReader(const std::filesystem::path& path, const ReadOptions& options)
        : file_(path.string()),
          options_(options),
          text_(read_text(path)),
          type_(type_of_amr(text_)),
          list_(path, std::move(text_), type_, "adaptive mesh refinement in blocks is needed") {
        options_.step.reset();
    }

    ReadResult read() {
        const auto open = named_.open(file_, [] { return std::string(); });
        MeshFile found = type_ == kNotOverlapping ? read_blocks() : read_boxes();
        if (found.hexes.corners.empty()) throw Error(ErrorCode::InvalidInput, "no hexahedra in any of its blocks", file_);
        list_.remarks().add_to(found.time, found.ignored);
        return assemble(std::move(found), file_, names_in_parts(), options_);
    }

private:
    MeshFile read_boxes() {
        read_list();
        check_amr(grid_, file_);
        for (std::size_t l = 0; l < grid_.levels.size(); ++l) read_level(l);
        complete_sets();
        MeshFile found = mesh_of_amr(grid_, file_);
        found.warnings.insert(found.warnings.end(), said_.begin(), said_.end());
        found.ignored.insert(found.ignored.end(), ignored_.begin(), ignored_.end());
        return found;
    }

    void read_list() {
        const pugi::xml_node& data = list_.xml().data_set();
        const std::string_view description = data.attribute("grid_description").as_string("XYZ");
        if (description != "XYZ") {
            list_.xml().fail_at(data, "its grid_description is " + in_quotes(description) + ", which has no volume",
                                "XYZ, of three dimensions");
        }
        if (!data.attribute("origin")) {
            list_.xml().fail_at(data, "it has no origin",
                                "VTK's vtkXMLHierarchicalBoxDataFileConverter makes version 1.1 of older files");
        }
        grid_.origin = numbers_of<double, 3>(list_, data, "origin");
        for (const auto& block : data.children("Block")) {
            const std::size_t l = grid_.levels.size();
            if (number_attribute(block, "level") != l) {
                list_.xml().fail_at(block, "its level is " + in_quotes(block.attribute("level").as_string()),
                                    std::to_string(l) + ": levels are counted from 0 and in their order");
            }
            AmrLevel& level = grid_.levels.emplace_back();
            level.spacing = numbers_of<double, 3>(list_, block, "spacing");
            if (block.attribute("refinement_ratio") && number_attribute(block, "refinement_ratio").value_or(0) == 0) {
                list_.xml().fail_at(block,
                                    "its refinement_ratio is " + in_quotes(block.attribute("refinement_ratio").as_string()),
                                    "1 or more");
            }
            auto& files = files_.emplace_back();
            for (const auto& node : block.children("DataSet")) {
                const auto ends = numbers_of<std::int64_t, 6>(list_, node, "amr_box");
                AmrBlock& box = level.blocks.emplace_back();
                for (std::size_t a = 0; a < 3; ++a) {
                    box.box.low[a] = ends[2 * a];
                    box.box.high[a] = ends[2 * a + 1];
                }
                box.place = list_.place_of(node);
                box.has_values = !node.attribute("file").empty();
                files.push_back(box.has_values ? list_.file(node, "file", {}) : ListedFile{});
            }
        }
    }

    void read_level(std::size_t l) {
        AmrLevel& level = grid_.levels[l];
        std::size_t points = 0, cells = 0;
        std::set<std::string> partial;
        for (std::size_t b = 0; b < level.blocks.size(); ++b) {
            const AmrBlock& block = level.blocks[b];
            const StructuredGrid grid = block.box.grid();
            if (block.has_values) take_arrays(read_image(files_[l][b]), l, b, points, cells);
            points += grid.point_count();
            cells += grid.cell_count();
            for (FileArray& array : level.arrays) {
                const std::size_t all = (array.at_cells ? cells : points) * static_cast<std::size_t>(array.components);
                // A block without values has no cell in the mesh.
                if (block.has_values && array.values.size() != all && !is_zero_where_missing(array)) partial.insert(array.name);
                array.values.resize(all);
            }
        }
        for (const std::string& name : partial) {
            ignored_.push_back(not_everywhere(name, "block"));
            said_.push_back(ignored_text(ignored_.back()));
        }
        std::erase_if(level.arrays, [&](const FileArray& array) { return partial.contains(array.name); });
    }

    MeshFile read_image(const ListedFile& file) {
        const auto place = [&] { return file.place; };
        named_.take_file(file.path, place);
        MeshFile image = read_part(file, options_);
        std::size_t bytes = image.points.size() * sizeof(Vec3) + image.hexes.corners.size() * sizeof image.hexes.corners[0];
        for (const FileArray& array : image.arrays) bytes += array.values.size() * sizeof(double);
        named_.take("cells of " + NamedFiles::identity(file.path), bytes, bytes, place);
        take_ghost_levels(image);
        return image;
    }

    // points, cells: those of the blocks of the level before
    void take_arrays(MeshFile image, std::size_t l, std::size_t b, std::size_t points, std::size_t cells) {
        AmrLevel& level = grid_.levels[l];
        measure(image, level, level.blocks[b].box);
        check_image(image, l, b);
        const StructuredGrid grid = level.blocks[b].box.grid();
        const auto add_flags = [&](const FileSet& set, std::string name,
                                   bool at_cells) {  // arrays again, until the cells are known
            FileArray& flags = image.arrays.emplace_back();
            flags.name = std::move(name);
            flags.at_cells = at_cells;
            flags.integers = true;
            flags.values.assign(at_cells ? grid.cell_count() : grid.point_count(), 0);
            for (const Index k : set.numbers) flags.values[k] = 1;
        };
        for (const FileSet& set : image.sets) add_flags(set, set_array_name(CellSet{set.name, {}}), true);
        for (const FileSet& set : image.node_sets) add_flags(set, node_array_name(NodeSet{set.name, {}}), false);
        for (const std::string& warning : image.warnings) {
            if (std::ranges::find(said_, warning) == said_.end()) said_.push_back(warning);
        }
        for (const IgnoredPart& part : image.ignored) {
            const auto same = std::ranges::find_if(ignored_, [&](const IgnoredPart& other) {
                return other.kind == part.kind && other.name == part.name && other.reason == part.reason;
            });
            if (same == ignored_.end()) {
                ignored_.push_back(part);
            } else {
                same->count += part.count;
            }
        }
        for (FileArray& array : image.arrays) {
            const auto same = std::ranges::find_if(level.arrays, [&](const FileArray& other) {
                return other.name == array.name && other.at_cells == array.at_cells && other.components == array.components;
            });
            const std::size_t before = (array.at_cells ? cells : points) * static_cast<std::size_t>(array.components);
            const bool is_new = same == level.arrays.end();
            FileArray& all = is_new ? level.arrays.emplace_back() : *same;
            if (is_new) {
                all.name = array.name;
                all.at_cells = array.at_cells;
                all.components = array.components;
                all.integers = array.integers;
                all.values.resize(before);
                if (!is_zero_where_missing(array) && has_values_before(l, b)) all.values.push_back(0);  // not in every block
            }
            if (all.values.size() == before) all.values.insert(all.values.end(), array.values.begin(), array.values.end());
        }
    }

    [[nodiscard]] static bool is_zero_where_missing(const FileArray& array) {
        const auto components = static_cast<std::size_t>(array.components);
        return array.name == kGhostArray ||
               (array.at_cells ? is_set_array(array.name, components) : is_node_set_array(array.name, components));
    }

    // A level without a set has no cell or point of it.
    void complete_sets() {
        std::map<std::pair<std::string, bool>, FileArray> sets;
        for (const AmrLevel& level : grid_.levels) {
            for (const FileArray& array : level.arrays) {
                if (array.name == kGhostArray || !is_zero_where_missing(array)) continue;
                FileArray& like = sets[{array.name, array.at_cells}];
                like = array;
                like.values.clear();
            }
        }
        for (AmrLevel& level : grid_.levels) {
            std::size_t points = 0, cells = 0;
            for (const AmrBlock& block : level.blocks) {
                points += block.box.grid().point_count();
                cells += block.box.grid().cell_count();
            }
            for (const auto& entry : sets) {
                const FileArray& like = entry.second;
                const bool there = std::ranges::any_of(level.arrays, [&](const FileArray& array) {
                    return array.name == like.name && array.at_cells == like.at_cells && array.components == 1;
                });
                if (there) continue;
                level.arrays.push_back(like);
                level.arrays.back().values.assign(like.at_cells ? cells : points, 0);
            }
        }
    }

    [[nodiscard]] bool has_values_before(std::size_t l, std::size_t b) const {
        const auto& blocks = grid_.levels[l].blocks;
        return std::any_of(blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(b),
                           [](const AmrBlock& block) { return block.has_values; });
    }

    // Programs write six digits of the spacings in the list, and all of them in the images.
    void measure(const MeshFile& image, AmrLevel& level, const AmrBox& box) {
        if (image.points.empty()) return;
        constexpr double kSixDigits = 1e-5, kRounding = 1e-10;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<int>(a);
            const double first = image.points.front()[axis], last = image.points.back()[axis];
            const double spacing = (last - first) / static_cast<double>(box.high[a] - box.low[a] + 1);
            const double origin = first - spacing * static_cast<double>(box.low[a]);
            const double off = std::abs(spacing - level.spacing[a]);
            if (off <= kSixDigits * spacing && off > kRounding * spacing) level.spacing[a] = spacing;
            const double away = std::abs(origin - grid_.origin[a]);
            if (&level == grid_.levels.data() && away > kRounding * spacing &&
                away <= kSixDigits * std::max(spacing, std::abs(origin)))
                grid_.origin[a] = origin;
        }
    }

    // The image has to have the cells of the box, at its place.
    void check_image(const MeshFile& image, std::size_t l, std::size_t b) const {
        const AmrLevel& level = grid_.levels[l];
        const AmrBox& box = level.blocks[b].box;
        const StructuredGrid grid = box.grid();
        const auto fail = [&](const std::string& message) {
            throw Error(ErrorCode::InvalidInput,
                        in_quotes(files_[l][b].path.filename().string()) + " is not the image of its amr_box: " + message,
                        level.blocks[b].place);
        };
        if (image.points.size() != grid.point_count()) {
            fail(counted(image.points.size(), "point", "points") + ", and the box has " + size_text(grid));
        }
        constexpr double kOfSpacing = 1e-3;
        const std::array<std::size_t, 3> steps{1, grid.points[0], grid.points[0] * grid.points[1]};
        for (std::size_t corner = 0; corner < 8; ++corner) {
            std::size_t p = 0;
            for (std::size_t a = 0; a < 3; ++a) p += (corner >> a & 1) * (grid.points[a] - 1) * steps[a];
            for (std::size_t a = 0; a < 3; ++a) {
                const auto i =
                    static_cast<double>(box.low[a] + static_cast<std::int64_t>((corner >> a & 1) * (grid.points[a] - 1)));
                const double expected = grid_.origin[a] + level.spacing[a] * i;
                if (std::abs(image.points[p][static_cast<int>(a)] - expected) <= kOfSpacing * level.spacing[a]) continue;
                fail("its corners are not where origin, spacing and box are");
            }
        }
    }

    MeshFile read_blocks() {
        std::vector<ListedFile> files;
        for (const auto& block : list_.xml().data_set().children("Block")) {
            for (const auto& node : block.children("DataSet")) {
                if (node.attribute("file")) files.push_back(list_.file(node, "file", {}));
            }
        }
        std::vector<MeshFile> parts;
        for (const ListedFile& file : files) {
            MeshFile image = read_image(file);
            if (!image.points.empty()) parts.push_back(std::move(image));
        }
        if (parts.empty()) throw Error(ErrorCode::InvalidInput, "it lists no blocks", file_);
        return join_pieces(std::move(parts), "block", file_);
    }

    std::string file_;
    ReadOptions options_;
    std::string text_, type_;
    XmlList list_;
    NamedFiles named_;
    AmrGrid grid_;
    std::vector<std::vector<ListedFile>> files_;  // of each level and block
    std::vector<std::string> said_;
    std::vector<IgnoredPart> ignored_;  // of all images
};

}  // namespace

ReadResult read_amr(const std::filesystem::path& path, const ReadOptions& options) {
    return AmrReader(path, options).read();
}

}  // namespace subvol::detail
