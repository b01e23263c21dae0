// SPDX-License-Identifier: Apache-2.0
#include "piece_tables.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <compare>
#include <optional>
#include <tuple>

#include "assemble.h"
#include "subvol/detail/cell_splits.h"
#include "subvol/detail/spill_file.h"
#include "subvol/error.h"

// Tetrahedra, prisms and pyramids of a mesh in tables become hexahedra: each cell gets a point at its centre, and one for each
// of its edges and faces. Cells that share an edge or a face must share its new point, although they lie far apart in the file:
//
//      chunk of cells ──▶ keys: the sorted corners of each edge, face, cell ──▶ buckets in files, by key
//      bucket, sorted ──▶ equal keys get one number, which goes back to the chunks that asked, again in buckets
//      chunk of cells ──▶ hexahedra with the numbers of their new points
//
// Numbers are given in the order in which the whole mesh in memory would give them, so that the bricks have its bits.

namespace subvol::detail {

namespace {

constexpr std::size_t kCellsToSplit = std::size_t{1} << 16;   // that are split together
constexpr std::size_t kKeysOfBucket = std::size_t{1} << 18;   // that are sorted together, about
constexpr std::size_t kPointsToWrite = std::size_t{1} << 16;  // that are written together

/// A key with the chunk of cells that has it, and its place among the keys of the chunk. Sorted by key first: equal keys then
/// stand together, in the order of the cells that have them.
template <std::size_t N>
struct KeyRecord {
    SplitKey<N> key;
    Index chunk;
    Index slot;
    auto operator<=>(const KeyRecord&) const = default;
};

/// The number of a new point, for the slot of a chunk.
struct SlotNumber {
    Index slot;
    Index number;
};

/// The keys of the edges, the faces or the cells, and their numbers.
template <std::size_t N>
struct KeyTables {
    std::optional<SpillBuckets<KeyRecord<N>>> keys;
    std::optional<SpillBuckets<SlotNumber>> numbers;
};

/// Some right-handed cells of one kind, maybe cut into tetrahedra. parents: of each, its number in the tables
struct CellChunk {
    std::vector<std::array<Index, 8>> hexes;
    MixedCells others;
    std::vector<Index> parents;
    std::size_t turned = 0;  // hexahedra
};

template <class Call>
void each_shape(const CellChunk& chunk, const Call& call) {
    call(kHexShape, chunk.hexes);
    call(kTetShape, chunk.others.tets);
    call(kPrismShape, chunk.others.prisms);
}

class TableSplitter {
public:
    TableSplitter(PieceTables& mixed, const std::string& list, std::filesystem::path folder, Progress* progress)
        : mixed_(mixed), list_(list), folder_(std::move(folder)), progress_(progress) {
        cuts_ = mixed.cut || mixed.counts.pyramids > 0;
    }

    std::unique_ptr<PieceTables> run() {
        make_tables();
        collect();
        write_corner_points();
        number(edges_);
        number(faces_);
        number(centers_);
        if (twin_) refuse();
        // Corners come first, then the points of edges, faces and cells, each in the order of their keys. This is the order of
        // the split in memory.
        split_->points = next_point_;
        split_->used.resize(next_point_);
        for (std::uint64_t p = 0; p < next_point_; ++p) split_->used.set(static_cast<Index>(p));
        split_->used.count();
        write_children();
        finish();
        return std::move(split_);
    }

private:
    void make_tables() {
        split_ = std::make_unique<PieceTables>(folder_);
        split_->arrays = mixed_.arrays;
        for (const bool at_cells : {false, true}) {
            if (!(at_cells ? mixed_.cell_values : mixed_.point_values)) continue;
            (at_cells ? split_->cell_values : split_->point_values) =
                std::make_unique<SpillFile>(folder_, mixed_.components(at_cells) * sizeof(double));
        }
    }

    // Calls call(chunk, its number) for all cells: first the hexahedra, then the tetrahedra, prisms and pyramids.
    template <class Call>
    void each_chunk(double progress, const Call& call) const {
        // The kinds have different numbers of corners, by which a record is recognized. Each kind is one pass over the table,
        // since the split in memory goes through the kinds in this order.
        const std::array<std::size_t, 4> corners{8, 4, 6, 5};
        const std::array<std::size_t, 4> counts{mixed_.counts.hexes, mixed_.counts.tets, mixed_.counts.prisms,
                                                mixed_.counts.pyramids};
        Index number = 0;
        std::vector<std::array<Index, 8>> cells;
        for (std::size_t kind = 0; kind < 4; ++kind) {
            for (std::uint64_t begin = 0; counts[kind] > 0 && begin < mixed_.cells; begin += kCellsToSplit) {
                const double part = static_cast<double>(begin) / static_cast<double>(mixed_.cells);
                report_progress(progress_, "cut", progress + 0.25 * (static_cast<double>(kind) + part) / 4);
                cells.resize(std::min<std::uint64_t>(kCellsToSplit, mixed_.cells - begin));
                mixed_.corners.read(begin, records_of(cells));
                CellChunk chunk;
                std::vector<std::array<Index, 8>> chosen;
                for (std::size_t c = 0; c < cells.size(); ++c) {
                    const auto end = std::ranges::find(cells[c], kNone);
                    if (static_cast<std::size_t>(end - cells[c].begin()) != corners[kind]) continue;
                    chosen.push_back(cells[c]);
                    chunk.parents.push_back(static_cast<Index>(begin + c));
                }
                if (chosen.empty()) continue;
                fill(chunk, chosen, corners[kind]);
                call(chunk, number++);
            }
        }
    }

    // Numbers are those of the points of these cells, in the same order, while they are turned and cut.
    void fill(CellChunk& chunk, const std::vector<std::array<Index, 8>>& cells, std::size_t count) const {
        const CornersOfCells corners(cells);
        std::vector<Vec3> points(corners.points().size());
        mixed_.coordinates.read_some(corners.points(), records_of(points));
        // Corners become places among the points of this chunk, whose coordinates alone are in memory; give_back turns the
        // places into numbers again.
        const auto take = [&](auto& to) {
            to.resize(cells.size());
            for (std::size_t c = 0; c < cells.size(); ++c) {
                for (std::size_t k = 0; k < count; ++k) to[c][k] = corners.place(cells[c][k]);
            }
        };
        if (count == 8) take(chunk.hexes);
        if (count == 4) take(chunk.others.tets);
        if (count == 6) take(chunk.others.prisms);
        if (count == 5) take(chunk.others.pyramids);
        orient_mixed(points, chunk.hexes, chunk.others);
        for (std::size_t c = 0; c < chunk.hexes.size(); ++c) chunk.turned += chunk.hexes[c][0] != corners.place(cells[c][0]);
        if (cuts_) {
            CutCells cut = cut_to_tets(chunk.hexes, chunk.others);
            for (Index& parent : cut.parents) parent = chunk.parents[parent];
            chunk = {{}, {std::move(cut.tets), {}, {}}, std::move(cut.parents), chunk.turned};
        }
        const auto give_back = [&](auto& all) {
            for (auto& cell : all) {
                for (Index& p : cell) p = corners.points()[p];
            }
        };
        give_back(chunk.hexes);
        give_back(chunk.others.tets);
        give_back(chunk.others.prisms);
    }

    [[nodiscard]] std::uint64_t edge_count() const {
        const CellCounts& n = mixed_.counts;
        // Upper bounds: an edge that several cells share is counted for each of them. They only decide how many buckets there
        // are and how far the work has come.
        return cuts_ ? 6 * tet_count() : 12 * n.hexes + 6 * n.tets + 9 * n.prisms;
    }
    [[nodiscard]] std::uint64_t tet_count() const {
        const CellCounts& n = mixed_.counts;
        return 6 * n.hexes + n.tets + 3 * n.prisms + 2 * n.pyramids;
    }

    void collect() {
        if (mixed_.cells >= kNone / 8) throw Error(ErrorCode::InvalidInput, kTooManyToSplit, list_);
        // There are fewer faces than edges, and fewer cells than faces, so the edges alone decide about the buckets.
        const std::size_t buckets = edge_count() / kKeysOfBucket + 1;
        edges_.keys.emplace(folder_, buckets);
        faces_.keys.emplace(folder_, buckets);
        centers_.keys.emplace(folder_, buckets);
        const auto sink = [&](auto& to, Index chunk, Index& slot) {
            return [&, chunk](const auto& key) {
                // Buckets are ranges of the smallest corner, so that going through them one by one goes through all keys in
                // ascending order.
                const auto bucket = static_cast<std::size_t>(std::uint64_t{key[0]} * buckets / mixed_.points);
                to.keys->add(bucket, {key, chunk, slot++});
            };
        };
        chunks_ = 0;
        each_chunk(0, [&](const CellChunk& chunk, Index number) {
            Index edge = 0, face = 0, center = 0;
            each_shape(chunk, [&](const auto& shape, const auto& cells) {
                for (const auto& cell : cells) {
                    each_key(shape, cell, sink(edges_, number, edge), sink(faces_, number, face),
                             sink(centers_, number, center));
                }
            });
            tets_cut_ += cuts_ ? chunk.others.tets.size() : 0;
            turned_ += chunk.turned;
            chunks_ = std::size_t{number} + 1;
        });
    }

    // The points of cells, in their order.
    void write_corner_points() {
        std::vector<SplitKey<1>> keys;
        for (std::uint64_t p = 0; p < mixed_.points; ++p) {
            if (mixed_.used[static_cast<Index>(p)]) keys.push_back({static_cast<Index>(p)});
            if (keys.size() < kPointsToWrite && p + 1 < mixed_.points) continue;
            write_points(keys);
            keys.clear();
        }
    }

    // Gives numbers to the keys of a kind, bucket by bucket: equal keys get one number, which is sent to every slot that asked
    // for it. Then writes the points that belong to the keys.
    template <std::size_t N>
    void number(KeyTables<N>& tables) {
        tables.numbers.emplace(folder_, chunks_);
        for (std::size_t bucket = 0; bucket < tables.keys->size(); ++bucket) {
            report_progress(progress_, "cut",
                            0.25 + 0.5 * static_cast<double>(next_point_) / static_cast<double>(most_points()));
            std::vector<KeyRecord<N>> records = tables.keys->take(bucket);
            tbb::parallel_sort(records.begin(), records.end());
            std::vector<SplitKey<N>> keys;
            for (const KeyRecord<N>& record : records) {
                const bool is_new = keys.empty() || keys.back() != record.key;
                if (is_new) keys.push_back(record.key);
                // Only the keys of cells are that long. Two cells with the same corners lie upon each other, which is an error.
                if constexpr (N == 8) {
                    if (!is_new) note_twin(record);
                }
                tables.numbers->add(record.chunk, {record.slot, static_cast<Index>(next_point_ + keys.size() - 1)});
            }
            write_points(keys);
        }
        tables.keys.reset();
    }

    [[nodiscard]] std::uint64_t most_points() const { return mixed_.points + 2 * edge_count(); }

    // The first cell that has the corners of another is said.
    void note_twin(const KeyRecord<8>& record) {
        if (!twin_ || std::tuple(record.chunk, record.slot) < std::tuple(twin_->chunk, twin_->slot)) twin_ = record;
    }
    [[noreturn]] void refuse() const {
        try {
            refuse_twin(twin_->key);
        } catch (const Error& error) {
            throw Error(error.code(), error.what(), list_);
        }
    }

    // Points in the middle of others, with the next numbers.
    template <std::size_t N>
    void write_points(const std::vector<SplitKey<N>>& keys) {
        if (next_point_ + keys.size() >= kNone) throw Error(ErrorCode::InvalidInput, kTooManyToSplit, list_);
        if (keys.empty()) return;
        const CornersOfCells corners(keys);
        IndexRows sources;
        for (const SplitKey<N>& key : keys) {
            for (const Index p : key) {
                if (p != kNone) sources.values.push_back(corners.place(p));
            }
            sources.offsets.push_back(sources.values.size());
        }
        std::vector<Vec3> points(corners.points().size());
        mixed_.coordinates.read_some(corners.points(), records_of(points));
        split_->coordinates.write(next_point_, records_of(means(sources, points)));
        if (mixed_.point_values) {
            const std::size_t components = mixed_.components(false);
            std::vector<double> values(points.size() * components);
            mixed_.point_values->read_some(corners.points(), records_of(values));
            split_->point_values->write(next_point_, records_of(means(sources, values, components)));
        }
        next_point_ += keys.size();
    }

    template <std::size_t N>
    [[nodiscard]] static std::vector<Index> numbers_of(KeyTables<N>& tables, Index chunk) {
        const std::vector<SlotNumber> records = tables.numbers->take(chunk);
        std::vector<Index> numbers(records.size());
        for (const auto& [slot, number] : records) numbers[slot] = number;
        return numbers;
    }

    void write_children() {
        each_chunk(0.75, [&](const CellChunk& chunk, Index number) {
            const std::vector<Index> edges = numbers_of(edges_, number), faces = numbers_of(faces_, number),
                                     centers = numbers_of(centers_, number);
            // Slots were counted up in the order of the cells, so the numbers are used up from the front in the same order.
            std::span<const Index> edges_left = edges, faces_left = faces;
            std::vector<std::array<Index, 8>> children;
            std::vector<std::size_t> child_counts;
            each_shape(chunk, [&]<class Shape>(const Shape& shape, const auto& cells) {
                for (std::size_t c = 0; c < cells.size(); ++c) {
                    SplitPoints<Shape::kCorners> points{
                        {}, edges_left.first(shape.edges.size()), faces_left.first(shape.faces.size()), centers[c]};
                    for (std::size_t k = 0; k < Shape::kCorners; ++k) {
                        // Points that no cell uses have no number in the result: a corner's number is how many used points come
                        // before it.
                        points.corners[k] = static_cast<Index>(mixed_.used.count_before(cells[c][k]));
                    }
                    add_children(shape, points, children);
                    child_counts.push_back(Shape::kCorners);
                    edges_left = edges_left.subspan(shape.edges.size());
                    faces_left = faces_left.subspan(shape.faces.size());
                }
            });
            if (split_->cells + children.size() >= kNone) throw Error(ErrorCode::InvalidInput, kTooManyToSplit, list_);
            split_->corners.write(split_->cells, records_of(children));
            if (mixed_.cell_values) write_cell_values(chunk.parents, child_counts);
            split_->cells += children.size();
        });
    }

    // Each child has the values of its parent.
    void write_cell_values(const std::vector<Index>& parents, const std::vector<std::size_t>& child_counts) {
        std::vector<Index> different = parents;
        different.erase(std::unique(different.begin(), different.end()), different.end());
        const std::size_t components = mixed_.components(true);
        std::vector<double> values(different.size() * components), of_children;
        mixed_.cell_values->read_some(different, records_of(values));
        std::size_t place = 0;
        for (std::size_t c = 0; c < parents.size(); ++c) {
            if (different[place] != parents[c]) ++place;
            const auto first = values.data() + place * components;
            for (std::size_t k = 0; k < child_counts[c]; ++k) {
                of_children.insert(of_children.end(), first, first + components);
            }
        }
        split_->cell_values->write(split_->cells, records_of(of_children));
    }

    void finish() {
        split_->turned = true;
        split_->counts.hexes = split_->cells;
        split_->hash = mixed_.hash;
        split_->warnings = std::move(mixed_.warnings);
        if (turned_ > 0) split_->warnings.push_back(cells_turned(turned_, mixed_.counts.hexes));
        split_->warnings.push_back(split_report(mixed_.counts, tets_cut_, split_->cells));
    }

    PieceTables& mixed_;
    const std::string& list_;
    std::filesystem::path folder_;
    Progress* progress_;
    bool cuts_;

    std::unique_ptr<PieceTables> split_;
    KeyTables<2> edges_;
    KeyTables<4> faces_;
    KeyTables<8> centers_;
    std::size_t chunks_ = 0, tets_cut_ = 0, turned_ = 0;
    std::uint64_t next_point_ = 0;
    std::optional<KeyRecord<8>> twin_;
};

}  // namespace

std::unique_ptr<PieceTables> split_tables(std::unique_ptr<PieceTables> mixed, const std::string& list,
                                          const std::filesystem::path& folder, Progress* progress) {
    return TableSplitter(*mixed, list, folder, progress).run();
}

}  // namespace subvol::detail
