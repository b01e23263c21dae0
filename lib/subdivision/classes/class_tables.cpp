// SPDX-License-Identifier: Apache-2.0
// Weights by refinement. A scheme is linear, so the weights of a new vertex over the n
// points of a neighbourhood are what becomes of the n unit vectors: point p gets an attribute of n channels, 1 in channel p and
// 0 in the others; after the refinement the channels of a vertex are its row. That is any scheme's code as it is, rules for
// creases and corners included, at the price of n channels; a table is made once and used for thousands of cells.
//
//     neighbourhood ──unit vectors──► refine_patch, level by level ──on_limit──► rows of the grid's side³ vertices
//
// Tables are kept up to a number of bytes; the one that has not been used for longest goes first. A dropped table stays alive
// as long as somebody holds it, and has the same numbers when it is made again.
#include "subvol/detail/class_tables.h"
#include "subvol/detail/word_hash.h"

#include <algorithm>
#include <cstring>
#include <list>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

#include "dense_block.h"
#include "run_nested.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

/// Refines the unit vectors of a neighbourhood's points: a vertex's values are then its weights.
WeightTable make_table(const Neighborhood& neighborhood, const SchemeOptions& scheme, int level,
                       const std::function<HexMesh(HexMesh)>& on_limit) {
    Patch patch = patch_of(neighborhood);
    const std::size_t points = patch.mesh.points.size();
    Attribute& unit = patch.mesh.attributes.emplace_back(Attribute{"weights", static_cast<int>(points), {}});
    unit.values.assign(points * points, 0.0);
    for (std::size_t p = 0; p < points; ++p) unit.values[p * points + p] = 1;
    const int last_layers = on_limit ? 1 : 0;
    for (int l = 1; l <= level; ++l) patch = refine_patch(patch, scheme, std::min(level - l + last_layers, 2));
    if (on_limit) patch.mesh = on_limit(std::move(patch.mesh));

    std::vector<Index> nodes;
    DenseBlock(level).nodes(patch.mesh, 0, nodes);
    WeightTable table;
    table.points = points;
    for (const Index node : nodes) {
        const double* row = &patch.mesh.attributes.front().values[node * points];
        for (std::size_t p = 0; p < points; ++p) {
            if (row[p] == 0) continue;
            table.columns.push_back(static_cast<std::uint16_t>(p));
            table.weights.push_back(row[p]);
        }
        table.offsets.push_back(static_cast<std::uint32_t>(table.columns.size()));
    }
    table.columns.shrink_to_fit();
    table.weights.shrink_to_fit();
    std::vector<std::uint8_t> has_weight(points, 0);
    for (const std::uint16_t p : table.columns) has_weight[p] = 1;
    for (std::size_t p = 0; p < points; ++p) {
        if (has_weight[p] != 0) table.used.push_back(static_cast<std::uint16_t>(p));
    }
    return table;
}

}  // namespace

/// Two different hashes of the code, word by word.
ClassKey key_of(const Neighborhood& neighborhood) {
    const auto& code = neighborhood.code;
    std::uint64_t a = mixed(code.size()), b = mixed(code.size() + kGoldenWord);
    for (std::size_t i = 0; i < code.size(); i += 4) {
        std::uint64_t word = 0;
        std::memcpy(&word, &code[i], std::min<std::size_t>(4, code.size() - i) * sizeof(code[0]));
        a = mixed(a ^ word);
        b = hash_with(b, word);
        b ^= b >> 29;
    }
    return {a, mixed(b)};
}

/// The cells of a 5×5×5 grid: the middle one, the layer around it, the layer around that. Its points are numbered by the grid,
/// not by a walk, because find_regular finds them without one.
Neighborhood regular_neighborhood(int layers) {
    const auto middle = static_cast<std::size_t>(layers), across = 2 * middle + 1, side = across + 1;
    Neighborhood grid{.points = std::vector<Index>(side * side * side), .code = {}};
    std::iota(grid.points.begin(), grid.points.end(), Index{0});
    std::vector<std::array<std::size_t, 3>> cells{{middle, middle, middle}};
    const auto add_layer = [&](std::size_t layer) {
        for (std::size_t n = 0; n < across * across * across; ++n) {
            const std::array<std::size_t, 3> at{n % across, n / across % across, n / (across * across)};
            const bool inside =
                std::ranges::all_of(at, [&](std::size_t i) { return i + layer >= middle && i <= middle + layer; });
            if (inside && std::ranges::find(cells, at) == cells.end()) cells.push_back(at);
        }
    };
    add_layer(1);
    grid.code.push_back(static_cast<std::uint16_t>(cells.size()));
    if (layers == 2) add_layer(2);
    for (const auto& at : cells) {
        for (std::size_t octant = 0; octant < 8; ++octant) {
            const std::size_t u = at[0] + (octant & 1), v = at[1] + (octant >> 1 & 1), w = at[2] + (octant >> 2);
            grid.code.push_back(static_cast<std::uint16_t>(u + side * (v + side * w)));
        }
    }
    return grid;
}

struct ClassTables::State {
    using Name = std::pair<ClassKey, int>;
    struct Entry {
        std::once_flag made;
        std::shared_ptr<const WeightTable> table;
        std::list<Name>::iterator used;
    };

    SchemeOptions scheme;
    std::function<HexMesh(HexMesh)> on_limit;
    std::size_t most_bytes;
    mutable std::mutex mutex;
    std::map<Name, std::shared_ptr<Entry>> entries;
    std::list<Name> by_use;  // the last one first
    std::size_t bytes = 0, made = 0;

    std::shared_ptr<Entry> find(const Name& name) {
        const std::scoped_lock lock(mutex);
        auto& entry = entries[name];
        if (!entry) {
            entry = std::make_shared<Entry>();
            by_use.push_front(name);
            entry->used = by_use.begin();
        } else {
            by_use.splice(by_use.begin(), by_use, entry->used);
        }
        return entry;
    }

    void count(std::size_t more) {
        const std::scoped_lock lock(mutex);
        bytes += more;
        ++made;
        while (bytes > most_bytes && by_use.size() > 1) {
            const auto oldest = entries.find(by_use.back());
            if (!oldest->second->table) break;  // is being made
            bytes -= oldest->second->table->bytes();
            entries.erase(oldest);
            by_use.pop_back();
        }
    }
};

ClassTables::ClassTables(const SchemeOptions& scheme, std::function<HexMesh(HexMesh)> on_limit, std::size_t most_bytes)
    : state_(std::make_unique<State>()) {
    state_->scheme = scheme;
    state_->on_limit = std::move(on_limit);
    state_->most_bytes = most_bytes;
}

ClassTables::~ClassTables() = default;

std::shared_ptr<const WeightTable> ClassTables::table(const ClassKey& key, int level,
                                                      const std::function<const Neighborhood&()>& find) {
    const auto entry = state_->find({key, level});
    std::call_once(entry->made, [&] {
        run_nested([&] {
            auto table = std::make_shared<const WeightTable>(make_table(find(), state_->scheme, level, state_->on_limit));
            const std::scoped_lock lock(state_->mutex);
            entry->table = std::move(table);
        });
        state_->count(entry->table->bytes());
    });
    return entry->table;
}

std::size_t ClassTables::made() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->made;
}

std::size_t ClassTables::bytes() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->bytes;
}

}  // namespace subvol::detail
