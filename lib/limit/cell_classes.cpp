// SPDX-License-Identifier: Apache-2.0
#include "cell_classes.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

namespace subvol::detail {

namespace {

/// How many cells of a class make a table pay, by its level: it costs as much as the refinement of so many.
std::size_t least_members(int levels) {
    return std::size_t{32} << std::max(0, levels - 2);
}

}  // namespace

Classified classify(RefinedLevel& level, std::span<const Index> cells, int levels, int layers, const ClassKey& regular,
                    int whole) {
    constexpr std::size_t kRun = 256;
    Classified result{.members = std::vector<Member>(cells.size()),
                      .points = std::vector<std::vector<Index>>((cells.size() + kRun - 1) / kRun)};
    auto& members = result.members;
    for (std::size_t i = 0; i < cells.size(); ++i) members[i] = {kNoClass, cells[i]};
    if (levels == 0) return result;
    tbb::enumerable_thread_specific<Neighborhood> founds;
    tbb::parallel_for(std::size_t{0}, result.points.size(), [&](std::size_t r) {
        NeighborhoodWalk& walk = level.walks.local();
        Neighborhood& found = founds.local();
        std::vector<Index>& points = result.points[r];
        const std::size_t end = std::min(cells.size(), (r + 1) * kRun);
        for (std::size_t i = r * kRun; i < end; ++i) {
            const std::size_t before = points.size();
            points.resize(before + 216);
            if (layers == 2 && walk.find_regular(cells[i], std::span(points).subspan(before).first<216>())) {
                members[i].key = regular;
            } else {
                points.resize(before);
                if (levels <= whole) continue;
                if (!walk.find(cells[i], layers, found)) continue;
                members[i].key = key_of(found);
                members[i].turn = found.turn;
                points.insert(points.end(), found.points.begin(), found.points.end());
            }
            members[i].point_count = static_cast<std::uint16_t>(points.size() - before);
        }
        const Index* next = points.data();
        for (std::size_t i = r * kRun; i < end; ++i) {
            members[i].points = next;
            next += members[i].point_count;
        }
    });
    drop_rare(members, levels);
    return result;
}

void drop_rare(std::vector<Member>& members, int levels) {
    std::vector<ClassKey> keys(members.size());
    std::ranges::transform(members, keys.begin(), &Member::key);
    tbb::parallel_sort(keys.begin(), keys.end());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, members.size(), 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto [first, last] = std::equal_range(keys.begin(), keys.end(), members[i].key);
            if (static_cast<std::size_t>(last - first) < least_members(levels)) members[i].key = kNoClass;
        }
    });
}

}  // namespace subvol::detail
