// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_maker.h"

#include <utility>

#include "picture_state.h"
#include "subvol/detail/points_frame.h"
#include "subvol/error.h"

namespace subvol {

BodyKind PictureBody::kind() const {
    if (mesh && mesh->mesh() == nullptr) return BodyKind::Bricks;
    if (voxels != nullptr) return BodyKind::Voxels;
    if (file != nullptr) return BodyKind::KernelFile;
    if (kernels != nullptr) return BodyKind::Kernels;
    return tets ? BodyKind::Tets : BodyKind::Mesh;
}

PictureMaker::PictureMaker(PictureBody body, MethodOptions options, PictureTeam* team) {
    check_method(options.style.method, body.kind(), options.names);
    validate(options);
    state_ = std::make_unique<State>(State{.body = std::move(body), .options = std::move(options), .team = team});
}

PictureMaker::~PictureMaker() = default;
PictureMaker::PictureMaker(PictureMaker&&) noexcept = default;
PictureMaker& PictureMaker::operator=(PictureMaker&&) noexcept = default;

void PictureMaker::set_body(PictureBody body) {
    state_->set_body(std::move(body));
}

void PictureMaker::set_style(const PictureStyle& style) {
    validate(style, state_->options.names);
    state_->options.style = style;
}

Facts PictureMaker::prepare(const Optics& optics, Progress* progress, bool splatter) {
    Facts facts = state_->prepare(optics, progress);
    if (splatter && state_->prepared->kernels->levels && state_->draws_all_kernels())
        (void)state_->splatter(*state_->prepared->kernels->levels->all(), 0, optics);
    return facts;
}

Picture PictureMaker::draw(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
    Facts facts = state_->prepare(optics, progress);
    state_->warn_of_tiny_bodies(view, facts);
    std::optional<Picture> first_hits;
    if (state_->shows_first_hits(view)) first_hits = state_->draw_first_hits(view, optics, progress);
    if (!first_hits && state_->may_show_first_hits()) state_->prepare_inside(optics, progress, facts);
    Picture picture = first_hits ? std::move(*first_hits) : state_->drawn_rows(view, optics, progress, stand_in);
    if (state_->team != nullptr) state_->team->gather(picture);
    if (!first_hits) state_->finish(picture, view, optics);
    facts.merge(picture.facts);
    picture.facts = std::move(facts);
    return picture;
}

Facts PictureMaker::measure_error(const Picture& picture, const View& view, const Optics& optics, Progress* progress) {
    Facts facts;
    const FactValue* said = picture.facts.find("sheets");
    const auto* sheets = said == nullptr ? nullptr : std::get_if<std::int64_t>(&said->value);
    if (sheets == nullptr || *sheets < 2 || !state_->has_chosen_sheets()) return facts;
    const detail::SheetError error = facts.timed(progress, "error", [&] {
        return state_->sheet_error(picture.image, static_cast<int>(*sheets), view, optics, progress);
    });
    facts["image_error"] = error.rms;
    facts["image_error_max"] = error.largest;
    return facts;
}

std::vector<Vec3> PictureMaker::framed_points(const Optics& optics, Progress* progress, Facts& facts) {
    const Look look = state_->options.style.look.look;
    if (const HexMesh* mesh = state_->mesh()) return subvol::framed_points(*mesh, look, optics);
    const bool in_pieces = state_->is_in_pieces();
    if (look != Look::Solid) {
        if (!in_pieces) return {};
        return facts.timed(progress, "frame",
                           [&] { return subvol::framed_points(*state_->body.mesh, look, optics, progress); });
    }
    if (const RbfVolume* kernels = state_->body.kernels) return detail::outline_of(*kernels);
    if (KernelFile* file = state_->body.file) return file->boundary().points;
    if (!in_pieces) return {};
    return state_->hull_of_pieces(progress, facts).mesh.points;
}

bool PictureMaker::paints_boundary() const {
    return state_->paints_boundary();
}

const BoundaryValues& PictureMaker::skin(Progress* progress, Facts& facts) {
    return state_->skin_of_mesh(progress, facts);
}

const Surface& PictureMaker::boundary(const Optics& optics, Progress* progress, Facts& facts) {
    const bool of_kernels = draws_kernels(state_->method()) && !state_->is_translucent() && !state_->options.seconds &&
                            !state_->may_show_first_hits();
    state_->settle_origins(optics);
    return of_kernels ? state_->kernels(optics, progress, facts).boundary : state_->skin_of_mesh(progress, facts).surface;
}

bool PictureMaker::keeps_kernels(const Optics& optics) const {
    return state_->origins_for(optics) == state_->prepared->kernels->origins;
}

const RbfVolume& PictureMaker::kernels(const Optics& optics, Progress* progress, Facts& facts) {
    state_->settle_origins(optics);
    return state_->kernels(optics, progress, facts);
}

}  // namespace subvol
