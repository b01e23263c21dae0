// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <utility>
#include <vector>

namespace subvol::detail {

/// A piece of shader source, and the file name for messages.
struct ShaderText {
    std::string file;
    std::string text;
};

/// A program of the current context. Compiler messages name file and line.
class GlProgram {
public:
    /// defines: text that is inserted after the version line, with which the source begins
    /// common:  pieces that are inserted between the defines and the source, without a version line
    /// throws:  Error(MissingCapability) with the driver's message
    GlProgram(const std::string& file, const std::string& source, const std::string& defines,
              const std::vector<ShaderText>& common = {});

    /// The same for a program that draws.
    GlProgram(const ShaderText& vertex, const ShaderText& fragment, const std::string& defines,
              const std::vector<ShaderText>& common = {});
    ~GlProgram();
    GlProgram(GlProgram&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlProgram& operator=(GlProgram&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }

    void use() const { glUseProgram(id_); }
    [[nodiscard]] GLuint id() const { return id_; }
    [[nodiscard]] GLint uniform(const char* name) const { return glGetUniformLocation(id_, name); }

private:
    GLuint id_ = 0;
};

}  // namespace subvol::detail
