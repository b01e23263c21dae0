// SPDX-License-Identifier: Apache-2.0
#include "picture_output.h"

#include <algorithm>
#include <limits>

#include "outputs.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// Reports all frames as one stage, whose fraction grows from frame to frame.
class FrameProgress : public Progress {
public:
    FrameProgress(Progress* whole, std::size_t frame, std::size_t frames)
        : whole_(whole),
          stage_(text("frame ", frame + 1, " of ", frames)),
          fraction_(static_cast<double>(frame) / static_cast<double>(frames)) {}

    void report(std::string_view, double) override { whole_->report(stage_, fraction_); }
    [[nodiscard]] bool cancelled() const override { return whole_->cancelled(); }

private:
    Progress* whole_;
    std::string stage_;
    double fraction_;
};

/// The largest opacity of a pixel.
float most_opaque(const Image& image) {
    float most = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) most = std::max(most, image.rgba[i]);
    return most;
}

void warn_if_empty(float opacity, Report& report) {
    constexpr float kLeastByte = 0.5F / 255;  // what is less is 0 in a .png
    if (opacity == 0) {
        report.warn("the picture is empty: no pixel is hit where the volume is opaque (--fit, --view, --opacity, --samples)");
    } else if (opacity < kLeastByte) {
        report.warn(text("the picture is nearly empty: no pixel is more opaque than ", opacity,
                         " (a shorter --opacity-unit makes the volume more opaque)"));
    }
}

}  // namespace

PictureOutput::PictureOutput(const std::string& path, std::optional<int> frames, const PictureArguments& arguments)
    : path_(path), frames_(frames), sheet_(arguments.views.has_value()), background_(arguments.background_color()) {
    if (sheet_ && frames_)
        throw Error(ErrorCode::InvalidInput, "a sheet of views does not turn", "--views", "--turntable alone");
    if (!is_video(path_)) {
        check_output(path_, {".png", ".exr"});
    } else if (!frames_) {
        throw Error(ErrorCode::InvalidInput, "only a turntable makes a video", path, "--turntable N, or .png or .exr");
    } else {
        video_.emplace(path_, parse_size("--size", arguments.size), arguments.frames_per_second);
    }
}

void PictureOutput::write_sheet(const std::vector<View>& views, const std::function<Picture(const View&, Progress*)>& draw,
                                Report& report) {
    const int width = views.front().width(), height = views.front().height();
    Picture sheet{Image(2 * width, 2 * height), {}};
    sheet.depth.assign(sheet.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    float opacity = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        Picture part = draw(views[i], report.progress());
        opacity = std::max(opacity, most_opaque(part.image));
        notes_.draw_over(part, views[i]);
        const int left = static_cast<int>(i % 2) * width, top = static_cast<int>(i / 2) * height;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                std::ranges::copy(part.image.pixel(x, y), sheet.image.pixel(left + x, top + y).begin());
                if (part.depth.empty()) continue;
                sheet.depth[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(2 * width) +
                            static_cast<std::size_t>(left + x)] =
                    part.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
            }
        }
    }
    warn_if_empty(opacity, report);
    const detail::Stopwatch watch;
    notes_.add_legend(sheet);
    write_frame(0, sheet);
    report.add_seconds("write", watch.seconds());
    report["output"] = frame_path(0).string();
}

void PictureOutput::write(const std::vector<View>& views, const std::function<Picture(const View&, Progress*)>& draw,
                          Report& report) {
    if (sheet_) return write_sheet(views, draw, report);
    float opacity = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        FrameProgress of_frame(report.progress(), i, views.size());
        Progress* const progress = frames_ ? &of_frame : report.progress();
        report_progress(progress, "draw", 0);
        Picture picture = draw(views[i], progress);
        opacity = std::max(opacity, most_opaque(picture.image));
        const detail::Stopwatch watch;
        notes_.draw_over(picture, views[i]);
        notes_.add_legend(picture);
        write_frame(i, picture);
        report.add_seconds("write", watch.seconds());
    }
    warn_if_empty(opacity, report);
    report["output"] = frame_path(0).string();
    if (!frames_) return;
    report["frames"] = *frames_;
    if (video_) {
        report.timed("write", [&] { video_->finish(); });
    } else {
        for (std::size_t i = 0; i < views.size(); ++i) report["outputs"].push_back(frame_path(i).string());
    }
}

std::filesystem::path PictureOutput::frame_path(std::size_t frame) const {
    if (!frames_ || video_) return path_;
    const std::string number = std::to_string(frame);
    const std::size_t digits = std::max<std::size_t>(4, std::to_string(*frames_ - 1).size());
    return path_.parent_path() /
           (path_.stem().string() + "_" + std::string(digits - number.size(), '0') + number + path_.extension().string());
}

void PictureOutput::write_frame(std::size_t frame, const Picture& picture) {
    if (video_) {
        video_->write(srgb_bytes(picture.image, background_));
    } else {
        write_image(frame_path(frame), picture.image, background_, picture.depth);
    }
}

}  // namespace subvol::cli
