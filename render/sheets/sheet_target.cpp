// SPDX-License-Identifier: Apache-2.0
#include "sheet_target.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>

#include "gl_context.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kChunks = 64;
constexpr float kMargin_px = 0.5f;  // so that rounding does not lose the rim of a section

/// Finds the sheets that kernels cut, and the pixels of the sections.
class Sections {
public:
    Sections(const SplatFrame& frame, const PixelRect& window, int first, int last)
        : frame_(frame),
          window_(window),
          first_(first),
          last_(last),
          per_pixel_(static_cast<float>(1 / frame.view->pixel())),
          mid_x_(0.5f * static_cast<float>(frame.view->width())),
          mid_y_(0.5f * static_cast<float>(frame.view->height())) {}

    /// Calls visit(sheet, rectangle) for each sheet on which the kernel touches the window.
    template <class Visit>
    void each(const EyeSplat& s, const Visit& visit) const {
        const SheetStack& sheets = frame_.sheets;
        const float reach = 1.0f / std::sqrt(s.inv_szz), per_sheet = 1.0f / sheets.distance;
        const auto sheet = [&](float z) {
            return std::clamp((z - sheets.first) * per_sheet, static_cast<float>(first_) - 1.0f, static_cast<float>(last_));
        };
        // Half a sheet more on each side, so that rounding does not lose one. A sheet that is not cut has an empty section.
        const int begin = std::max(static_cast<int>(std::floor(sheet(s.depth - reach) + 0.5f)), first_);
        const int end = std::min(static_cast<int>(std::floor(sheet(s.depth + reach) + 1.5f)), last_);
        for (int k = begin; k < end; ++k) {
            const PixelRect rect = section(s, sheets.depth(k));
            if (!rect.empty()) visit(k, rect);
        }
    }

private:
    [[nodiscard]] PixelRect section(const EyeSplat& s, float sheet_z) const {
        const float zs = sheet_z - s.depth, left = 1.0f - zs * zs * s.inv_szz;
        if (!(left > 0)) return {};
        const float to_pixels = frame_.view->perspective() ? per_pixel_ / (frame_.sheets.middle + sheet_z) : per_pixel_;
        const float root = std::sqrt(left);
        const float x = (s.center_x + s.shear_x * zs) * to_pixels + mid_x_, hx = s.extent_x * root * to_pixels + kMargin_px;
        const float y = mid_y_ - (s.center_y + s.shear_y * zs) * to_pixels, hy = s.extent_y * root * to_pixels + kMargin_px;
        const auto clipped = [](float px, int low, int high) {
            return static_cast<int>(std::clamp(px, static_cast<float>(low), static_cast<float>(high)));
        };
        return {clipped(std::floor(x - hx), window_.x0, window_.x1), clipped(std::floor(y - hy), window_.y0, window_.y1),
                clipped(std::ceil(x + hx), window_.x0, window_.x1), clipped(std::ceil(y + hy), window_.y0, window_.y1)};
    }

    const SplatFrame& frame_;
    PixelRect window_;
    int first_, last_;
    float per_pixel_, mid_x_, mid_y_;
};

}  // namespace

PixelRect seen_pixels(const SplatFrame& frame) {
    const int width = frame.view->width(), height = frame.view->height();
    if (frame.intervals.offsets.empty()) return {0, 0, width, height};
    PixelRect seen;
    std::size_t id = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x, ++id) {
            if (frame.intervals.offsets[id] != frame.intervals.offsets[id + 1]) seen = seen.with({x, y, x + 1, y + 1});
        }
    }
    return seen;
}

SheetLists list_sheets(const SplatFrame& frame, const PixelRect& window, int first, int last) {
    const auto& splats = frame.kernels.splats;
    const auto sheets = static_cast<std::size_t>(last - first);
    const std::size_t chunks = std::clamp<std::size_t>(splats.size() / 4096, 1, kChunks);
    const Sections sections(frame, window, first, last);
    std::vector<std::size_t> next(sheets * chunks);
    std::vector<PixelRect> rects(sheets * chunks);
    std::vector<std::size_t> fragments(sheets * chunks);
    // Calls visit(slot, kernel, rectangle); a slot belongs to a sheet and a chunk of kernels.
    const auto each = [&](const auto& visit) {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
            for (std::size_t i = splats.size() * chunk / chunks; i < splats.size() * (chunk + 1) / chunks; ++i) {
                sections.each(splats[i], [&](int sheet, const PixelRect& rect) {
                    visit(static_cast<std::size_t>(sheet - first) * chunks + chunk, i, rect);
                });
            }
        });
    };
    each([&](std::size_t slot, std::size_t, const PixelRect& rect) {
        ++next[slot];
        rects[slot] = rects[slot].with(rect);
        fragments[slot] += pixel_count(rect.x1 - rect.x0, rect.y1 - rect.y0);
    });
    SheetLists lists;
    lists.rects.resize(sheets);
    lists.fragments.resize(sheets);
    lists.offsets.resize(sheets + 1);
    std::size_t sum = 0;
    for (std::size_t slot = 0; slot < next.size(); ++slot) {
        if (slot % chunks == 0) lists.offsets[slot / chunks] = sum;
        sum += std::exchange(next[slot], sum);
        lists.rects[slot / chunks] = lists.rects[slot / chunks].with(rects[slot]);
        lists.fragments[slot / chunks] += fragments[slot];
    }
    lists.offsets[sheets] = sum;
    lists.splats.resize(sum);
    each(
        [&](std::size_t slot, std::size_t i, const PixelRect&) { lists.splats[next[slot]++] = static_cast<std::uint32_t>(i); });
    return lists;
}

void SheetTarget::begin(int width, int height, bool four_more) {
    if (width != width_ || height != height_ || four_more != four_more_) make(width, height, four_more);
    for (GLuint unit = 0; unit < 2; ++unit) glBindTextureUnit(unit, textures_[unit]);
    glViewport(0, 0, width, height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DITHER);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);
    clear({0, 0, width, height});
    check_gl("the buffer of a sheet");
}

void SheetTarget::clear(const PixelRect& rect) {
    constexpr std::array<GLfloat, 4> kNothing{};
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
    for (GLint i = 0; i < (four_more_ ? 2 : 1); ++i) glClearBufferfv(GL_COLOR, i, kNothing.data());
}

void SheetTarget::make(int width, int height, bool four_more) {
    release();
    check_picture_size(width, height, "use the CPU backend");
    check_gl("earlier work");
    constexpr std::array<GLenum, 2> kFormats{GL_RG32F, GL_RGBA32F};
    constexpr std::array<GLenum, 2> kPlaces{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    const GLsizei count = four_more ? 2 : 1;
    glCreateFramebuffers(1, &framebuffer_);
    glCreateTextures(GL_TEXTURE_2D, count, textures_.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        glTextureStorage2D(textures_[i], 1, kFormats[i], width, height);
        glTextureParameteri(textures_[i], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(textures_[i], GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glNamedFramebufferTexture(framebuffer_, kPlaces[i], textures_[i], 0);
    }
    glNamedFramebufferDrawBuffers(framebuffer_, count, kPlaces.data());
    check_gl("the buffer of a sheet");
    if (glCheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorCode::MissingCapability, "the GL device does not draw into floats", {}, "use the CPU backend");
    width_ = width;
    height_ = height;
    four_more_ = four_more;
}

void SheetTarget::release() {
    if (framebuffer_ != 0) glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());  // deleting 0 does nothing
    framebuffer_ = 0;
    textures_ = {};
    width_ = height_ = 0;
}

}  // namespace subvol::detail
