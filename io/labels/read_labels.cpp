// SPDX-License-Identifier: Apache-2.0
#include "subvol/read_labels.h"

#include <algorithm>
#include <cctype>

#include "label_readers.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"

namespace subvol {

namespace {

std::string extension_of_labels(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace

bool is_label_file(const std::filesystem::path& path) {
    const std::string extension = extension_of_labels(path);
    return extension == ".vti" || extension == ".nrrd";
}

LabelGrid read_labels(const std::filesystem::path& path, const std::optional<std::string>& array) {
    if (!is_label_file(path)) throw Error(ErrorCode::InvalidInput, "is not a file of labels", path.string(), ".vti or .nrrd");
    const bool image = extension_of_labels(path) == ".vti";
    if (array && !image) {
        throw Error(ErrorCode::InvalidInput, "has one array without a name; " + detail::in_quotes(*array) + " has no effect",
                    path.string());
    }
    const std::string text = detail::read_text(path);
    const std::string file = path.string();
    try {
        return image ? detail::read_vti_labels(text, file, array) : detail::read_nrrd_labels(text, file);
    } catch (const Error& error) {  // of voxels, which do not know their file
        if (error.where().starts_with(file)) throw;
        throw Error(error.code(), error.message(), file + ": " + error.where(), error.allowed());
    }
}

}  // namespace subvol
