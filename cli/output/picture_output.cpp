// SPDX-License-Identifier: Apache-2.0
#include "picture_output.h"

#include <algorithm>
#include <limits>

#include "mesh_frames.h"
#include "outputs.h"
#include "part_kinds.h"
#include "picture_shares.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/raster.h"
#include "subvol/view_options.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// The largest opacity of a pixel.
float most_opaque(const Image& image) {
    float most = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) most = std::max(most, image.rgba[i]);
    return most;
}

/// Whether a .png shows anything in front of its background.
bool is_blank(const Image& image, const Vec3& background) {
    const auto behind = srgb_bytes(Image(1, 1), background);
    const auto bytes = srgb_bytes(image, background);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (bytes[i] != behind[i % behind.size()]) return false;
    }
    return true;
}

void warn_if_blank(bool blank, float opacity, Facts& facts) {
    if (opacity == 0 || !blank) return;
    facts.warn("the picture is blank: what is drawn has the colour of the background (--background black, or another --tf)");
}

void warn_if_empty(float opacity, Facts& facts) {
    constexpr float kLeastByte = 0.5F / 255;  // what is less is 0 in a .png
    if (opacity == 0) {
        facts.warn(
            "the picture is empty: no pixel is hit where the volume is opaque (--fit, --view, --clip, --opacity, --samples)");
    } else if (opacity < kLeastByte) {
        facts.warn(text("the picture is nearly empty: no pixel is more opaque than ", opacity,
                        " (a shorter --opacity-unit makes the volume more opaque)"));
    }
}

}  // namespace

PictureOutput::PictureOutput(const std::string& path, std::optional<int> frames, const PictureArguments& arguments, int first)
    : path_(path),
      frames_(frames),
      first_(first),
      sheet_(arguments.sheet_views()),
      columns_(arguments.sheet_columns()),
      background_(arguments.background_color()),
      transparent_(arguments.transparent()) {
    if (!sheet_.empty() && frames_)
        throw Error(ErrorCode::InvalidInput, "a sheet of views does not turn", "--views", "--turntable alone");
    if (!is_video(path_)) {
        check_output(path_, {".png", ".exr", ".jpg", ".jpeg", ".webp"});
        if (transparent_ && path_.extension() != ".png" && path_.extension() != ".exr")
            throw Error(ErrorCode::InvalidInput, "has no alpha", path_.string(), "--background COLOR, or .png or .exr");
    } else if (!frames_) {
        throw Error(ErrorCode::InvalidInput, "only a turntable or steps make a video", path,
                    "--turntable N, --step all, or .png or .exr");
    } else {
        if (transparent_) throw Error(ErrorCode::InvalidInput, "a video has no alpha", "--background none", "a colour");
        const double rate = arguments.duration_s ? *frames_ / *arguments.duration_s : arguments.frames_per_second;
        video_.emplace(path_, arguments.eye.size, rate);
    }
}

void PictureOutput::set_share(const Share& share, PartNote note) {
    share_ = share;
    note_ = std::move(note);
    if (video_) {
        throw Error(ErrorCode::InvalidInput, "a video is not made in shares", path_.string(),
                    "numbered pictures: NAME_####.png");
    }
    if (!sheet_.empty()) throw Error(ErrorCode::InvalidInput, "a sheet of views is not made in shares", "--views");
    if (!frames_ && path_.extension() != ".exr") {
        throw Error(ErrorCode::InvalidInput, "a share of a picture is written as .exr", path_.string(),
                    ".exr; `subvol join` writes .png or .exr");
    }
}

bool PictureOutput::wants_next() const {
    if (!share_ || !frames_) return true;
    const auto [begin, end] = share_->range(static_cast<std::size_t>(*frames_));
    return written_ >= begin && written_ < end;
}

Facts PictureOutput::write_sheet(const std::vector<View>& views, const DrawPicture& draw, Progress* progress) {
    Facts facts;
    const int width = views.front().width(), height = views.front().height();
    const int rows = (static_cast<int>(views.size()) + columns_ - 1) / columns_;
    Picture sheet{Image(columns_ * width, rows * height), {}};
    sheet.depth.assign(sheet.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const bool is_png = path_.extension() != ".exr" && !transparent_;
    bool blank = true;
    for (std::size_t i = 0; i < views.size(); ++i) {
        cameras_.emplace_back(facts_of(views[i].camera()));
        Picture part = draw(notes_.view_of_volume(views[i]), progress);
        facts.merge(part.facts);
        const DrawnLines within = notes_.draw_within(views[i], draw, progress);
        notes_.draw_shells(part, views[i]);
        opacity_ = std::max(opacity_, most_opaque(part.image));  // before anything is drawn over it
        blank = blank && is_png && is_blank(part.image, background_);
        notes_.draw_over(part, views[i], within);
        notes_.name_view(part, sheet_[i]);
        const int number = static_cast<int>(i);
        const int left = number % columns_ * width, top = number / columns_ * height;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                std::ranges::copy(part.image.pixel(x, y), sheet.image.pixel(left + x, top + y).begin());
                if (part.depth.empty()) continue;
                sheet.depth[pixel_index(columns_ * width, left + x, top + y)] = part.depth[pixel_index(width, x, y)];
            }
        }
    }
    if (silent_) return facts;
    if (is_png) warn_if_blank(blank, opacity_, facts);
    const detail::Stopwatch watch;
    notes_.add_margins(sheet);
    write_frame(0, sheet, rows * height, {});
    facts.add_seconds("write", watch.seconds());
    return facts;
}

Facts PictureOutput::write(const std::vector<View>& views, const DrawPicture& draw, Progress* whole) {
    if (!sheet_.empty()) return write_sheet(views, draw, whole);
    Facts facts;
    for (const View& view : views) {
        if (!wants_next()) {
            skip();
            continue;
        }
        const auto frames = static_cast<std::size_t>(frames_.value_or(1));
        detail::PartOfProgress of_frame(whole, text("frame ", written_ + 1, " of ", frames), written_, frames);
        Progress* const progress = frames_ ? &of_frame : whole;
        report_progress(progress, "draw", 0);
        cameras_.emplace_back(facts_of(view.camera()));
        Picture picture = draw(notes_.view_of_volume(view), progress);
        facts.merge(picture.facts);
        const DrawnLines within = notes_.draw_within(view, draw, progress);
        if (silent_) {
            ++written_;
            continue;
        }
        notes_.draw_shells(picture, view);
        const float opacity = most_opaque(picture.image);
        opacity_ = std::max(opacity_, opacity);
        if (written_ == 0 && path_.extension() != ".exr" && !transparent_) {
            warn_if_blank(is_blank(picture.image, background_), opacity, facts);
        }
        const detail::Stopwatch watch;
        notes_.draw_over(picture, view, within);
        notes_.add_margins(picture);
        const bool alone = picture.image.width == view.width() && picture.image.height == view.height();  // without margins
        write_frame(written_++, picture, view.height(), alone ? camera_text(view.camera()) : std::string());
        facts.add_seconds("write", watch.seconds());
    }
    return facts;
}

Facts PictureOutput::finish(Progress* progress) {
    Facts facts;
    if (silent_) return facts;
    if (!share_) warn_if_empty(opacity_, facts);
    if (share_) facts["part"] = share_->name();
    std::size_t first = 0;
    while (left_out_.contains(first)) ++first;
    facts["output"] = frame_path(first).string();
    if (cameras_.size() == 1) {
        facts["camera"] = cameras_.front();
    } else if (!cameras_.empty()) {
        facts["cameras"] = cameras_;
    }
    if (!frames_) return facts;
    facts["frames"] = static_cast<std::size_t>(*frames_) - left_out_.size();
    if (video_) {
        facts.timed(progress, "write", [&] { video_->finish(); });
    } else {
        const auto [begin, end] = share_.value_or(Share{}).range(static_cast<std::size_t>(*frames_));
        FactValue::List outputs;
        for (std::size_t i = begin; i < std::min(end, written_); ++i) {
            if (!left_out_.contains(i)) outputs.emplace_back(frame_path(i).string());
        }
        facts["outputs"] = outputs;
    }
    return facts;
}

std::filesystem::path PictureOutput::frame_path(std::size_t frame) const {
    if (!frames_ || video_) return path_;
    const int numbered = first_ + static_cast<int>(frame);
    if (has_number(path_.string())) return with_number(path_.string(), numbered);
    const std::string number = std::to_string(numbered);
    const std::size_t digits = std::max<std::size_t>(4, std::to_string(first_ + *frames_ - 1).size());
    return path_.parent_path() / (path_.stem().string() + (path_.stem().string().ends_with('_') ? "" : "_") +
                                  std::string(digits - number.size(), '0') + number + path_.extension().string());
}

void PictureOutput::write_frame(std::size_t frame, const Picture& picture, int body_rows, const std::string& camera) {
    if (video_) {
        video_->write(srgb_bytes(picture.image, background_));
    } else if (share_ && !frames_) {
        write_rows(picture, body_rows, camera);
    } else {
        write_image(frame_path(frame), picture.image, transparent_ ? std::nullopt : std::optional(background_), picture.depth,
                    camera);
    }
}

void PictureOutput::write_rows(const Picture& picture, int body_rows, const std::string& camera) {
    const Image& image = picture.image;
    PixelRows rows = rows_of(*share_, body_rows);  // of the body; the first and the last share have the margins, too
    rows.first = share_->number == 1 ? 0 : rows.first + notes_.caption_px;
    rows.end = share_->number == share_->count ? image.height : rows.end + notes_.caption_px;
    note_.range = {static_cast<std::uint64_t>(rows.first), static_cast<std::uint64_t>(rows.end),
                   static_cast<std::uint64_t>(image.height)};
    note_.how = {{"first_row", rows.first},
                 {"end_row", rows.end},
                 {"height", image.height},
                 {"camera", camera},
                 {"background", {background_.x, background_.y, background_.z}}};
    (void)deliver(PictureParts{path_}, rows_of(picture, rows), {.share = *share_, .note = note_});
}

}  // namespace subvol::cli
