// SPDX-License-Identifier: Apache-2.0
// Replaces every hexahedron of a mesh with curved ones by a grid of smaller, straight ones, with points on the curved shape.
//
//     layouts   degrees and order of the nodes of each cell; a cell that is not curved has degree 1
//     ranges    the size of the mesh, and the range of each array; constants and whole numbers do not count
//     bends     for each cell and axis, how far the shape and the fields are from straight, in parts of these ranges
//     pieces    numbers of pieces along each class of edges, so that the errors of shape and fields are within the tolerance
//     fill      each cell is evaluated at its grid; a point that a neighbour has made already is taken from there
//
// Arrays at points are evaluated with the same polynomials as the shape. If no edge needs a second piece, the corners alone
// are used. Beside cells of other kinds, with sharp groups or with repeated points, curved cells are not split, and a warning
// says so.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>

#include "assemble.h"
#include "curved_cells.h"
#include "curved_pieces.h"
#include "subvol/cell.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Hex = std::array<Index, 8>;
using Sizes = std::array<std::size_t, 3>;

constexpr std::string_view kDegrees = "HigherOrderDegrees";
constexpr std::string_view kWeights = "RationalWeights";

// No more hexahedra than this are made, or than this for each piece between the nodes of the file where that is more. Limits of
// as many cells as there are pieces between nodes are about as near to smooth fields as the file's polynomials; a shape that
// needs more in one direction takes the rest.
constexpr std::size_t kMostHexes = std::size_t{1} << 16, kMostPerNode = 2;

class CurvedSplit {
public:
    CurvedSplit(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names)
        : found_(found), tolerance_(tolerance), file_(file), names_(names), cells_(found.hexes.corners), edges_(cells_) {}

    CurvedReport run() {
        find_channels();
        find_layouts();
        refuse_weights();
        find_ranges();
        measure();
        pieces_ = choose_pieces(cells_, edges_, bends_, tolerance_, most_hexes());
        const CurvedReport report = report_of_pieces();
        if (report.split()) {
            fill();
            found_.warnings.push_back(text_of(report));
            found_.hexes = std::move(new_hexes_);
        } else {
            report_straight();
        }
        return report;
    }

private:
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const {
        throw Error(ErrorCode::InvalidInput, message, std::string(file_), allowed);
    }

    // The channels of a node: three coordinates, the arrays at the points, and its weight.
    void find_channels() {
        const FileArray* weights = find_array(found_, kWeights, false, 1);
        if (weights != nullptr) weights_ = weights->values;
        degrees_ = find_array(found_, kDegrees, true, 3);
        for (const FileArray& array : found_.arrays) {
            if (array.at_cells || &array == weights) continue;
            arrays_.push_back(&array);
            channels_ += static_cast<std::size_t>(array.components);
        }
    }

    void find_layouts() {
        std::unordered_map<Index, std::size_t> places;
        for (std::size_t k = 0; k < found_.curved.size(); ++k) places.emplace(found_.curved.numbers[k], k);
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const auto place = places.find(found_.hexes.numbers[c]);
            curved_.push_back(place == places.end() ? kNone : static_cast<Index>(place->second));
            const bool curved = curved_.back() != kNone;
            curved_count_ += curved;
            const CurvedOrder order = curved ? found_.curved.orders[curved_.back()] : CurvedOrder::Vtk;
            const std::size_t nodes = nodes_of(c).size();
            const Sizes degrees = curved ? degrees_of(c, order, nodes) : Sizes{1, 1, 1};
            auto& layout = layouts_[{order, degrees, nodes}];
            if (layout.slots.empty()) layout = curved_layout(order, degrees, nodes);
            layout_of_.push_back(&layout);
        }
    }

    [[nodiscard]] std::span<const Index> nodes_of(std::size_t c) const {
        return curved_[c] == kNone ? std::span<const Index>(cells_[c]) : found_.curved.nodes_of(curved_[c]);
    }

    [[nodiscard]] Sizes degrees_of(std::size_t c, CurvedOrder order, std::size_t nodes) const {
        const std::size_t number = found_.hexes.numbers[c];
        Sizes degrees{};
        const auto uniform = uniform_degree(order, nodes);
        if (degrees_ != nullptr && order != CurvedOrder::Exodus && order != CurvedOrder::Gmsh) {
            std::string list;
            std::size_t needed = 1;
            for (std::size_t a = 0; a < 3; ++a) {
                const double degree = degrees_->values[3 * number + a];
                list += " " + number_text(degree);
                const bool valid = degree >= 1 && degree <= static_cast<double>(kMostDegree) && degree == std::floor(degree);
                degrees[a] = valid ? static_cast<std::size_t>(degree) : 0;
                needed *= valid ? degrees[a] + 1 : 0;
            }
            if (needed == nodes) return degrees;
            // A file with cells of several kinds has zeros at those that need no degrees, or 2 at quadratic ones.
            if ((list != " 0 0 0" && list != " 2 2 2") || !uniform) {
                fail(names_.cell(number) + " has " + std::to_string(nodes) + " points, but the degrees" + list + " in " +
                         in_quotes(kDegrees),
                     "(p + 1)(q + 1)(r + 1) points for degrees p, q, r from 1 to " + std::to_string(kMostDegree));
            }
        }
        if (!uniform) {
            fail(
                names_.cell(number) + " has " + std::to_string(nodes) + " points, and there is no array " + in_quotes(kDegrees),
                "without it a curved hexahedron has (p + 1)³ points, p from 1 to " + std::to_string(kMostDegree));
        }
        return {*uniform, *uniform, *uniform};
    }

    void refuse_weights() const {
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            for (const Index p : nodes_of(c)) {
                if (!is_rational(c) || (weights_[p] > 0 && std::isfinite(weights_[p]))) continue;
                fail("the rational weight of " + names_.point(p) + " is " + number_text(weights_[p]), "a positive number");
            }
        }
    }

    [[nodiscard]] std::size_t most_hexes() const {
        std::size_t between_nodes = 0;
        for (const CurvedLayout* layout : layout_of_) {
            between_nodes += layout->degrees[0] * layout->degrees[1] * layout->degrees[2];
        }
        return std::max(kMostHexes, kMostPerNode * between_nodes);
    }

    [[nodiscard]] bool is_rational(std::size_t c) const { return layout_of_[c]->bezier && !weights_.empty(); }

    // The size of the mesh, and for each array the length of the vector of its components' ranges; 0 for a constant, and for
    // whole numbers: they are the numbers of nodes or parts, and no smooth field that more cells would come nearer to.
    void find_ranges() {
        std::vector<double> low(channels_, std::numeric_limits<double>::infinity()), high(channels_, -low[0]);
        std::vector<std::uint8_t> whole(channels_, 1);
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            for (const Index p : nodes_of(c)) {
                values_of_node(p);
                for (std::size_t k = 0; k < channels_; ++k) {
                    if (std::isnan(node_[k])) continue;  // a field with gaps
                    low[k] = std::min(low[k], node_[k]);
                    high[k] = std::max(high[k], node_[k]);
                    if (node_[k] != std::floor(node_[k])) whole[k] = 0;
                }
            }
        }
        std::size_t first = 0;
        const auto add = [&](std::size_t count) {
            double sum = 0, largest = 0;
            bool counts = first == 0;
            for (std::size_t k = first; k < first + count; ++k) {
                counts = counts || whole[k] == 0;
                sum += (high[k] - low[k]) * (high[k] - low[k]);
                largest = std::max({largest, std::abs(low[k]), std::abs(high[k])});
            }
            const double range = std::sqrt(sum);
            groups_.push_back({first, count, counts && range > 1e-9 * largest ? range : 0});
            first += count;
        };
        add(3);
        for (const FileArray* array : arrays_) add(static_cast<std::size_t>(array->components));
    }

    void values_of_node(Index p) {
        node_.clear();
        for (int a = 0; a < 3; ++a) node_.push_back(found_.points[p][a]);
        for (const FileArray* array : arrays_) {
            const auto components = static_cast<std::size_t>(array->components);
            for (std::size_t k = 0; k < components; ++k) node_.push_back(array->values[p * components + k]);
        }
    }

    [[nodiscard]] CurvedCell shape_of(std::size_t c) {
        std::vector<double> values;
        for (const Index p : nodes_of(c)) {
            values_of_node(p);
            values.insert(values.end(), node_.begin(), node_.end());
            if (is_rational(c)) values.push_back(weights_[p]);
        }
        return {*layout_of_[c], values, channels_ + (is_rational(c) ? 1 : 0), is_rational(c)};
    }

    void measure() {
        bends_.resize(cells_.size());
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const CurvedCell cell = shape_of(c);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                bends_[c].degrees[axis] = static_cast<std::uint8_t>(layout_of_[c]->degrees[axis]);
                if (cell.is_straight(axis)) continue;
                const auto samples = cell.samples(axis);
                for (const Group& group : groups_) {
                    if (group.range == 0) continue;
                    const auto bend = static_cast<float>(cell.bend(axis, samples, group.first, group.count) / 8 / group.range);
                    float& largest = (group.first == 0 ? bends_[c].shape : bends_[c].fields)[axis];
                    largest = std::max(largest, bend);
                }
            }
        }
    }

    void fill() {
        const SplitGrids grids(cells_, edges_, pieces_.of_class, found_.points.size());
        if (grids.point_count() >= kNone) fail("its curved cells would be split into too many hexahedra", "a larger tolerance");
        std::vector<Vec3> points(grids.point_count());
        std::vector<std::vector<double>> values;
        for (const FileArray* array : arrays_) values.emplace_back(points.size() * static_cast<std::size_t>(array->components));
        std::vector<std::uint8_t> filled(points.size());
        FileCells<8> hexes;
        const bool with_carriers = !found_.patches.empty() || !found_.node_sets.empty();
        std::vector<std::vector<Index>> carriers(with_carriers ? points.size() : 0);
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const Sizes n = pieces_.of_cell(c);
            const auto grid = grids.grid_of(c);
            const auto at_grid = shape_of(c).at_grid(n);
            for (std::size_t i = 0; i < grid.size(); ++i) {
                const Index p = grid[i];
                if (filled[p] != 0) {  // by a neighbour, which may lack a field
                    fill_gaps(&at_grid[i * channels_ + 3], p, values);
                    continue;
                }
                filled[p] = 1;
                if (with_carriers) carriers[p] = carrier_in(cells_[c], n, i);
                const double* from = &at_grid[i * channels_];
                points[p] = {from[0], from[1], from[2]};
                from += 3;
                for (std::size_t a = 0; a < arrays_.size(); ++a) {
                    const auto components = static_cast<std::size_t>(arrays_[a]->components);
                    std::copy_n(from, components, &values[a][p * components]);
                    from += components;
                }
            }
            add_hexes(hexes, grid, n, found_.hexes.numbers[c]);
        }
        found_.points = std::move(points);
        for (const auto& carrier : carriers) {
            found_.carriers.values.insert(found_.carriers.values.end(), carrier.begin(), carrier.end());
            found_.carriers.offsets.push_back(found_.carriers.values.size());
        }
        std::size_t next = 0;
        for (FileArray& array : found_.arrays) {
            if (next < arrays_.size() && &array == arrays_[next]) array.values = std::move(values[next++]);
        }
        std::erase_if(found_.arrays, [](const FileArray& array) {
            return array.at_cells ? array.name == kDegrees && array.components == 3
                                  : array.name == kWeights && array.components == 1;
        });
        new_hexes_ = std::move(hexes);
    }

    // from: the values of the arrays at point p in a cell
    void fill_gaps(const double* from, Index p, std::vector<std::vector<double>>& values) const {
        for (std::size_t a = 0; a < arrays_.size(); ++a) {
            const auto components = static_cast<std::size_t>(arrays_[a]->components);
            if (std::isnan(values[a][p * components])) std::copy_n(from, components, &values[a][p * components]);
            from += components;
        }
    }

    // The corners of the smallest edge, face or cell that place i of the grid of a cell lies on.
    static std::vector<Index> carrier_in(const Hex& cell, const Sizes& n, std::size_t i) {
        const Sizes at{i % (n[0] + 1), i / (n[0] + 1) % (n[1] + 1), i / (n[0] + 1) / (n[1] + 1)};
        std::vector<Index> carrier;
        for (std::size_t k = 0; k < 8; ++k) {
            bool near = true;
            for (std::size_t a = 0; a < 3; ++a) near = near && at[a] != (kCornerParameters[k][a] == 0 ? n[a] : 0);
            if (near) carrier.push_back(cell[k]);
        }
        return carrier;
    }

    static void add_hexes(FileCells<8>& hexes, const std::vector<Index>& grid, const Sizes& n, Index number) {
        for (std::size_t z = 0; z < n[2]; ++z) {
            for (std::size_t y = 0; y < n[1]; ++y) {
                for (std::size_t x = 0; x < n[0]; ++x) {
                    auto& hex = hexes.corners.emplace_back();
                    for (std::size_t k = 0; k < 8; ++k) {
                        const auto& at = kCornerParameters[k];
                        const std::size_t i = x + static_cast<std::size_t>(at[0]), j = y + static_cast<std::size_t>(at[1]);
                        hex[k] = grid[i + (n[0] + 1) * (j + (n[1] + 1) * (z + static_cast<std::size_t>(at[2])))];
                    }
                    hexes.numbers.push_back(number);
                }
            }
        }
    }

    static std::string short_text(double value) {
        std::array<char, 32> text{};
        const auto [end, error] =
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 1);
        return {text.data(), end};
    }

    void report_straight() {
        found_.warnings.push_back(counted(curved_count_, "curved cell", "curved cells") +
                                  (curved_count_ == 1 ? " is" : " are") + " straight to within " + short_text(tolerance_) +
                                  " of the mesh's size: only the corners are used");
    }

    [[nodiscard]] bool has_fields() const {
        return std::any_of(groups_.begin() + 1, groups_.end(), [](const Group& group) { return group.range > 0; });
    }

    [[nodiscard]] CurvedReport report_of_pieces() const {
        CurvedReport report{curved_count_, cells_.size(), pieces_.hexes, pieces_.most_hexes, tolerance_};
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const Sizes n = pieces_.of_cell(c);
            double of_shape = 0, of_fields = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                of_shape += bends_[c].shape[a] / static_cast<double>(n[a] * n[a]);
                of_fields += fields_error(bends_[c].fields[a], bends_[c].degrees[a], n[a]);
            }
            report.shape_error = std::max(report.shape_error, of_shape);
            report.fields_error = std::max(report.fields_error, of_fields);
        }
        report.limited = pieces_.limited;
        return report;
    }

    [[nodiscard]] std::string text_of(const CurvedReport& report) const {
        std::string text = counted(curved_count_, "curved cell", "curved cells");
        if (curved_count_ < cells_.size()) {
            text += " and " + counted(cells_.size() - curved_count_, "other", "others");
        }
        text += " split into " + counted(report.hexes, "hexahedron", "hexahedra") +
                " with points on the curved shape, which is within " + short_text(report.shape_error) + " of the mesh's size";
        if (has_fields()) text += ", its fields within " + short_text(report.fields_error) + " of their ranges";
        if (report.limited) {
            text += "; for a tolerance of " + short_text(tolerance_) + " there would be more than " +
                    std::to_string(report.most_hexes);
        }
        return text;
    }

    struct Group {
        std::size_t first, count;
        double range;
    };
    using LayoutKey = std::tuple<CurvedOrder, Sizes, std::size_t>;

    MeshFile& found_;
    double tolerance_;
    std::string_view file_;
    const EntityNames& names_;
    const std::vector<Hex>& cells_;
    EdgeClasses edges_;
    std::vector<double> weights_;
    const FileArray* degrees_ = nullptr;
    std::vector<const FileArray*> arrays_;
    std::size_t channels_ = 3;
    std::vector<double> node_;   // the channels of the node that was asked for last
    std::vector<Index> curved_;  // the place of each cell among the curved ones, or kNone
    std::size_t curved_count_ = 0;
    std::map<LayoutKey, CurvedLayout> layouts_;
    std::vector<const CurvedLayout*> layout_of_;
    std::vector<Group> groups_;
    std::vector<CellBend> bends_;
    CurvedPieces pieces_;
    FileCells<8> new_hexes_;
};

// Leaves out the arrays at points of which no cell has a value at all of its nodes. Others keep their gaps.
void drop_unusable_fields(MeshFile& found, const EntityNames& names) {
    std::vector<std::uint8_t> used = used_points(found);
    for (const Index p : found.curved.nodes) used[p] = 1;
    std::erase_if(found.arrays, [&](FileArray& array) {
        const auto components = static_cast<std::size_t>(array.components);
        if (array.at_cells || array.name == kWeights) return false;  // weights are refused, as they change the shape
        std::optional<std::size_t> gap;
        for (std::size_t i = 0; i < array.values.size(); ++i) {
            if (std::isfinite(array.values[i]) || !used[i / components]) continue;
            if (!gap) gap = i / components;
            array.values[i] = std::numeric_limits<double>::quiet_NaN();
        }
        if (!gap) return false;
        const auto has_value = [&](Index p) {
            return std::ranges::none_of(std::span(array.values).subspan(p * components, components),
                                        [](double value) { return std::isnan(value); });
        };
        const auto has_values = [&](std::span<const Index> nodes) { return std::ranges::all_of(nodes, has_value); };
        std::unordered_map<Index, std::size_t> places;
        for (std::size_t k = 0; k < found.curved.size(); ++k) places.emplace(found.curved.numbers[k], k);
        for (std::size_t c = 0; c < found.hexes.corners.size(); ++c) {
            const auto place = places.find(found.hexes.numbers[c]);
            if (has_values(place == places.end() ? std::span<const Index>(found.hexes.corners[c])
                                                 : found.curved.nodes_of(place->second)))
                return false;
        }
        found.unread.push_back(
            {array.name, "the value at " + names.point(*gap) + " is not finite, and no cell has it at all nodes"});
        return true;
    });
}

bool repeats_point(Hex hex) {
    std::sort(hex.begin(), hex.end());
    return std::adjacent_find(hex.begin(), hex.end()) != hex.end();
}

}  // namespace

std::optional<CurvedReport> split_curved(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names) {
    if (found.curved.size() == 0) return std::nullopt;
    const bool others = !found.tets.corners.empty() || !found.prisms.corners.empty() || !found.pyramids.corners.empty();
    const char* reason = others                                                    ? "beside cells of other kinds"
                         : !found.sharp.empty()                                    ? "with sharp groups"
                         : std::ranges::any_of(found.hexes.corners, repeats_point) ? "in a mesh with repeated points"
                                                                                   : nullptr;
    if (reason != nullptr) {
        found.warnings.push_back(counted(found.curved.size(), "curved cell", "curved cells") + " " + reason +
                                 ": only the corners are used");
        return std::nullopt;
    }
    drop_unusable_fields(found, names);
    return CurvedSplit(found, tolerance, file, names).run();
}

}  // namespace subvol::detail
