// SPDX-License-Identifier: Apache-2.0
// Reads EnSight's cases: a text that names a geometry and variables, each in files of their own for the times. Files of the
// form 6 are first turned into those of Gold, so that everything after reads one form.
//
//     case → step → geometry: parts with points, elements by type, or a block → variables → chosen parts, joined
//
// Where only coordinates change with time, elements come from one step and points from another. Elements of a part are counted
// over all its types, in the order of the file, and values at elements come type by type; a value that is undefined or not
// listed is NaN. Blanked and ghost cells of blocks are left out. A variable that cannot be read is removed from all parts, and
// stops no other one.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "assemble.h"
#include "ensight_case.h"
#include "ensight_data.h"
#include "ensight_six.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "polyhedra.h"
#include "solver_readers.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/index.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kEnsightNames{"node", "element", 1};

// A uniform block lists no points: with its cells it is much more than its few numbers.
constexpr std::size_t kBytesOfBlockPoint = 64;

// Elements of one type of a part.
struct Group {
    std::string type;
    std::size_t first, count;
};

// first_groups: of each type; arrays: where those are that are at points and at cells, by their names
struct Part {
    MeshFile found;
    std::string name;
    std::vector<Group> groups;
    Polyhedra polyhedra;
    std::map<std::string, std::size_t, std::less<>> first_groups;
    std::map<std::pair<std::string, bool>, std::size_t> arrays;
    std::size_t elements = 0;
    bool structured = false, taken = true;

    void drop(const std::pair<std::string, bool>& variable) {
        const auto found_at = arrays.find(variable);
        if (found_at == arrays.end()) return;
        found.arrays.erase(found.arrays.begin() + static_cast<std::ptrdiff_t>(found_at->second));
        for (auto& [key, place] : arrays) place -= place > found_at->second;
        arrays.erase(found_at);
    }
};

class EnsightReader {
public:
    EnsightReader(const std::filesystem::path& path, const ReadOptions& options)
        : file_(path.string()), text_(read_text(path)), case_(text_, file_), options_(options) {}

    ReadResult read() {
        std::vector<std::string> warnings = case_.warnings();
        const std::size_t step = chosen_step(options_, std::max<std::size_t>(1, case_.times().size()), file_, warnings);
        time_ = case_.times().empty() ? 0 : case_.times()[step];
        const bool apart = case_.coordinates_step().has_value() && !case_.times().empty();
        const std::size_t first = std::min(case_.coordinates_step().value_or(0), case_.times().size() - 1);
        read_geometry(apart ? case_.times()[first] : time_);
        if (apart) read_coordinates();
        std::vector<std::string> names;
        for (const auto& [number, part] : parts_) names.push_back(part.name);
        const BlockChoice choice(options_.blocks, names, file_);
        for (auto& [number, part] : parts_) part.taken = choice.takes(part.name);
        for (const EnsightVariable& variable : case_.variables()) read_or_leave_out(variable);
        std::vector<MeshFile> files;
        for (auto& [number, part] : parts_) {
            std::size_t cells = 0;
            if (!part.taken) continue;
            const std::size_t others = part.polyhedra.take_into(part.found, options_.other_cells == OtherCells::Ignore);
            if (others > 0) left_out_["nfaced"] += others;
            each_kind(part.found, [&](const auto& of_kind) { cells += of_kind.corners.size(); });
            if (!part.taken || cells == 0) continue;  // a part of surfaces
            part.found.blocks = {{printable(part.name), cells}};
            files.push_back(std::move(part.found));
        }
        if (files.empty()) files.emplace_back();
        MeshFile found = files.size() == 1 ? std::move(files.front()) : join_pieces(std::move(files), "part", file_);
        found.unread.insert(found.unread.end(), unread_.begin(), unread_.end());
        found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
        found.ignored.insert(found.ignored.end(), case_.ignored().begin(), case_.ignored().end());
        if (curved_ > 0) {
            found.warnings.push_back(counted(curved_, "element has", "elements have") +
                                     " more nodes than corners: only the corners are used");
        }
        add_left_out_warning(found, ignored_parts("element type", left_out_), file_);
        return assemble(std::move(found), file_, kEnsightNames, options_);
    }

private:
    EnsightStep checked(const EnsightFiles& files, double time) {
        EnsightStep step = case_.file_at(files, time);
        const auto place = [&] { return case_.place_of(files); };
        named_.count(place);
        named_.take_file(step.path, place);
        return step;
    }

    // Where only the coordinates change, the elements are those of one step.
    void read_coordinates() {
        std::map<int, Part> parts = std::move(parts_);
        parts_ = {};
        read_geometry(time_);
        for (auto& [number, part] : parts) {
            const auto moved = parts_.find(number);
            if (moved == parts_.end()) continue;
            auto& points = moved->second.found.points;
            if (points.size() != part.found.points.size()) {
                throw Error(ErrorCode::InvalidInput,
                            "part " + in_quotes(part.name) + " has " + counted(points.size(), "node", "nodes") +
                                " at this step, and " + std::to_string(part.found.points.size()) + " at that of its elements",
                            file_);
            }
            part.found.points = std::move(points);
        }
        parts_ = std::move(parts);
    }

    void read_geometry(double time) {
        const EnsightStep step = checked(case_.geometry(), time);
        EnsightData given(step.path, {}, step.step);
        form_ = given.form();
        std::optional<EnsightData> gold;
        if (case_.six()) gold.emplace(six_.geometry(given), step.path.string());
        EnsightData& data = gold ? *gold : given;
        std::ignore = data.description();
        std::ignore = data.description();
        const bool node_ids = has_ids(data, "node"), element_ids = has_ids(data, "element");
        std::optional<int> open;
        while (!data.at_end()) {
            const std::string line = data.keyword();
            if (line == "extents") {
                std::ignore = data.reals(6, "extents");
            } else if (line == "part") {
                const std::int64_t number = data.integer("the number of a part");
                open = static_cast<int>(number);
                if (number < 0 || number > 1 << 24 || !parts_.try_emplace(*open).second) {
                    data.fail("there cannot be another part " + std::to_string(number));
                }
                Part& part = parts_[*open];
                part.name = as_utf8(data.description());
                if (part.name.empty()) part.name = "part " + std::to_string(number);
            } else if (!open) {
                if (!line.empty()) data.fail("a part is expected, not " + in_quotes(line));
            } else if (line == "coordinates") {
                read_points(data, parts_[*open], node_ids);
            } else if (line.starts_with("block")) {
                read_block(data, parts_[*open], line);
            } else {
                read_elements(data, parts_[*open], line, element_ids);
            }
        }
        for (const auto& [number, part] : parts_) refuse_not_finite(part.found, data.in(), kEnsightNames);
    }

    // The numbers of "node id given" follow, and say nothing about who refers to what.
    static bool has_ids(EnsightData& data, const std::string& owner) {
        const std::string kind = data.kind_of_ids(owner);
        return kind == "given" || kind == "ignore";
    }

    static void add_axes(EnsightData& data, Part& part, std::size_t count) {
        const auto x = data.reals(count, "x"), y = data.reals(count, "y"), z = data.reals(count, "z");
        part.found.points.reserve(count);
        for (std::size_t p = 0; p < count; ++p) add_point(part.found, {x[p], y[p], z[p]}, data.in().position());
    }

    static void read_points(EnsightData& data, Part& part, bool ids) {
        if (!part.found.points.empty()) data.fail("part " + in_quotes(part.name) + " has coordinates already");
        const std::size_t count = data.count("nodes");
        if (ids) std::ignore = data.integers(count, "numbers of nodes");
        add_axes(data, part, count);
    }

    void read_block(EnsightData& data, Part& part, const std::string& line) {
        if (!part.found.points.empty()) data.fail("part " + in_quotes(part.name) + " has coordinates already");
        const auto sizes = data.integers(3, "sizes of a block");
        if (std::ranges::any_of(sizes, [](std::int64_t size) { return size < 1 || size > 1 << 30; }))
            data.fail("the sizes of the block are out of range");
        const StructuredGrid grid{
            {static_cast<std::size_t>(sizes[0]), static_cast<std::size_t>(sizes[1]), static_cast<std::size_t>(sizes[2])}};
        const std::size_t points = grid.point_count(), cells = grid.cell_count();
        if (points == kNone || points > most_points(data.in().size()))
            data.fail("there are more points than the file can have values");
        named_.take({}, 0, points * kBytesOfBlockPoint, [&] { return data.place(); });
        part.structured = true;
        part.elements = cells;
        if (line.find("rectilinear") != std::string::npos || line.find("uniform") != std::string::npos) {
            std::array<std::vector<double>, 3> cuts;
            const bool uniform = line.find("uniform") != std::string::npos;
            const auto origin = uniform ? data.reals(6, "origin and spacing") : std::vector<double>();
            for (std::size_t a = 0; a < 3; ++a) {
                if (!uniform) cuts[a] = data.reals(grid.points[a], "planes");
                for (std::size_t i = 0; uniform && i < grid.points[a]; ++i)
                    cuts[a].push_back(origin[a] + static_cast<double>(i) * origin[3 + a]);
            }
            add_points(part.found, cuts, data.in().position());
        } else {
            add_axes(data, part, points);
        }
        std::vector<std::int64_t> blanks, ghosts;
        if (line.find("iblanked") != std::string::npos) blanks = data.integers(points, "blanks");
        if (line.find("with_ghost") != std::string::npos) {
            if (data.keyword() == "ghost_flags") ghosts = data.integers(cells, "ghost flags");
        }
        if (cells == 0) return;
        add_hexes(part.found, grid, 0, 0);
        auto& hexes = part.found.hexes;
        std::size_t kept = 0;
        for (std::size_t c = 0; c < cells; ++c) {
            const bool hidden =
                (!ghosts.empty() && ghosts[c] != 0) ||
                (!blanks.empty() && std::ranges::any_of(hexes.corners[c], [&](Index p) { return blanks[p] == 0; }));
            if (hidden) continue;
            hexes.corners[kept] = hexes.corners[c];
            hexes.numbers[kept++] = hexes.numbers[c];
        }
        hexes.corners.resize(kept);
        hexes.numbers.resize(kept);
        if (kept < cells)
            part.found.warnings.push_back(counted(cells - kept, "blanked or ghost cell", "blanked or ghost cells") +
                                          " left out");
    }

    void read_elements(EnsightData& data, Part& part, const std::string& line, bool ids) {
        const bool ghost = line.starts_with("g_");
        const std::string type = ghost ? line.substr(2) : line;
        const std::size_t nodes = nodes_of_ensight(type);
        if (nodes == 0 && type != "nsided" && type != "nfaced")
            data.fail("elements of type " + in_quotes(line) + " are not known");
        const std::size_t count = data.count("elements");
        if (ids) std::ignore = data.integers(count, "numbers of elements");
        const std::size_t first = part.elements;
        part.first_groups.try_emplace(line, part.groups.size());
        part.groups.push_back({line, first, count});
        part.elements += count;
        if (part.elements >= kNone) data.fail("there are too many elements");
        if (nodes == 0) {
            const auto counts = data.integers(count, "counts");
            std::vector<std::int64_t> corners;
            if (type == "nfaced") corners = data.integers(total(data, counts), "counts");
            const auto nodes_of = data.integers(total(data, type == "nfaced" ? corners : counts), "nodes");
            if (type == "nfaced" && !ghost) {
                add_polyhedra(data, part, first, counts, corners, nodes_of);
            } else {
                left_out_[line] += count;
            }
            return;
        }
        if (count > data.in().size() / nodes) data.fail("there are too many elements");
        const auto numbers = data.integers(count * nodes, "nodes of elements");
        if (ghost) {
            left_out_[line] += count;
            return;
        }
        std::vector<Index> corners(nodes);
        for (std::size_t e = 0; e < count; ++e) {
            for (std::size_t k = 0; k < nodes; ++k) {
                const std::int64_t node = numbers[e * nodes + k];
                if (node < 1 || static_cast<std::size_t>(node) > part.found.points.size()) {
                    data.fail(type + " " + std::to_string(e + 1) + " of part " + in_quotes(part.name) + ": there is no node " +
                                  std::to_string(node),
                              "nodes are 1 to " + std::to_string(part.found.points.size()));
                }
                corners[k] = static_cast<Index>(node - 1);
            }
            take(part.found, type, corners, first + e);
        }
    }

    static std::size_t total(const EnsightData& data, const std::vector<std::int64_t>& counts) {
        std::size_t sum = 0;
        for (const std::int64_t count : counts) {
            if (count < 0 || static_cast<std::size_t>(count) > data.in().size())
                data.fail("count out of range: " + std::to_string(count));
            sum += static_cast<std::size_t>(count);
        }
        return sum;
    }

    void take(MeshFile& into, const std::string& type, const std::vector<Index>& nodes, std::size_t number) {
        const bool others = options_.other_cells != OtherCells::Ignore;
        if (type.starts_with("hexa")) {
            const bool whole = nodes.size() == 20 && options_.curved_tolerance;
            put(into.hexes, nodes, number, whole);
            if (whole) into.curved.add(number, CurvedOrder::Vtk, nodes);
        } else if (type.starts_with("penta") && others) {
            put(into.prisms, nodes, number, false);
        } else if (type.starts_with("pyramid") && others) {
            put(into.pyramids, nodes, number, false);
        } else if (type.starts_with("tetra") && others) {
            put(into.tets, nodes, number, false);
        } else {
            ++left_out_[type];
        }
    }

    // counts: the faces of each cell; corners: the nodes of each face
    static void add_polyhedra(const EnsightData& data, Part& part, std::size_t first, const std::vector<std::int64_t>& counts,
                              const std::vector<std::int64_t>& corners, const std::vector<std::int64_t>& nodes) {
        std::size_t face = 0, at = 0;
        for (std::size_t e = 0; e < counts.size(); ++e) {
            CellFaces faces;
            for (std::int64_t f = 0; f < counts[e]; ++f) {
                auto& of_face = faces.emplace_back();
                for (std::int64_t k = 0; k < corners[face]; ++k) {
                    const std::int64_t node = nodes[at++];
                    if (node < 1 || static_cast<std::size_t>(node) > part.found.points.size()) {
                        data.fail("nfaced " + std::to_string(e + 1) + " of part " + in_quotes(part.name) +
                                  ": there is no node " + std::to_string(node));
                    }
                    of_face.push_back(static_cast<Index>(node - 1));
                }
                ++face;
            }
            part.polyhedra.add(first + e, std::move(faces));
        }
    }

    template <std::size_t N>
    void put(FileCells<N>& into, const std::vector<Index>& nodes, std::size_t number, bool whole) {
        curved_ += nodes.size() > N && !whole;
        std::copy_n(nodes.begin(), N, into.corners.emplace_back().begin());
        into.numbers.push_back(static_cast<Index>(number));
    }

    // A variable that cannot be read stops nothing but itself.
    void read_or_leave_out(const EnsightVariable& variable) {
        try {
            read_variable(variable);
        } catch (const Error& error) {
            unread_.push_back({variable.name, error.what()});
            for (auto& [number, part] : parts_) part.drop({variable.name, variable.at_cells});
        }
    }

    // A part that a variable lacks has not got it: the parts are joined without.
    void read_variable(const EnsightVariable& variable) {
        const EnsightStep step = checked(variable.files, time_);
        EnsightData given(step.path, form_, step.step);
        std::optional<EnsightData> gold;
        if (case_.six()) gold.emplace(six_.variable(given, variable.components, variable.at_cells), step.path.string());
        EnsightData& data = gold ? *gold : given;
        std::ignore = data.description();
        Part* part = nullptr;
        while (!data.at_end()) {
            const std::string line = data.keyword();
            if (line == "part") {
                const std::int64_t number = data.integer("the number of a part");
                const auto found = parts_.find(static_cast<int>(number));
                if (found == parts_.end()) data.fail("there is no part " + std::to_string(number));
                part = &found->second;
                continue;
            }
            if (part == nullptr) {
                if (line.empty()) continue;
                data.fail("a part is expected, not " + in_quotes(line));
            }
            read_values(data, variable, *part, line);
        }
    }

    void read_values(EnsightData& data, const EnsightVariable& variable, Part& part, const std::string& line) {
        const std::string place = line.substr(0, line.find(' '));
        std::size_t first = 0, count = part.found.points.size();
        if (variable.at_cells && place == "block") {
            count = part.elements;
        } else if (variable.at_cells) {
            const auto group = part.first_groups.find(place);
            if (group == part.first_groups.end())
                data.fail("part " + in_quotes(part.name) + " has no elements of type " + in_quotes(place));
            first = part.groups[group->second].first;
            count = part.groups[group->second].count;
        } else if (place != "coordinates" && place != "block") {
            data.fail("the values of a part are expected, not " + in_quotes(line));
        }
        // "undef" gives a mark that stands for no value, "partial" the places that have values.
        std::optional<double> mark;
        if (line.find("undef") != std::string::npos) mark = data.reals(1, "the mark of undefined values")[0];
        const bool partial = line.find("partial") != std::string::npos;
        std::vector<std::int64_t> places;
        if (partial) places = data.integers(data.count("places with values"), "places with values");
        for (const std::int64_t at : places) {
            if (at < 1 || static_cast<std::size_t>(at) > count) data.fail("there is no place " + std::to_string(at));
        }
        const std::size_t given = partial ? places.size() : count;
        const std::size_t all = variable.at_cells ? part.elements : count, components = variable.components;
        std::vector<std::vector<double>> values;
        for (std::size_t c = 0; c < components; ++c) values.push_back(data.reals(given, "values"));
        if (components == 6) std::swap(values[4], values[5]);  // xz comes before yz
        FileArray& array = array_of(data, variable, part, all);
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t i = 0; i < given; ++i) {
            const std::size_t at = first + (partial ? static_cast<std::size_t>(places[i] - 1) : i);
            for (std::size_t c = 0; c < components; ++c) {
                array.values[at * components + c] = mark == values[c][i] ? kNone : values[c][i];
            }
        }
    }

    FileArray& array_of(const EnsightData& data, const EnsightVariable& variable, Part& part, std::size_t all) {
        const std::size_t components = variable.components;
        const auto [known, is_new] = part.arrays.try_emplace({variable.name, variable.at_cells}, part.found.arrays.size());
        if (is_new) {
            named_.take({}, 0, all * components * sizeof(double), [&] { return data.place(); });
            part.found.arrays.push_back({variable.name, static_cast<int>(components), variable.at_cells, {}});
            part.found.arrays.back().values.assign(all * components, std::numeric_limits<double>::quiet_NaN());
        }
        FileArray& array = part.found.arrays[known->second];
        if (array.values.size() != all * components) data.fail("there is another variable of this name");
        return array;
    }

    std::string file_, text_;
    EnsightCase case_;
    ReadOptions options_;
    NamedFiles named_;
    EnsightSix six_;
    std::map<int, Part> parts_;
    std::map<std::string, std::size_t> left_out_;
    double time_ = 0;
    EnsightForm form_ = EnsightForm::Text;
    std::vector<UnreadField> unread_;
    std::size_t curved_ = 0;
};

}  // namespace

ReadResult read_ensight(const std::filesystem::path& path, const ReadOptions& options) {
    return EnsightReader(path, options).read();
}

std::vector<double> ensight_times(const std::filesystem::path& path) {
    const std::string text = read_text(path), file = path.string();
    return EnsightCase(text, file).times();
}

}  // namespace subvol::detail
