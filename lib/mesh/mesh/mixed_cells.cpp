// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/cell_splits.h"

#include <algorithm>
#include <compare>
#include <numeric>
#include <string>

#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

template <std::size_t N>
using Key = SplitKey<N>;

// of_slot: for each slot of a list of keys, the place of its key in `keys`
template <std::size_t N>
struct UniqueKeys {
    std::vector<Key<N>> keys;  // each once, sorted
    std::vector<Index> of_slot;
};

template <std::size_t N>
UniqueKeys<N> unique_keys(const std::vector<Key<N>>& slots, std::size_t point_count) {
    struct Record {
        Key<N> key;
        std::size_t slot;
        auto operator<=>(const Record&) const = default;
    };
    const auto sorted = bucket_sort<Record>(
        slots.size(), point_count,
        [&](std::size_t i, const auto& sink) {
            sink(Record{slots[i], i});
        },
        [](const Record& record) { return std::size_t{record.key[0]}; });
    UniqueKeys<N> result;
    result.of_slot.resize(slots.size());
    for (const Record& record : sorted.records) {
        if (result.keys.empty() || result.keys.back() != record.key) result.keys.push_back(record.key);
        result.of_slot[record.slot] = static_cast<Index>(result.keys.size() - 1);
    }
    return result;
}

class Splitter {
public:
    Splitter(std::size_t point_count, std::vector<std::array<Index, 8>>&& hexes, MixedCells&& others)
        : point_count_(point_count), hexes_(std::move(hexes)), others_(std::move(others)) {}

    HexSplit split() {
        collect(kHexShape, hexes_);
        collect(kTetShape, others_.tets);
        collect(kPrismShape, others_.prisms);
        edges_ = unique_keys(edge_slots_, point_count_);
        faces_ = unique_keys(face_slots_, point_count_);
        cells_ = unique_keys(cell_slots_, point_count_);
        refuse_twins();
        number_points();
        add_children_of(kHexShape, hexes_);
        add_children_of(kTetShape, others_.tets);
        add_children_of(kPrismShape, others_.prisms);
        return std::move(result_);
    }

private:
    template <class Shape, class Cells>
    void collect(const Shape& shape, const Cells& cells) {
        for (const auto& cell : cells) {
            each_key(
                shape, cell, [&](const Key<2>& key) { edge_slots_.push_back(key); },
                [&](const Key<4>& key) { face_slots_.push_back(key); }, [&](const Key<8>& key) { cell_slots_.push_back(key); });
        }
    }

    void refuse_twins() const {
        if (cells_.keys.size() == cell_slots_.size()) return;
        std::vector<std::uint8_t> seen(cells_.keys.size());
        for (const Index cell : cells_.of_slot) {
            if (seen[cell]++ > 0) refuse_twin(cells_.keys[cell]);
        }
    }

    void number_points() {
        new_points_.assign(point_count_, kNone);
        for (const auto& key : cells_.keys) {
            for (const Index p : key) {
                if (p != kNone) new_points_[p] = 0;
            }
        }
        for (Index p = 0; p < point_count_; ++p) {
            if (new_points_[p] != kNone) new_points_[p] = add_point(Key<1>{p});
        }
        first_edge_ = add_points(edges_.keys);
        first_face_ = add_points(faces_.keys);
        first_cell_ = add_points(cells_.keys);
    }

    template <std::size_t N>
    Index add_points(const std::vector<Key<N>>& keys) {
        const std::size_t first = result_.sources.size();
        if (first + keys.size() >= kNone) throw Error(ErrorCode::InvalidInput, kTooManyToSplit);
        for (const auto& key : keys) add_point(key);
        return static_cast<Index>(first);
    }

    template <std::size_t N>
    Index add_point(const Key<N>& of) {
        auto& [offsets, values] = result_.sources;
        values.insert(values.end(), of.begin(), std::find(of.begin(), of.end(), kNone));
        offsets.push_back(values.size());
        return static_cast<Index>(offsets.size() - 2);
    }

    // The slots are visited in the order in which `collect` filled them.
    template <class Shape, class Cells>
    void add_children_of(const Shape& shape, const Cells& cells) {
        std::vector<Index> edges(shape.edges.size()), faces(shape.faces.size());
        for (const auto& cell : cells) {
            for (Index& edge : edges) edge = first_edge_ + edges_.of_slot[edge_slot_++];
            for (Index& face : faces) face = first_face_ + faces_.of_slot[face_slot_++];
            SplitPoints<Shape::kCorners> points{{}, edges, faces, first_cell_ + cells_.of_slot[cell_slot_]};
            for (std::size_t v = 0; v < Shape::kCorners; ++v) points.corners[v] = new_points_[cell[v]];
            add_children(shape, points, result_.cells);
            result_.parents.insert(result_.parents.end(), Shape::kCorners, static_cast<Index>(cell_slot_++));
        }
    }

    std::size_t point_count_;
    std::vector<std::array<Index, 8>> hexes_;
    MixedCells others_;
    std::vector<Key<2>> edge_slots_;
    std::vector<Key<4>> face_slots_;
    std::vector<Key<8>> cell_slots_;
    UniqueKeys<2> edges_;
    UniqueKeys<4> faces_;
    UniqueKeys<8> cells_;
    std::vector<Index> new_points_;  // for each point, kNone if it is not used
    Index first_edge_ = 0, first_face_ = 0, first_cell_ = 0;
    std::size_t edge_slot_ = 0, face_slot_ = 0, cell_slot_ = 0;
    HexSplit result_;
};

template <std::size_t N>
void check(std::size_t point_count, const std::vector<std::array<Index, N>>& cells, const std::string& kind) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
        auto sorted = cells[c];
        std::sort(sorted.begin(), sorted.end());
        const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
        const std::string where = kind + " " + std::to_string(c);
        if (sorted.back() >= point_count) {
            throw Error(ErrorCode::InvalidInput, "there is no point " + std::to_string(sorted.back()), where);
        }
        if (twice != sorted.end()) {
            throw Error(ErrorCode::InvalidInput, "point " + std::to_string(*twice) + " is a corner twice", where);
        }
    }
}

}  // namespace

void refuse_twin(const SplitKey<8>& key) {
    std::string corners;
    for (const Index p : key) corners += p == kNone ? "" : " " + std::to_string(p);
    throw Error(ErrorCode::InvalidInput, "two cells have the same corners: points" + corners, "splitting into hexahedra",
                "points are counted from 0");
}

HexSplit plan_split(std::span<const Vec3> points, std::vector<std::array<Index, 8>> hexes, MixedCells others, bool cut_all) {
    check(points.size(), hexes, "hexahedron");
    check(points.size(), others.tets, "tetrahedron");
    check(points.size(), others.prisms, "prism");
    check(points.size(), others.pyramids, "pyramid");
    const std::size_t count = hexes.size() + others.tets.size() + others.prisms.size() + others.pyramids.size();
    if (count == 0) throw Error(ErrorCode::InvalidInput, "there is no cell to be split into hexahedra");
    if (points.size() >= kNone || count >= kNone / 8) {
        throw Error(ErrorCode::InvalidInput, kTooManyToSplit);
    }
    orient_mixed(points, hexes, others);
    if (others.pyramids.empty() && !cut_all) return Splitter(points.size(), std::move(hexes), std::move(others)).split();

    CutCells cut = cut_to_tets(hexes, others);
    MixedCells tets;
    tets.tets = std::move(cut.tets);
    HexSplit result = Splitter(points.size(), {}, std::move(tets)).split();
    for (Index& parent : result.parents) parent = cut.parents[parent];
    result.tets_cut = cut.parents.size();
    return result;
}

std::vector<Vec3> means(const IndexRows& sources, std::span<const Vec3> points) {
    std::vector<Vec3> result(sources.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        Vec3 sum(0);
        for (const Index p : sources[i]) sum += points[p];
        result[i] = sum / static_cast<double>(sources[i].size());
    }
    return result;
}

std::vector<double> means(const IndexRows& sources, std::span<const double> values, std::size_t channels) {
    std::vector<double> result(sources.size() * channels);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (std::size_t k = 0; k < channels; ++k) {
            double sum = 0;
            for (const Index p : sources[i]) sum += values[p * channels + k];
            result[i * channels + k] = sum / static_cast<double>(sources[i].size());
        }
    }
    return result;
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

HexMesh split_into_hexes(const HexMesh& hexes, const MixedCells& others) {
    if (!hexes.creases.empty() || !hexes.sharp_faces.empty()) {
        throw Error(ErrorCode::InvalidInput, "creases and sharp faces cannot be split with the cells");
    }
    for (const Attribute& attribute : hexes.attributes) {
        if (attribute.values.size() == hexes.points.size() * static_cast<std::size_t>(attribute.channels)) continue;
        throw Error(ErrorCode::InvalidInput, "its length is not that of the points", "attribute \"" + attribute.name + "\"");
    }
    HexSplit split = plan_split(hexes.points, hexes.cells, others);
    HexMesh result;
    result.points = means(split.sources, hexes.points);
    result.cells = std::move(split.cells);
    for (const Attribute& attribute : hexes.attributes) {
        result.attributes.push_back({attribute.name, attribute.channels,
                                     means(split.sources, attribute.values, static_cast<std::size_t>(attribute.channels))});
    }
    return result;
}

}  // namespace subvol
