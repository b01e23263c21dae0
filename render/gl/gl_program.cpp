// SPDX-License-Identifier: Apache-2.0
#include "gl_program.h"

#include <sstream>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// Puts together the source's version line, the defines, the common pieces and the rest of the source. Compiler messages name a
/// piece by its number: the source is 0, the common pieces follow.
std::string compose(const std::string& source, const std::string& defines, const std::vector<ShaderText>& common) {
    const auto after_version = source.find('\n') + 1;
    std::string text = source.substr(0, after_version) + defines;
    for (std::size_t i = 0; i < common.size(); ++i) text += "\n#line 1 " + std::to_string(i + 1) + "\n" + common[i].text;
    return text + "\n#line 2 0\n" + source.substr(after_version);
}

/// Drivers write "1:23(5): error" or "1(23) : error". Replaces the leading number by the file, so that a line reads "file:23…".
std::string with_file(const std::string& line, const std::vector<std::string>& files) {
    constexpr const char* kDigits = "0123456789";
    const std::size_t end = line.find_first_not_of(kDigits);
    if (end == 0 || end > 4 || (line[end] != ':' && line[end] != '(')) return line;  // a longer number does not name a piece
    const std::size_t piece = std::stoul(line), number_end = line.find_first_not_of(kDigits, end + 1);
    if (piece >= files.size() || number_end == std::string::npos || number_end == end + 1) return line;
    const std::size_t rest = number_end + (line[end] == '(' && line[number_end] == ')' ? 1 : 0);
    return files[piece] + ":" + line.substr(end + 1, number_end - end - 1) + line.substr(rest);
}

std::string with_files(const std::string& log, const std::vector<std::string>& files) {
    std::istringstream lines(log);
    std::string result;
    for (std::string line; std::getline(lines, line);) result += (result.empty() ? "" : "\n") + with_file(line, files);
    return result;
}

template <class GetLength, class GetLog>
std::string log_of(GLuint id, GetLength get_length, GetLog get_log) {
    GLint length = 0;
    get_length(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length > 0 ? length : 0), '\0');
    GLsizei written = 0;
    if (!log.empty()) get_log(id, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

/// Deletes the program unless it is released: an exception leaves no program behind.
class OwnedProgram {
public:
    OwnedProgram() : id_(glCreateProgram()) {}
    ~OwnedProgram() {
        if (id_ != 0) glDeleteProgram(id_);
    }
    OwnedProgram(const OwnedProgram&) = delete;
    OwnedProgram& operator=(const OwnedProgram&) = delete;

    void attach(GLenum stage, const ShaderText& source, const std::string& defines, const std::vector<ShaderText>& common) {
        const std::string text = compose(source.text, defines, common);
        const GLuint shader = glCreateShader(stage);
        const char* pointer = text.c_str();
        glShaderSource(shader, 1, &pointer, nullptr);
        glCompileShader(shader);
        GLint ok = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
        if (!ok) {
            const std::string log = with_files(log_of(shader, glGetShaderiv, glGetShaderInfoLog), files(source, common));
            glDeleteShader(shader);
            throw Error(ErrorCode::MissingCapability, "the GL driver rejects the shader: " + log, source.file);
        }
        glAttachShader(id_, shader);
        glDeleteShader(shader);  // is deleted with the program
    }

    [[nodiscard]] GLuint link(const ShaderText& source, const std::vector<ShaderText>& common) {
        glLinkProgram(id_);
        GLint ok = 0;
        glGetProgramiv(id_, GL_LINK_STATUS, &ok);
        if (ok) return std::exchange(id_, 0);
        const std::string log = with_files(log_of(id_, glGetProgramiv, glGetProgramInfoLog), files(source, common));
        throw Error(ErrorCode::MissingCapability, "the GL driver cannot link the shader: " + log, source.file);
    }

private:
    static std::vector<std::string> files(const ShaderText& source, const std::vector<ShaderText>& common) {
        std::vector<std::string> result{source.file};
        for (const ShaderText& piece : common) result.push_back(piece.file);
        return result;
    }

    GLuint id_;
};

}  // namespace

GlProgram::GlProgram(const std::string& file, const std::string& source, const std::string& defines,
                     const std::vector<ShaderText>& common) {
    OwnedProgram program;
    program.attach(GL_COMPUTE_SHADER, {file, source}, defines, common);
    id_ = program.link({file, source}, common);
}

GlProgram::GlProgram(const ShaderText& vertex, const ShaderText& fragment, const std::string& defines,
                     const std::vector<ShaderText>& common) {
    OwnedProgram program;
    program.attach(GL_VERTEX_SHADER, vertex, defines, common);
    program.attach(GL_FRAGMENT_SHADER, fragment, defines, common);
    id_ = program.link(fragment, common);
}

GlProgram::~GlProgram() {
    if (id_ != 0) glDeleteProgram(id_);
}

}  // namespace subvol::detail
