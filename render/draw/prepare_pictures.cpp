// SPDX-License-Identifier: Apache-2.0
// What PictureMaker makes before it draws, and keeps for pictures that follow: values on the boundary, kernels and their
// levels, tetrahedra, what meshes in pieces need; and which of these a style asks for. Values of kernels are relative to the
// middle of a range that is narrow for 32-bit floats.
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "kernel_origins.h"
#include "picture_facts.h"
#include "picture_state.h"
#include "subvol/detail/limit_words.h"
#include "subvol/detail/mesh_bodies.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/limit.h"

namespace subvol {
namespace {

/// The level of the tetrahedra by default: of more cells those of level 1 would take gigabytes (4.8 kB a cell), and the cells
/// themselves are nearer to the limit than a picture shows (68 dB of a million).
int tets_level(std::uint64_t cells) {
    constexpr std::uint64_t kMostCells = 300'000;
    return cells <= kMostCells ? 1 : 0;
}

}  // namespace

void PictureMaker::State::set_body(PictureBody next) {
    if (body.shape != next.shape || next.shape == 0) {
        tables.reset();
        kernel_tables.reset();
    }
    body = std::move(next);
    const std::array<double, 2> origins = prepared->kernels->origins;
    prepared.emplace();
    prepared->kernels->origins = origins;
    bodies_seen = body.moved;  // which bodies there are does not change, and moving has to be fast
}

std::array<double, 2> PictureMaker::State::origins_for(const Optics& optics) const {
    if (!body.mesh || !draws_kernels(method())) return prepared->kernels->origins;
    const TransferFunction& function = optics.function();
    std::array<double, 4> ends{function.opacity.front().value, function.opacity.back().value, function.color.front().value,
                               function.color.back().value};
    if (mesh() == nullptr || mesh()->attributes.size() == 1) {  // opacities and colours are of the same values
        ends[0] = ends[2] = std::min(ends[0], ends[2]);
        ends[1] = ends[3] = std::max(ends[1], ends[3]);
    }
    return {detail::origin_for(ends[0], ends[1]), detail::origin_for(ends[2], ends[3])};
}

void PictureMaker::State::settle_origins(const Optics& optics) {
    const std::array<double, 2> next = origins_for(optics);
    if (next == prepared->kernels->origins) return;
    prepared->kernels.emplace();
    prepared->kernels->origins = next;
}

const HexMesh& PictureMaker::State::mesh_of_kernels() {
    if (!is_relative()) return *mesh();
    if (!prepared->kernels->relative_mesh) {
        prepared->kernels->relative_mesh = *mesh();
        detail::move_down(*prepared->kernels->relative_mesh, prepared->kernels->origins);
    }
    return *prepared->kernels->relative_mesh;
}

const BoundaryValues& PictureMaker::State::skin_of_kernels() {
    if (!is_relative()) return *prepared->skin;
    if (!prepared->kernels->relative_skin) {
        prepared->kernels->relative_skin = *prepared->skin;
        for (double& value : prepared->kernels->relative_skin->values.back()) value -= prepared->kernels->origins[1];
    }
    return *prepared->kernels->relative_skin;
}

void PictureMaker::State::warn_of_tiny_bodies(const View& view, Facts& facts) {
    if (std::exchange(bodies_seen, true) || mesh() == nullptr) return;
    const std::vector<Box> boxes = detail::boxes_of_bodies(*mesh());
    const std::size_t tiny = detail::count_tiny_bodies(boxes, view);
    if (tiny == 0) return;
    facts.warn(std::to_string(tiny) + " of " + std::to_string(boxes.size()) +
               " bodies in the picture are smaller than a pixel and may not be seen: a larger picture or a nearer camera "
               "shows them");
}

void PictureMaker::State::warn_of_range(Facts& facts) {
    if (!body.of_file || mesh() == nullptr || mesh()->attributes.empty() || std::exchange(prepared->range_seen, true)) return;
    const Attribute& field = mesh()->attributes.back();
    if (field.derived || field.channels != 1 || own_values(field).empty()) return;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const auto look = [&](const auto& values, double origin) {
        if (values.empty()) return;
        const auto [low, high] = std::ranges::minmax(values);
        least = std::min(least, low + origin);
        most = std::max(most, high + origin);
    };
    if (prepared->skin) look(prepared->skin->values.back(), 0);
    if (prepared->kernels->volume && options.kernels.are_plain() && !prepared->kernels->volume->channels.empty())
        look(prepared->kernels->volume->channels.back().values, is_relative() ? prepared->kernels->origins[1] : 0);
    const FieldRange range = range_of(field);
    facts.warn(detail::range_words(field.name, range.min[0], range.max[0], least, most, options.names, true));
}

bool PictureMaker::State::may_show_first_hits() const {
    const SplatMethod splats = options.splat.method;
    return paints_splats() && method() == Method::Splat && (splats == SplatMethod::Auto || splats == SplatMethod::Cpu) &&
           options.style.clip.slices.empty() && (!is_cut() || !is_in_pieces()) && !options.seconds && !options.lod &&
           !options.image_tolerance && !options.splat.device && (!prepared->skin || !prepared->skin->values.empty());
}

bool PictureMaker::State::shows_first_hits(const View& view) {
    if (!may_show_first_hits()) return false;
    const std::vector<Vec3>& points = prepared->skin->surface.points;
    if (!prepared->skin_box) {
        prepared->skin_box.emplace();
        for (const Vec3& point : points) prepared->skin_box->add(point);
    }
    constexpr double kBefore = 0.01;  // of the diagonal; rays of perspective begin at a hundredth of it
    const Box& box = *prepared->skin_box;
    const auto is_before = [&, least = kBefore * box.diagonal()](const Vec3& point) { return view.to_eye(point).z > least; };
    const auto corner = [&](int k) {
        const auto end = [&](int axis) { return (k >> axis & 1) != 0 ? box.upper[axis] : box.lower[axis]; };
        return Vec3(end(0), end(1), end(2));
    };
    bool all = true;
    for (int k = 0; k < 8; ++k) all = all && is_before(corner(k));
    return all || std::ranges::all_of(points, is_before);
}

const BoundaryValues& PictureMaker::State::skin_of_mesh(Progress* progress, Facts& facts) {
    if (prepared->skin) return *prepared->skin;
    const auto refine = [&](const auto& hull_or_mesh) {
        const std::optional<int> most = body.tets ? std::optional(0) : options.kernels.levels;
        return refinement(picture_levels(hull_or_mesh, most), progress);
    };
    if (is_in_pieces()) {
        const MeshHull& all = hull_of_pieces(progress, facts);
        prepared->skin = facts.timed(progress, "boundary", [&] { return boundary_values(all, refine(all)); });
        return *prepared->skin;
    }
    prepared->skin = facts.timed(progress, "boundary", [&] {
        if (!body.moved) return boundary_values(*mesh(), refine(*mesh()));
        if (!tables) tables.emplace(*mesh(), refine(*mesh()));
        return tables->apply(*mesh());
    });
    return *prepared->skin;
}

const RbfVolume& PictureMaker::State::kernels(const Optics& optics, Progress* progress, Facts& facts) {
    if (body.kernels != nullptr) return *body.kernels;
    if (prepared->kernels->volume) return *prepared->kernels->volume;
    KernelOptions choices = options.kernels;
    choices.tets = body.tets;
    choices.progress = progress;
    if (options.drop_invisible && !choices.visible) choices.visible = optics.function();
    if (choices.visible && is_relative()) choices.visible = detail::less(*choices.visible, prepared->kernels->origins);
    SampleOptions sample = choices.sample;
    sample.progress = progress;
    if (body.moved && !choices.tets && !choices.levels && !choices.visible && choices.reduce_rmse == 0 &&
        SampleTables::are_for(sample)) {
        prepared->kernels->volume = facts.timed(progress, "sample", [&] {
            if (!kernel_tables) kernel_tables.emplace(*mesh(), sample);
            return kernel_tables->apply(mesh_of_kernels()).volume;
        });
        return *prepared->kernels->volume;
    }
    prepared->kernels->volume = facts.unpack(make_mesh_kernels(mesh_of_kernels(), choices));
    return *prepared->kernels->volume;
}

const MeshHull& PictureMaker::State::hull_of_pieces(Progress* progress, Facts& facts) {
    if (!prepared->hull) prepared->hull = facts.timed(progress, "hull", [&] { return gather_hull(*body.mesh, progress); });
    return *prepared->hull;
}

Facts PictureMaker::State::prepare(const Optics& optics, Progress* progress) {
    check_method(method(), body.kind(), options.names);
    settle_origins(optics);
    Facts facts;
    if (is_translucent()) {
        if (!body.mesh) {
            throw Error(ErrorCode::InvalidInput, "of a solid are those of its surface, for which a mesh is needed",
                        option_name("opacity", options.names), "look volume");
        }
        if (!options.style.clip.slices.empty()) {
            throw Error(ErrorCode::InvalidInput, "slices lie in volumes and in opaque solids",
                        option_name("slice", options.names), "look volume, or no " + option_name("opacity", options.names));
        }
        (void)skin_of_mesh(progress, facts);
        prepared->hull.reset();
        return facts;
    }
    if (may_show_first_hits()) {
        (void)skin_of_mesh(progress, facts);
        if (is_cut()) prepare_cuts(optics, progress, facts);
        prepared->hull.reset();
    }
    if (!may_show_first_hits()) prepare_inside(optics, progress, facts);
    warn_of_range(facts);
    return facts;
}

void PictureMaker::State::prepare_cuts(const Optics& optics, Progress* progress, Facts& facts) {
    if (prepared->kernels->at_cuts) return;
    const RbfVolume& volume = kernels(optics, progress, facts);
    prepared->kernels->at_cuts.emplace(volume, RbfFieldOptions{.channel = shown_channels().back()});
}

void PictureMaker::State::prepare_inside(const Optics& optics, Progress* progress, Facts& facts) {
    if (is_in_pieces()) {
        prepare_pieces(progress, facts);
    } else if (draws_kernels(method())) {
        if (options.seconds) return;
        if (paints_splats()) (void)skin_of_mesh(progress, facts);
        if (!prepared->kernels->levels && body.file != nullptr)
            prepared->kernels->levels.emplace(*body.file, body.channels, options.lod.value_or(0));
        if (!prepared->kernels->levels) {
            const RbfVolume& all = kernels(optics, progress, facts);
            prepared->kernels->levels.emplace(all, options.lod.value_or(0), shown_channels().front(), progress, facts);
        }
    } else if (method() == Method::Grid) {
        if (is_solid() && body.voxels->is_level_set()) {
            throw Error(ErrorCode::InvalidInput, "draws no surface, as which a level set is shown",
                        option_name("method", options.names) + " grid", "method splat; look volume shows its distances");
        }
    } else {
        prepare_cells(progress, facts);
    }
}

void PictureMaker::State::prepare_cells(Progress* progress, Facts& facts) {
    const auto make_tets = [&](const auto& fine) {
        if (method() == Method::Tets) {
            prepared->cells.tets.emplace(fine, "", progress);
            facts.add_seconds("prepare", prepared->cells.tets->seconds_build());
        } else {
            prepared->cells.projected.emplace(fine, "", options.splat.device, progress);
            facts.add_seconds("prepare", prepared->cells.projected->seconds_build());
        }
    };
    const bool missing =
        (method() == Method::Tets && !prepared->cells.tets) || (method() == Method::Projected && !prepared->cells.projected);
    if (missing && body.tets) {
        make_tets(join_split_cells(*mesh()));
    } else if (missing) {
        const RefineOptions refine = refinement(options.kernels.levels.value_or(tets_level(mesh()->cells.size())), progress);
        make_tets(facts.unpack(refined_on_limit(*mesh(), refine, options.kernels.levels_option)));
    }
    if (lights_boundary()) (void)skin_of_mesh(progress, facts);
}

void PictureMaker::State::prepare_pieces(Progress* progress, Facts& facts) {
    const bool by_kernels = draws_kernels(method());
    if (by_kernels ? paints_finished() : lights_boundary()) (void)skin_of_mesh(progress, facts);
    if (by_kernels && !prepared->pieces.boundary) {
        SampleOptions sample = options.kernels.sample;
        sample.progress = progress;
        const MeshHull& all = hull_of_pieces(progress, facts);
        prepared->pieces.boundary = facts.timed(progress, "boundary", [&] { return sample_boundary(all, sample); });
    }
    prepared->hull.reset();
    if (by_kernels || prepared->pieces.tets) return;
    const BrickTetsOptions tet_options = piece_tets_options(progress);
    prepared->pieces.tets = facts.timed(progress, "measure", [&] {
        return team != nullptr ? team->measure(*body.mesh, tet_options)
                               : measure_tets(*body.mesh, tet_options, 0, body.mesh->stored().pieces.size());
    });
    facts["levels"] = tet_options.refine.levels;
    facts["cells"] = prepared->pieces.tets->tets / 6;
}

std::uint64_t PictureMaker::State::cells_of_pieces() const {
    std::uint64_t cells = 0;
    for (const PieceExtent& piece : body.mesh->stored().pieces) cells += piece.cells;
    return cells;
}

BrickTetsOptions PictureMaker::State::piece_tets_options(Progress* progress) const {
    return {.refine = refinement(options.kernels.levels.value_or(tets_level(cells_of_pieces())), progress),
            .tets = {.progress = progress},
            .memory_bytes = options.memory_bytes};
}

std::vector<std::size_t> PictureMaker::State::shown_channels() const {
    if (body.kernels != nullptr && !body.channels.empty()) return body.channels;
    const std::size_t count = mesh() != nullptr         ? mesh()->attributes.size()
                              : body.file != nullptr    ? body.channels.size()
                              : body.kernels != nullptr ? body.kernels->channels.size()
                                                        : 1;
    return count > 1 ? std::vector<std::size_t>{0, count - 1} : std::vector<std::size_t>{0};
}

}  // namespace subvol
