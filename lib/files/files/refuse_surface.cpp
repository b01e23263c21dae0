// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/refuse_surface.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "subvol/error.h"

namespace subvol::detail {
namespace {

template <std::size_t N>
bool ends_in(const std::filesystem::path& path, const std::array<std::string_view, N>& extensions) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::ranges::find(extensions, extension) != extensions.end();
}

}  // namespace

std::string shell_word(const std::string& word) {
    constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-_.,:/=%@";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string command_for_surface(const std::filesystem::path& path, const std::string& options) {
    return "subvol mesh " + shell_word(path.string()) + (options.empty() ? "" : " " + options) + " -o " +
           shell_word(path.stem().string() + ".vtu");
}

bool names_surface(const std::filesystem::path& path) {
    constexpr std::array<std::string_view, 4> kRead{".stl", ".obj", ".ply", ".glb"};
    return ends_in(path, kRead);
}

bool names_foreign_surface(const std::filesystem::path& path) {
    constexpr std::array<std::string_view, 15> kForeign{".gltf", ".off",   ".3mf", ".amf",  ".3ds", ".dae",  ".fbx", ".wrl",
                                                        ".x3d",  ".blend", ".stp", ".step", ".igs", ".iges", ".brep"};
    return ends_in(path, kForeign);
}

std::string way_to_cells(const std::filesystem::path& path) {
    if (names_surface(path)) return "`" + command_for_surface(path) + "` makes a control mesh of it";
    const std::filesystem::path exported = path.stem().string() + ".stl";
    return "exported as " + exported.string() + ", `" + command_for_surface(exported) + "` makes a control mesh of it";
}

void refuse_surface(const std::filesystem::path& path) {
    throw Error(ErrorCode::InvalidInput, "is a surface, not a mesh of cells", path.string(), way_to_cells(path));
}

}  // namespace subvol::detail
