// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <tuple>
#include <vector>

#include "kernel_levels.h"
#include "kernel_origins.h"
#include "sheet_error.h"
#include "subvol/boundary_values.h"
#include "subvol/picture_maker.h"
#include "subvol/rbf_field.h"
#include "subvol/render_tets.h"
#include "subvol/sample_tables.h"
#include "subvol/splat.h"

// What the methods share, from the top of the picture to its bottom:
//
//   style.look ──▶ light ──┬──▶ splat, sheets, footprints: in the splatter, or ──▶ the boundary's own colours (painted)
//                          └──▶ tets, pt, dense: of the boundary, over the finished picture (solids only)
//   levels ──▶ kernels: instead of the limit · tets, pt: 1 by default · dense: none are raised until nothing changes
//   an opaque solid, by splats: skin ──▶ first hits of the rays; at cuts kernels ──▶ values there
//   body   ──▶ kernels ──▶ levels of detail ──▶ splatters     refined mesh ──▶ tetrahedra     skin: values on the boundary

namespace subvol {
namespace detail {

/// A splatter for each way of drawing: method, samples, the part of the light at the eye (-1: not lit), and the kernels that it
/// was made for.
using SplatterKey = std::tuple<Method, int, double, const RbfVolume*>;
struct KeptSplatter {
    SplatterKey key;
    Splatter splatter;
    std::size_t version = 0;  // of the kernels that it draws
};

/// What pictures of kernels share. Later members refer to earlier ones, so it is never cleared in part.
struct PreparedKernels {
    /// Kernels have the values of a mesh less these: of opacities, and of colours.
    std::array<double, 2> origins{};
    /// The mesh in memory and the values on its boundary less these, where they are not 0.
    std::optional<HexMesh> relative_mesh{};
    std::optional<BoundaryValues> relative_skin{};
    std::optional<RbfVolume> volume{};
    std::optional<RbfField> at_cuts{};  // the values of colours
    std::optional<KernelLevels> levels{};
    std::vector<KeptSplatter> splatters{};
};

/// What pictures of tetrahedra share.
struct PreparedCells {
    std::optional<TetsRenderer> tets{};
    std::optional<ProjectedRenderer> projected{};
};

/// What pictures of a mesh in pieces share.
struct PreparedPieces {
    std::optional<Surface> boundary{};
    std::optional<BrickTets> tets{};
};

/// What was made of a body, for each family of methods; a picture of another method of the same body finds it again.
struct Prepared {
    std::optional<BoundaryValues> skin{};
    std::optional<Box> skin_box{};   // of its points
    std::optional<MeshHull> hull{};  // of a mesh in pieces, for as long as something is made of it
    PreparedCells cells{};
    PreparedPieces pieces{};
    std::optional<PreparedKernels> kernels{std::in_place};  // others where the origins change
    bool range_seen = false;                                // whether the range of what is drawn was looked at
};

}  // namespace detail

/// What a maker keeps, and how it prepares (prepare_pictures.cpp) and draws (draw_pictures.cpp).
struct PictureMaker::State {
    PictureBody body;
    MethodOptions options;
    PictureTeam* team;

    std::optional<BoundaryTables> tables{};       // of the cells of the body; made when it is moved
    std::optional<SampleTables> kernel_tables{};  // likewise
    bool bodies_seen = false;                     // whether a picture was looked at for bodies that are too small in it
    std::optional<detail::Prepared> prepared{std::in_place};  // of the body; destroyed as a whole with it

    void set_body(PictureBody next);

    [[nodiscard]] std::array<double, 2> origins_for(const Optics& optics) const;
    /// Decides on the origins of kernels; kernels with others are given up.
    void settle_origins(const Optics& optics);
    [[nodiscard]] bool is_relative() const { return body.mesh && prepared->kernels->origins != std::array<double, 2>{}; }

    const HexMesh& mesh_of_kernels();
    const BoundaryValues& skin_of_kernels();
    [[nodiscard]] Optics optics_of_kernels(const Optics& optics) const {
        return is_relative() ? Optics(detail::less(optics.function(), prepared->kernels->origins), optics.opacity_unit())
                             : optics;
    }

    /// Warns of bodies that the first picture can hardly show.
    void warn_of_tiny_bodies(const View& view, Facts& facts);

    /// Warns if the values on the boundary, or those of kernels at places of the limit, leave the range of the mesh.
    void warn_of_range(Facts& facts);

    /// The mesh, if the body is one in memory; else null.
    [[nodiscard]] const HexMesh* mesh() const { return body.mesh ? body.mesh->mesh() : nullptr; }
    [[nodiscard]] bool is_in_pieces() const { return body.mesh && mesh() == nullptr; }

    [[nodiscard]] const SchemeOptions& scheme() const { return options.kernels.sample.scheme; }
    [[nodiscard]] Method method() const { return options.style.method; }
    [[nodiscard]] bool is_solid() const { return options.style.look.look == Look::Solid; }
    /// Whether a solid has opacities: then its surface is translucent, whatever the method.
    [[nodiscard]] bool is_translucent() const { return is_solid() && !options.style.look.opacity.empty(); }
    [[nodiscard]] bool is_finished() const { return team == nullptr || team->finishes(); }
    /// Whether the light of the boundary is added to finished pictures.
    [[nodiscard]] bool lights_boundary() const {
        return is_solid() && !draws_kernels(method()) && method() != Method::Grid && is_finished();
    }

    [[nodiscard]] bool paints_boundary() const {
        const LookOptions& look = options.style.look;
        return body.mesh && look.look == Look::Solid && look.opacity.empty() && !look.opacity_unit_world &&
               options.kernels.are_plain() && !options.drop_invisible && options.splat.sheets == 0 && options.splat.normalized;
    }
    /// Shadows and occlusion are those of the kernels: the boundary's own colours have none.
    [[nodiscard]] bool paints_splats() const {
        return paints_boundary() && !options.splat.shadows && options.splat.ambient_occlusion == 0;
    }

    [[nodiscard]] bool is_cut() const { return !options.style.clip.empty(); }

    /// Whether pictures of an opaque solid are made of the first hits of its rays alone, where no ray begins inside. Options of
    /// kernels and sheets ask for those. At a cut kernels give the values.
    [[nodiscard]] bool may_show_first_hits() const;
    /// Whether the eye, or the plane of parallel rays, lies before the whole boundary.
    [[nodiscard]] bool shows_first_hits(const View& view);

    /// A mesh in pieces gets the colours of its boundary when all rows are there.
    [[nodiscard]] bool paints_finished() const { return draws_kernels(method()) && paints_splats() && is_finished(); }

    [[nodiscard]] RefineOptions refinement(int level, Progress* progress) const {
        return {.scheme = scheme(), .levels = level, .progress = progress};
    }

    /// As boundary_values has it, up to rounding where the body has been moved.
    const BoundaryValues& skin_of_mesh(Progress* progress, Facts& facts);

    const RbfVolume& kernels(const Optics& optics, Progress* progress, Facts& facts);

    const MeshHull& hull_of_pieces(Progress* progress, Facts& facts);

    Facts prepare(const Optics& optics, Progress* progress);

    /// The values inside a solid that is cut open.
    void prepare_cuts(const Optics& optics, Progress* progress, Facts& facts);

    /// What pictures need that show more than the first hits of a solid.
    void prepare_inside(const Optics& optics, Progress* progress, Facts& facts);

    void prepare_cells(Progress* progress, Facts& facts);

    void prepare_pieces(Progress* progress, Facts& facts);

    [[nodiscard]] std::uint64_t cells_of_pieces() const;

    [[nodiscard]] BrickTetsOptions piece_tets_options(Progress* progress) const;

    /// The channels of the kernels that are drawn: the shown one, and the one of the colours if that is another.
    [[nodiscard]] std::vector<std::size_t> shown_channels() const;

    [[nodiscard]] SplatOptions splat_options(const Optics& optics) const;

    /// Whether splatters are made for all kernels, which are in memory.
    [[nodiscard]] bool draws_all_kernels() const {
        return team == nullptr && draws_kernels(method()) && !options.seconds && prepared->kernels->levels->all() != nullptr;
    }

    detail::KeptSplatter& splatter(const RbfVolume& kernels, std::size_t version, const Optics& optics);

    /// Gives a splatter the colours that solids have on their boundary.
    void paint(Splatter& splatter);

    Picture draw_splats(const View& view, const Optics& of_field, Progress* progress, const RbfVolume* stand_in);

    /// Whether a picture is of sheets whose number its tolerance decides, and can be drawn again with more of them.
    [[nodiscard]] bool has_chosen_sheets() const;

    /// sheets: those of the picture
    detail::SheetError sheet_error(const Image& image, int sheets, const View& view, const Optics& of_field,
                                   Progress* progress);

    Picture draw_splats_in_time(const View& view, const Optics& optics, Progress* progress);

    Picture draw_piece_splats(const View& view, const Optics& of_field, Progress* progress) const;

    Picture draw_tets(const View& view, const Optics& optics, Progress* progress) const;

    Picture draw_projected(const View& view, const Optics& optics, Progress* progress);

    Picture draw_dense(const View& view, const Optics& optics, Progress* progress) const;

    Picture draw_grid(const View& view, const Optics& optics, Progress* progress) const;

    /// The surface of a solid, one part of it seen through the other. Every process has all rows.
    Picture draw_translucent(const View& view, const Optics& optics) const;

    /// An opaque solid without its kernels; nothing if its boundary is not closed, as cells of both hands leave it: then rays
    /// seem to begin inside.
    std::optional<Picture> draw_first_hits(const View& view, const Optics& optics, Progress* progress) const;

    Picture drawn_rows(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in);

    /// Adds what the boundary gives to a finished picture: light, or for a mesh in pieces its colours.
    void finish(Picture& picture, const View& view, const Optics& optics) const;
};

}  // namespace subvol
