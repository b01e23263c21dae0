// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "inp_types.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "solver_readers.h"
#include "subvol/cell.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"

namespace subvol::detail {
namespace {

// What Abaqus and CalculiX read of one item of a line, of a name, and as the number of a node or an element.
constexpr std::size_t kMostDigits = 20, kLongestName = 72;
constexpr std::size_t kLargestNumber = 999'999'999;
constexpr std::size_t kItemsOfLine = 16;

// A number with as many digits as fit.
void append_item(std::string& line, double value) {
    std::array<char, 64> text;
    char* end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    for (int digits = 17; static_cast<std::size_t>(end - text.data()) > kMostDigits; --digits)
        end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr;
    line.append(", ").append(text.data(), end);
}

// The number from 1 that a side of a hexahedron has in a deck, given that in `kCellFaces`.
std::size_t inp_side(std::size_t side) {
    const CornersOfSides& sides = inp_sides(InpShape::Hex);
    const auto same = [&](const std::vector<std::size_t>& corners) {
        return std::is_permutation(corners.begin(), corners.end(), kCellFaces[side].begin());
    };
    return static_cast<std::size_t>(std::ranges::find_if(sides, same) - sides.begin()) + 1;
}

// The names of one kind of sets as the programs take them: a letter first, no other characters than letters, digits and _, and
// different ones also where capitals do not count.
class DeckNames {
public:
    DeckNames(const char* kind, std::vector<std::string>& warnings) : kind_(kind), warnings_(warnings) {}

    std::string of(const std::string& name) {
        std::string text;
        for (const char c : name) text += is_letter(c) || (c >= '0' && c <= '9') ? c : '_';
        if (text.empty() || !is_letter(text[0])) text.insert(0, "S_");
        text.resize(std::min(text.size(), kLongestName));
        const std::string begin = text;
        for (int k = 2; !taken_.insert(upper_case(text)).second; ++k) text = begin + "_" + std::to_string(k);
        if (text != name) warnings_.push_back(std::string(kind_) + " " + in_quotes(name) + " is called " + in_quotes(text));
        return text;
    }
    [[nodiscard]] bool has(const std::string& name) const { return taken_.contains(upper_case(name)); }

private:
    static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

    const char* kind_;
    std::vector<std::string>& warnings_;
    std::set<std::string> taken_;
};

class DeckWriter {
public:
    DeckWriter(const std::filesystem::path& path, const WrittenMesh& written)
        : out_(path), mesh_(written.mesh), sets_(written.sets) {
        if (std::max(mesh_.points.size(), mesh_.cells.size()) > kLargestNumber) {
            throw Error(ErrorCode::InvalidInput, "such decks number at most 999,999,999 nodes and elements", path.string(),
                        ".vtu or .vtkhdf");
        }
    }

    std::vector<std::string> run() {
        out_.write("*HEADING\nWritten by subvol\n*NODE\n");
        for (std::size_t p = 0; p < mesh_.points.size(); ++p) {
            line_ = std::to_string(p + 1);
            for (int i = 0; i < 3; ++i) append_item(line_, mesh_.points[p][i]);
            out_.write(line_ += '\n');
        }
        // A section of a solver needs a set of all elements.
        const bool has_all = std::ranges::any_of(sets_.sets, [](const CellSet& set) { return upper_case(set.name) == "EALL"; });
        out_.write(has_all ? "*ELEMENT, TYPE=C3D8\n" : "*ELEMENT, TYPE=C3D8, ELSET=Eall\n");
        for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
            line_ = std::to_string(c + 1);
            for (const Index p : mesh_.cells[c]) line_.append(", ").append(std::to_string(p + 1));
            out_.write(line_ += '\n');
        }
        DeckNames element_sets("set of cells", warnings_), node_sets("set of nodes", warnings_), surfaces("patch", warnings_);
        for (const CellSet& set : sets_.sets) {
            if (!set.cells.empty()) write_set("*ELSET, ELSET=" + element_sets.of(set.name), set.cells);
        }
        for (const NodeSet& set : sets_.nodes) {
            if (!set.cells.empty()) write_set("*NSET, NSET=" + node_sets.of(set.name), points_of(mesh_, set));
        }
        for (const Patch& patch : sets_.patches) {
            if (patch.sides.empty()) continue;
            const std::string name = surfaces.of(patch.name);
            if (!node_sets.has(name)) write_set("*NSET, NSET=" + name, points_of_patch(patch));
            out_.write("*SURFACE, NAME=" + name + ", TYPE=ELEMENT\n");
            for (const CellSide& side : patch.sides)
                out_.write(std::to_string(side.cell + 1) + ", S" + std::to_string(inp_side(side.side)) + "\n");
        }
        out_.commit();
        warn_of_lost_fields(".inp", mesh_.attributes, warnings_);
        warn_of_lost_creases(".inp", mesh_, warnings_);
        return std::move(warnings_);
    }

private:
    void write_set(const std::string& keyword, const std::vector<Index>& numbers) {
        out_.write(keyword + "\n");
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            line_ = std::to_string(numbers[k] + 1);
            const bool ends = (k + 1) % kItemsOfLine == 0 || k + 1 == numbers.size();
            out_.write(line_ += ends ? "\n" : ", ");
        }
    }

    [[nodiscard]] std::vector<Index> points_of_patch(const Patch& patch) const {
        std::vector<Index> points;
        for (const CellSide& side : patch.sides) {
            for (const std::size_t k : kCellFaces[side.side]) points.push_back(mesh_.cells[side.cell][k]);
        }
        std::ranges::sort(points);
        points.erase(std::unique(points.begin(), points.end()), points.end());
        return points;
    }

    OutputFile out_;
    const HexMesh& mesh_;
    const MeshSets& sets_;
    std::string line_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> write_inp(const std::filesystem::path& path, const WrittenMesh& written) {
    return DeckWriter(path, written).run();
}

}  // namespace subvol::detail
