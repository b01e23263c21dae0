// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/image.h"

namespace subvol::detail {

/// Some rows of a picture, as one of several processes has drawn them.
struct PicturePart {
    Image rows;                  ///< all columns of the rows from `first_row` on, of a picture of the height `whole_height`
    std::vector<float> depth{};  ///< one per pixel, see `write_image`; empty: none
    int first_row = 0, whole_height = 0;
    std::string note{};  ///< a text that is stored beside the pixels
};

/// Writes an `.exr` whose data window is that of the rows and whose display window is that of the whole picture. The file
/// appears whole or not at all.
///
/// throws: Error(InvalidInput) if the rows are not within the picture, Error(Io)
void write_picture_part(const std::filesystem::path& path, const PicturePart& part);

/// Reads what `write_picture_part` writes, exactly; an empty note if it is another picture.
///
/// throws: as `read_image`
[[nodiscard]] PicturePart read_picture_part(const std::filesystem::path& path);

}  // namespace subvol::detail
