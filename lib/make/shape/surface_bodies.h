// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "subvol/control_mesh.h"
#include "surface_tree.h"

namespace subvol::detail {

/// The edges of one triangle: their number and length.
struct OpenEdges {
    std::size_t count = 0;
    double length_world = 0;
};
[[nodiscard]] OpenEdges open_edges(const Surface& surface);

/// How far apart points of a surface are that count as one.
[[nodiscard]] double same_place(const Surface& surface);

/// What a surface encloses.
///
/// Triangles that are joined by edges are one *wall*; walls with open edges count as one, as only together they wind about
/// anything. Triangles that are there twice, and sheets that only stand on others, are left out, and triangles are turned so
/// that those of a wall have one orientation. Walls that cross are united: a place is inside of them if it is inside of one.
/// What is inside of an odd number of such unions is inside the surface, so that a wall within another is that of a cavity,
/// whichever its orientation is, and one in a cavity that of a body again.
class SurfaceBodies {
public:
    explicit SurfaceBodies(const Surface& surface);
    // The trees refer to the walls.
    SurfaceBodies(const SurfaceBodies&) = delete;
    SurfaceBodies& operator=(const SurfaceBodies&) = delete;

    /// The triangles that were not left out.
    [[nodiscard]] const Surface& surface() const { return surface_; }
    [[nodiscard]] const EnclosureReport& report() const { return report_; }

    /// 1 inside, 0 outside, between near holes; above .5 is inside.
    [[nodiscard]] float likeness(const Vec3& x) const;

    /// Less than what closed walls enclose: of united ones only the largest counts.
    [[nodiscard]] double least_volume() const;
    /// What the walls enclose; nothing where it is not known, as some are open, cross each other or have only one side.
    [[nodiscard]] std::optional<double> volume() const;

    /// Whether there are walls that may touch others, or lie within them.
    [[nodiscard]] bool has_several_walls() const { return walls_.size() > 1 || report_.many_edges > 0; }

    /// Whether nothing is closed.
    [[nodiscard]] bool is_open() const { return walls_.size() == 1 && !walls_.front().closed; }

    /// Whether nothing is closed, and the hole is nearly as large as the surface.
    [[nodiscard]] bool is_sheet() const;

private:
    struct Wall {
        Surface surface;
        std::optional<SurfaceTree> tree;
        bool closed = true;
        std::size_t joined = 0;  ///< number of its union
        std::size_t depth = 0;   ///< how many other unions it lies in
        double volume = 0;       ///< signed
        Vec3 area{0.0};
        double size = 0;  ///< of its area
    };

    /// Calls visit(wall) for the walls whose boxes hold a place.
    template <class Visit>
    void each_wall_about(const Vec3& x, const Visit& visit) const {
        Box point;
        point.add(x);
        boxes_->visit_leaves([&](const Box& box) { return meet(box, point); },
                             [&](std::size_t first, std::size_t last) {
                                 for (std::size_t slot = first; slot < last; ++slot) {
                                     const Wall& wall = walls_[boxes_->item(slot)];
                                     if (meet(wall.tree->box(), point)) visit(wall);
                                 }
                                 return false;
                             });
    }

    void leave_out_copies();
    bool leave_out_fins();
    void turn();
    void make_walls();
    void unite();
    void nest();

    Surface surface_;
    double same_;
    EnclosureReport report_;
    std::vector<Wall> walls_;
    std::optional<MedianTree<Box>> boxes_;  // of the walls
};

}  // namespace subvol::detail
