// SPDX-License-Identifier: Apache-2.0
// A sample reads 27 of the points of level L in its control cell, and these are sums over the points around the cell:
//
//     points around the cell ──table of its class──► the rows of the grid that its samples need ──27 weights──► samples
//     points around the cell ◄──its transpose─────── the same rows                              ◄──27 weights── samples
//
// Where few samples lie in a cell, or all of them at points of level L−1, most rows of the grid are not needed. Cells that need
// the same parts of it share a table of these rows alone.
#include "class_rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "subvol/detail/counted_rows.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/detail/piece_tree.h"

namespace subvol::detail {

namespace {

constexpr std::uint16_t kNothing = 0xffff;

// The same place along the axes of the walk.
Vec3 along_walk(const Vec3& uvw, std::uint8_t turn) {
    const auto& sides = cell_turns()[turn].sides;
    Vec3 at;
    for (int a = 0; a < 3; ++a) {
        const std::size_t side = sides[2 * static_cast<std::size_t>(a)];
        const double t = uvw[static_cast<int>(side / 2)];
        at[a] = (side & 1) != 0 ? 1 - t : t;
    }
    return at;
}

constexpr std::size_t kFew = 256;  // cells that need the same rows: fewer do not pay for a table of these alone

// Where few samples lie in a cell, all rows of a table cost more than the rows of the samples.
void drop_small_classes(std::vector<Member>& members) {
    std::vector<ClassKey> keys(members.size());
    std::ranges::transform(members, keys.begin(), &Member::key);
    tbb::parallel_sort(keys.begin(), keys.end());
    std::erase_if(members, [&](const Member& member) {
        const auto [first, last] = std::equal_range(keys.begin(), keys.end(), member.key);
        return static_cast<std::size_t>(last - first) < kFew;
    });
}

}  // namespace

/// Values of the points around the cells of a chunk and of the rows of its table, cell by cell in the lanes.
struct ClassRows::Scratch {
    std::vector<double, tbb::cache_aligned_allocator<double>> in, out;
};

/// What is needed until the tables are there. layers: around a cell that its refinement depends on
struct ClassRows::Finding {
    RefinedLevel level;
    int layers;
    Neighborhood regular;
    ClassKey regular_key;
    ClassTables tables;

    Finding(const HexMesh& mesh, const RefineOptions& options)
        : level(mesh),
          layers(std::min(options.levels + (interpolates(options.scheme.kind) ? 0 : 1), 2)),
          regular(regular_neighborhood(layers)),
          regular_key(key_of(regular)),
          tables(
              options.scheme, interpolates(options.scheme.kind)
                                  ? std::function<HexMesh(HexMesh)>()
                                  : [kind = options.scheme.kind](HexMesh m) { return on_limit(std::move(m), kind); }) {}

    [[nodiscard]] std::shared_ptr<const WeightTable> table(const Member& member, std::size_t levels) {
        Neighborhood found;
        return tables.table(member.key, static_cast<int>(levels), [&]() -> const Neighborhood& {
            if (member.key == regular_key) return regular;
            (void)level.walks.local().find(member.cell, layers, found);
            return found;
        });
    }
};

ClassRows::ClassRows(const HexMesh& mesh, const RefineOptions& options, std::span<const LimitQuery> places,
                     const Settling& settling)
    : levels_(static_cast<std::size_t>(options.levels)),
      side_((std::size_t{1} << options.levels) + 1),
      columns_(mesh.points.size()),
      rest_(mesh.cells.size(), 0) {
    for (const LimitQuery& place : places) rest_[place.cell] = 1;
    Finding finding(mesh, options);
    const auto wanted = numbers_where<std::vector<Index>>(rest_.size(), [&](std::size_t c) { return rest_[c] != 0; });
    cells_ = classify(finding.level, wanted, options.levels, finding.layers, finding.regular_key, 0);
    auto& members = cells_.members;
    std::erase_if(members, [](const Member& member) { return member.key == kNoClass; });
    if (places.size() <= kFormedPlaces * wanted.size()) drop_small_classes(members);
    std::vector<std::uint8_t> turns(mesh.cells.size(), kIdentityTurn);
    for (const Member& member : members) {
        rest_[member.cell] = 0;
        turns[member.cell] = member.turn;
    }

    const auto numbers = counted_rows<Index>(mesh.cells.size(), [&](const auto& put) {
        for (std::size_t k = 0; k < places.size(); ++k) {
            if (rest_[places[k].cell] == 0) put(places[k].cell, static_cast<Index>(k));
        }
    });
    places_.offsets = numbers.offsets;
    places_.values.resize(numbers.values.size());
    const std::size_t half = std::size_t{1} << (levels_ - 1);
    parallel_each(numbers.values.size(), [&](std::size_t i) {
        const auto& [cell, uvw] = places[numbers.values[i]];
        const Vec3 at = along_walk(glm::clamp(uvw, 0.0, 1.0), turns[cell]) * static_cast<double>(half);
        std::size_t node = 0;
        Vec3 lowest;
        for (int a = 2; a >= 0; --a) {
            const std::size_t part = std::min(static_cast<std::size_t>(at[a]), half - 1);
            lowest[a] = static_cast<double>(part);
            node = side_ * node + 2 * part;
        }
        places_.values[i] = {at - lowest, numbers.values[i], static_cast<std::uint16_t>(node)};
    });
    if (!settling.positions.empty()) settle(finding, settling);
    choose_tables(finding);
}

std::span<const ClassRows::Place> ClassRows::places_in(std::size_t member) const {
    return places_[cells_.members[member].cell];
}

void ClassRows::settle(Finding& finding, const Settling& settling) {
    auto& members = cells_.members;
    tbb::parallel_sort(members.begin(), members.end(),
                       [](const Member& a, const Member& b) { return std::pair(a.key, a.cell) < std::pair(b.key, b.cell); });
    std::vector<Chunk> chunks;
    for (std::size_t first = 0; first < members.size(); first += chunks.back().count) {
        std::size_t last = first;
        while (last < std::min(members.size(), first + kTableLanes) && members[last].key == members[first].key) ++last;
        chunks.push_back({0, static_cast<Index>(first), static_cast<Index>(last - first)});
    }
    tbb::enumerable_thread_specific<LaneValues> lanes;
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
        const auto in_chunk = std::span(members).subspan(chunks[c].first, chunks[c].count);
        const auto table = finding.table(in_chunk[0], levels_);
        LaneValues& values = lanes.local();
        values.load(finding.level.mesh, in_chunk, *table);
        values.apply(*table);
        for (std::size_t lane = 0; lane < in_chunk.size(); ++lane) {
            const Index cell = in_chunk[lane].cell;
            for (std::size_t k = places_.offsets[cell]; k < places_.offsets[cell + std::size_t{1}]; ++k) {
                Place& place = places_.values[k];
                const Vec3 nearest = glm::round(place.at * 2.0);
                const auto steps = glm::dvec3(1, static_cast<double>(side_), static_cast<double>(side_ * side_));
                const std::size_t node = place.node + static_cast<std::size_t>(glm::dot(nearest, steps));
                if (glm::distance(values.position(lane, node), settling.positions[place.row]) < settling.near_world) {
                    place.at = nearest / 2.0;
                }
            }
        }
    });
}

ClassRows::Need ClassRows::need_of(std::span<const Place> places) const {
    unsigned octants = 0, odd = 0;
    const std::size_t half = side_ / 2;
    for (const Place& place : places) {
        for (int a = 0; a < 3; ++a) odd |= place.at[a] != 0 && place.at[a] != 1 ? 0x100U : 0U;
        const std::size_t u = place.node % side_, v = place.node / side_ % side_, w = place.node / (side_ * side_);
        octants |= 1U << ((u >= half ? 1U : 0U) + (v >= half ? 2U : 0U) + (w >= half ? 4U : 0U));
    }
    return static_cast<Need>(odd | (levels_ == 1 ? 0xffU : octants));
}

ClassRows::Table ClassRows::table_of(const WeightTable& whole, Need need) const {
    const std::size_t half = side_ / 2;
    const auto is_needed = [&](std::size_t node) {
        const std::array<std::size_t, 3> at{node % side_, node / side_ % side_, node / (side_ * side_)};
        if ((need & 0x100) == 0 && std::ranges::any_of(at, [](std::size_t i) { return i % 2 != 0; })) return false;
        for (std::size_t octant = 0; octant < 8; ++octant) {
            if ((need >> octant & 1) == 0) continue;
            bool inside = true;
            for (std::size_t a = 0; a < 3; ++a) inside &= (octant >> a & 1) != 0 ? at[a] >= half : at[a] <= half;
            if (inside) return true;
        }
        return false;
    };
    Table table{.used = {}, .rows = std::vector<std::uint16_t>(whole.rows(), 0), .values = {}, .transposed = {}};
    std::vector<std::uint16_t> numbers(whole.points, kNothing), nodes;
    for (std::size_t node = 0; node < whole.rows(); ++node) {
        if (!is_needed(node)) continue;
        table.rows[node] = static_cast<std::uint16_t>(nodes.size());
        nodes.push_back(static_cast<std::uint16_t>(node));
        for (std::size_t i = whole.offsets[node]; i < whole.offsets[node + 1]; ++i) numbers[whole.columns[i]] = 0;
    }
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        if (numbers[p] == kNothing) continue;
        numbers[p] = static_cast<std::uint16_t>(table.used.size());
        table.used.push_back(static_cast<std::uint16_t>(p));
    }
    table.values.points = table.used.size();
    for (const std::uint16_t node : nodes) {
        for (std::size_t i = whole.offsets[node]; i < whole.offsets[node + std::size_t{1}]; ++i) {
            table.values.columns.push_back(numbers[whole.columns[i]]);
            table.values.weights.push_back(whole.weights[i]);
        }
        table.values.offsets.push_back(static_cast<std::uint32_t>(table.values.columns.size()));
    }
    table.transposed = transpose_of(table.values, table.values.points);
    table.transposed.points = row_count(table.values);
    return table;
}

void ClassRows::choose_tables(Finding& finding) {
    struct Choice {
        ClassKey key;
        Need need;
        Member member;
        [[nodiscard]] auto order() const { return std::tuple(key, need, member.cell); }
    };
    std::vector<Choice> choices(cells_.members.size());
    parallel_each(choices.size(), [&](std::size_t m) {
        choices[m] = {cells_.members[m].key, need_of(places_in(m)), cells_.members[m]};
    });
    const auto sort = [&] {
        tbb::parallel_sort(choices.begin(), choices.end(),
                           [](const Choice& a, const Choice& b) { return a.order() < b.order(); });
    };
    const auto end_of = [&](std::size_t first) {
        std::size_t last = first;
        while (last < choices.size() && choices[last].key == choices[first].key && choices[last].need == choices[first].need)
            ++last;
        return last;
    };
    sort();
    for (std::size_t first = 0, last = 0; first < choices.size(); first = last) {
        last = end_of(first);
        constexpr Need kAll = 0x1ff;
        for (std::size_t m = first; last - first < kFew && m < last; ++m) choices[m].need = kAll;
    }
    sort();
    for (std::size_t first = 0, last = 0; first < choices.size(); first = last) {
        last = end_of(first);
        const auto table = static_cast<Index>(tables_.size());
        tables_.push_back(table_of(*finding.table(choices[first].member, levels_), choices[first].need));
        for (std::size_t m = first; m < last; m += kTableLanes) {
            chunks_.push_back({table, static_cast<Index>(m), static_cast<Index>(std::min(kTableLanes, last - m))});
        }
    }
    std::ranges::transform(choices, cells_.members.begin(), &Choice::member);
    // Table by table in one part of the mesh after the other, so that neither tables nor values are fetched from afar each
    // time.
    constexpr Index kPart = Index{1} << 15;
    std::ranges::sort(chunks_, {}, [&](const Chunk& chunk) {
        return std::tuple(cells_.members[chunk.first].cell / kPart, chunk.table, chunk.first);
    });
}

void ClassRows::load(const Chunk& chunk, std::span<const double> control, Scratch& scratch) const {
    const std::vector<std::uint16_t>& used = tables_[chunk.table].used;
    scratch.in.resize(std::max(scratch.in.size(), used.size() * kTableLanes));
    for (std::size_t lane = 0; lane < chunk.count; ++lane) {
        const Index* const points = cells_.members[chunk.first + lane].points;
        double* to = scratch.in.data() + lane;
        for (const std::uint16_t p : used) {
            *to = control[points[p]];
            to += kTableLanes;
        }
    }
}

template <class Visit>
void ClassRows::each_term(const Place& place, const Table& table, const Visit& visit) const {
    const auto u = QuadraticWeights(place.at.x).values, v = QuadraticWeights(place.at.y).values,
               w = QuadraticWeights(place.at.z).values;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::uint16_t* const rows = &table.rows[place.node + side_ * (j + side_ * k)];
            for (std::size_t i = 0; i < 3; ++i) visit(kTableLanes * rows[i], u[i] * (v[j] * w[k]));
        }
    }
}

void ClassRows::apply(std::span<const double> control, std::span<double> values) const {
    tbb::enumerable_thread_specific<Scratch> scratches;
    tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
        const Chunk& chunk = chunks_[c];
        const Table& table = tables_[chunk.table];
        Scratch& scratch = scratches.local();
        load(chunk, control, scratch);
        scratch.out.resize(std::max(scratch.out.size(), table.values.rows() * kTableLanes));
        apply_table(table.values, scratch.in.data(), scratch.out.data());
        for (std::size_t lane = 0; lane < chunk.count; ++lane) {
            const double* const nodes = scratch.out.data() + lane;
            for (const Place& place : places_in(chunk.first + lane)) {
                double sum = 0;
                each_term(place, table, [&](std::size_t node, double weight) { sum += weight * nodes[node]; });
                values[place.row] = sum;
            }
        }
    });
}

void ClassRows::add_transposed(std::span<const double> values, std::vector<double>& sums) const {
    if (chunks_.empty()) return;
    tbb::enumerable_thread_specific<Scratch> scratches;
    const std::vector<double> more = parallel_sums(columns_, chunks_.size(), [&](std::size_t c, std::vector<double>& run) {
        const Chunk& chunk = chunks_[c];
        const Table& table = tables_[chunk.table];
        Scratch& scratch = scratches.local();
        const std::size_t size = table.values.rows() * kTableLanes;
        scratch.out.resize(std::max(scratch.out.size(), size));
        scratch.in.resize(std::max(scratch.in.size(), table.used.size() * kTableLanes));
        std::fill_n(scratch.out.begin(), size, 0.0);
        for (std::size_t lane = 0; lane < chunk.count; ++lane) {
            double* const nodes = scratch.out.data() + lane;
            for (const Place& place : places_in(chunk.first + lane)) {
                const double value = values[place.row];
                each_term(place, table, [&](std::size_t node, double weight) { nodes[node] += weight * value; });
            }
        }
        apply_table(table.transposed, scratch.out.data(), scratch.in.data());
        for (std::size_t lane = 0; lane < chunk.count; ++lane) {
            const Index* const points = cells_.members[chunk.first + lane].points;
            const double* from = scratch.in.data() + lane;
            for (const std::uint16_t p : table.used) {
                run[points[p]] += *from;
                from += kTableLanes;
            }
        }
    });
    parallel_each(sums.size(), [&](std::size_t p) { sums[p] += more[p]; });
}

}  // namespace subvol::detail
