// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <span>
#include <vector>

#include "class_tables.h"

namespace subvol::detail {

/// A cell with the class of its neighbourhood, whose points are points[0 .. point_count).
struct Member {
    ClassKey key;
    Index cell = 0;
    std::uint16_t point_count = 0;
    std::uint8_t turn = kIdentityTurn;
    const Index* points = nullptr;
};

constexpr ClassKey kNoClass{~std::uint64_t{0}, ~std::uint64_t{0}};

/// One mesh whose cells are refined: the control mesh, or a patch of a level of it.
struct RefinedLevel {
    explicit RefinedLevel(const HexMesh& of)
        : mesh(of), links(build_links(of)), walks([this] { return NeighborhoodWalk(mesh, links); }) {}
    const HexMesh& mesh;
    CellLinks links;
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
};

/// Cells with their classes, and the memory of their points.
struct Classified {
    std::vector<Member> members;
    std::vector<std::vector<Index>> points;
};

constexpr int kWhole = 2;  // so many levels are refined as they are, without classes of children

/// The cells in their order with their classes, kNoClass where a class has too few members for a table.
///
/// layers: how many layers about a cell its refinement by `levels` levels depends on
/// whole:  up to so many levels only regular cells have a class, of key `regular`
[[nodiscard]] Classified classify(RefinedLevel& level, std::span<const Index> cells, int levels, int layers,
                                  const ClassKey& regular, int whole = kWhole);

/// Takes the class from members that are too few of a kind for a table.
void drop_rare(std::vector<Member>& members, int levels);

}  // namespace subvol::detail
