// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "mesh_walls.h"
#include "sharp_edges.h"
#include "subvol/control_mesh.h"
#include "surface_bodies.h"

namespace subvol::detail {

/// What several surfaces enclose, each a material of its own. A place in more than one has the material of the one that
/// encloses least, so that a body within another is cut out of it. Materials are numbered by what they enclose, the least
/// first. Surfaces that are nearer to each other than a twentieth of a cell touch, as two programs' triangles for one face do.
class MaterialBodies {
public:
    /// side: of a cell
    MaterialBodies(std::span<const MaterialSurface> surfaces, double side);

    [[nodiscard]] std::size_t size() const { return bodies_.size(); }
    [[nodiscard]] const SurfaceBodies& operator[](Index material) const { return *bodies_[material]; }
    /// The number of the surface that a material is made of.
    [[nodiscard]] std::size_t given(Index material) const { return order_[material]; }
    [[nodiscard]] const std::string& name(Index material) const { return names_[material]; }
    [[nodiscard]] Box box() const;

    /// The material of a place; kNone outside of all.
    [[nodiscard]] Index at(const Vec3& x) const;
    /// The material beside a place between two that touch; kNone elsewhere.
    [[nodiscard]] Index beside_gap(const Vec3& x) const;
    /// The largest likeness of a material.
    [[nodiscard]] float likeness(const Vec3& x) const;

    [[nodiscard]] WallTarget target(Index material) const;

    /// How one material lies to one that encloses more.
    enum class Relation { Apart, Within, Crossing };
    [[nodiscard]] Relation relation(Index smaller, Index larger) const;

    /// What each material fills: what its surface encloses without the materials within; nothing where that is not known, as a
    /// surface is open or crosses one that encloses less.
    [[nodiscard]] std::vector<std::optional<double>> volumes() const;

    /// The sharp edges of all surfaces as far as they are walls, those that several have once.
    [[nodiscard]] SharpEdges sharp_edges(double angle_deg) const;

private:
    std::deque<SurfaceBodies> given_;  // in the order of the surfaces; the trees in them refer to their walls
    std::vector<const SurfaceBodies*> bodies_;
    std::vector<Box> boxes_;
    std::vector<std::size_t> order_;
    std::vector<std::string> names_;
    double side_;
};

}  // namespace subvol::detail
