// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/picture_part.h"

#include <cstdint>

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
    const PictureValues picture{.data = {0, part.first_row, rows.width, rows.height},
                                .display = {0, 0, rows.width, part.whole_height},
                                .rgba = rows.rgba.data(),
                                .depth = part.depth.empty() ? nullptr : part.depth.data(),
                                .note = part.note.c_str()};
    if (const auto fault = openexr().write(file.path().string(), picture)) {
        throw Error(fault->code, fault->why, path.string());
    }
    file.commit();
}

PicturePart read_picture_part(const std::filesystem::path& path) {
    DecodedPicture picture = read_picture(path, /*wants_depth=*/true);
    const PixelWindow &data = picture.data, &display = picture.display;
    const std::int64_t first_row = std::int64_t{data.top} - display.top;
    const bool whole_rows =
        data.left == display.left && data.width == display.width && first_row >= 0 && first_row + data.height <= display.height;
    if (picture.note.empty() || picture.channels != 4 || picture.integers || !whole_rows) return {};
    PicturePart part{.rows = Image(data.width, data.height),
                     .depth = std::move(picture.depth),
                     .first_row = static_cast<int>(first_row),
                     .whole_height = display.height,
                     .note = std::move(picture.note)};
    part.rows.rgba = std::move(picture.values);
    return part;
}

}  // namespace subvol::detail
