// SPDX-License-Identifier: Apache-2.0
#include "sheet_target.h"

#include "gl_context.h"
#include "subvol/error.h"

namespace subvol::detail {

void SheetTarget::begin(int width, int height, bool four_more) {
    if (width != width_ || height != height_ || four_more != four_more_) make(width, height, four_more);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
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
