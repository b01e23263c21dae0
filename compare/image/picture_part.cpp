// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/picture_part.h"

#include "openexr.h"
#include "subvol/detail/atomic_file.h"

namespace subvol::detail {

void write_picture_part(const std::filesystem::path& path, const PicturePart& part) {
    const Image& rows = part.rows;
    const std::size_t pixels = rows.rgba.size() / 4;
    const bool within = part.first_row >= 0 && rows.height > 0 && part.first_row + rows.height <= part.whole_height;
    if (!within || (!part.depth.empty() && part.depth.size() != pixels)) {
        throw Error(ErrorCode::InvalidInput, "the rows are not within the picture", path.string());
    }
    AtomicFile file(path);
    const PictureValues picture{.width = rows.width,
                                .height = rows.height,
                                .rgba = rows.rgba.data(),
                                .depth = part.depth.empty() ? nullptr : part.depth.data(),
                                .first_row = part.first_row,
                                .whole_height = part.whole_height,
                                .note = part.note.c_str()};
    if (const auto fault = openexr().write(file.path().string(), picture)) {
        throw Error(fault->code, fault->why, path.string());
    }
    file.commit();
}

PicturePart read_picture_part(const std::filesystem::path& path) {
    DecodedPicture picture = read_picture(path, /*wants_depth=*/true);
    PicturePart part{.rows = {},
                     .depth = std::move(picture.depth),
                     .first_row = picture.first_row,
                     .whole_height = picture.whole_height,
                     .note = std::move(picture.note)};
    if (part.note.empty() || picture.channels != 4 || picture.integers) return {};
    part.rows = Image(picture.width, picture.height);
    part.rows.rgba = std::move(picture.values);
    return part;
}

}  // namespace subvol::detail
