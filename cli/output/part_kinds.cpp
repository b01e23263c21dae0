// SPDX-License-Identifier: Apache-2.0
#include "part_kinds.h"

#include <algorithm>
#include <array>
#include <memory>

#include "subvol/detail/byte_lists.h"
#include "subvol/detail/points_range.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/surface_share.h"
#include "subvol/error.h"
#include "subvol/kernel_file.h"
#include "subvol/vdb_contents.h"
#include "vdb_functions.h"

namespace subvol::cli {

Facts write_kernels(const std::string& path, const RbfVolume& volume, const PointsWriteOptions& options, Progress* progress) {
    Facts facts;
    facts.timed(progress, "write", [&] {
        if (path.ends_with(".vdb")) {
            vdb().write_vdb_points(path, volume, {});
        } else if (path.ends_with(".svk")) {
            const KernelFileContents written = write_kernel_file(path, volume, progress);
            facts["levels"] = written.levels;
            facts["blocks"] = written.blocks;
            facts["bytes"] = written.bytes;
        } else {
            write_points(path, volume, options);
        }
    });
    return facts;
}

Facts files_of_kernels(const std::string& path, const RbfVolume& volume, const PointsWriteOptions& options) {
    Facts facts;
    facts["output"] = path;
    const bool inside = path.ends_with(".svk") || path.ends_with(".npz") || path.ends_with(".glb") ||
                        (path.ends_with(".ply") && !options.splats);
    if (!inside && !volume.boundary.triangles.empty()) facts["boundary"] = detail::boundary_path(path).string();
    return facts;
}

RbfVolume KernelParts::join(std::vector<RbfVolume> parts, std::span<const std::string>) {
    RbfVolume whole = std::move(parts.front());
    for (std::size_t p = 1; p < parts.size(); ++p) {
        detail::append_kernels(whole, parts[p]);
        parts[p] = {};
    }
    return whole;
}

std::string KernelParts::pack(const RbfVolume& part) {
    return detail::bytes_of_kernels(part, /*with_boundary=*/true);
}

RbfVolume KernelParts::unpack(const std::string& bytes) {
    return detail::kernels_from_bytes(bytes);
}

Facts KernelParts::store(const RbfVolume& part, const std::string& note) const {
    PointsWriteOptions noted = options;
    noted.note = note;
    Facts facts;
    facts["points"] = part.size();
    facts.merge(write_kernels(path, part, noted, progress));
    facts.merge(files_of_kernels(path, part, noted));
    return facts;
}

OpenedPart<RbfVolume> KernelParts::open(const std::string& file) {
    return {is_points_file(file) ? read_points_note(file) : std::nullopt, [file] { return read_points(file); }};
}

BrickPointsReport StoredKernelParts::join(const std::vector<std::filesystem::path>& parts, std::span<const std::string>) const {
    return join_points_of_bricks(path, parts, points, progress);
}

OpenedPart<std::filesystem::path> StoredKernelParts::open(const std::string& file) {
    return {KernelParts::open(file).note, [file] { return std::filesystem::path(file); }};
}

std::vector<VdbGrid> GridParts::join(std::vector<std::vector<VdbGrid>> parts, std::span<const std::string> names) {
    std::vector<VdbGrid> grids;
    const std::size_t count = parts.front().size();
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (parts[p].size() != count) throw Error(ErrorCode::InvalidInput, "has other grids than other parts", names[p]);
    }
    for (std::size_t g = 0; g < count; ++g) {
        std::vector<VdbGrid> slabs;
        for (std::vector<VdbGrid>& part : parts) slabs.push_back(std::move(part[g]));
        grids.push_back(vdb().join_grids(std::move(slabs)));
    }
    return grids;
}

std::string GridParts::pack(const std::vector<VdbGrid>& part) {
    return vdb().bytes_of_grids(part);
}

std::vector<VdbGrid> GridParts::unpack(const std::string& bytes) {
    return vdb().grids_from_bytes(bytes);
}

Facts GridParts::store(std::vector<VdbGrid> part, const std::string& note) const {
    for (VdbGrid& grid : part) vdb().set_text_of_grid(grid, kPartNote, note);
    return write_share(part, output, progress);
}

OpenedPart<std::vector<VdbGrid>> GridParts::open(const std::string& file) {
    auto grids = std::make_shared<std::vector<VdbGrid>>(vdb().read_vdb_contents(file).grids);
    if (grids->empty()) return {};
    std::optional<std::string> note = vdb().text_of_grid(grids->front(), kPartNote);
    for (VdbGrid& grid : *grids) vdb().set_text_of_grid(grid, kPartNote, {});
    return {std::move(note), [grids] { return std::move(*grids); }};
}

LimitSurface SurfaceParts::join(std::vector<std::string> parts, std::span<const std::string> names) const {
    return detail::join_surface(std::move(parts), names, progress);
}

Facts SurfaceParts::store(std::string part, const std::string& note) const {
    Facts facts;
    facts["output"] = path;
    facts["bytes"] = part.size();
    facts.timed(progress, "write", [&] { detail::write_surface_share(path, {note, std::move(part)}); });
    return facts;
}

OpenedPart<std::string> SurfaceParts::open(const std::string& file) {
    detail::SurfaceShareFile part = detail::read_surface_share(file);
    return {std::move(part.note), [bytes = std::move(part.bytes)] { return bytes; }};
}

detail::PicturePart rows_of(const Picture& picture, const PixelRows& rows) {
    const Image& image = picture.image;
    detail::PicturePart part{
        .rows = Image(image.width, rows.end - rows.first), .first_row = rows.first, .whole_height = image.height};
    const std::ptrdiff_t begin = std::ptrdiff_t{rows.first} * image.width, pixels = std::ssize(part.rows.rgba) / 4;
    std::copy_n(image.rgba.begin() + 4 * begin, 4 * pixels, part.rows.rgba.begin());
    if (!picture.depth.empty()) part.depth.assign(picture.depth.begin() + begin, picture.depth.begin() + begin + pixels);
    return part;
}

Picture PictureParts::join(std::vector<detail::PicturePart> parts, std::span<const std::string> names) {
    const detail::PicturePart& first = parts.front();
    Picture whole{Image(first.rows.width, first.whole_height)};
    if (!first.depth.empty()) whole.depth.resize(whole.image.rgba.size() / 4);
    int next = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const detail::PicturePart& part = parts[p];
        const bool fits = part.first_row == next && part.rows.height <= whole.image.height - next &&
                          part.rows.width == whole.image.width &&
                          (part.rows.height == 0 || part.depth.empty() == whole.depth.empty());
        if (!fits) throw Error(ErrorCode::InvalidInput, "its rows do not fit to those of the other parts", names[p]);
        const std::ptrdiff_t begin = std::ptrdiff_t{next} * whole.image.width;
        std::ranges::copy(part.rows.rgba, whole.image.rgba.begin() + 4 * begin);
        std::ranges::copy(part.depth, whole.depth.begin() + begin);
        next += part.rows.height;
    }
    if (next != whole.image.height) throw Error(ErrorCode::InvalidInput, "the parts do not fill the picture", "join");
    return whole;
}

std::string PictureParts::pack(const detail::PicturePart& part) {
    detail::BytePacker out;
    out.put(std::array{part.rows.width, part.rows.height, part.first_row, part.whole_height});
    out.put(part.rows.rgba);
    out.put(part.depth);
    return out.take();
}

detail::PicturePart PictureParts::unpack(const std::string& bytes) {
    detail::ByteUnpacker in(bytes, "these bytes are not rows of a picture");
    std::vector<int> sizes;
    in.take(sizes);
    if (sizes.size() != 4) in.refuse();
    detail::PicturePart part{.rows = Image(sizes[0], sizes[1]), .first_row = sizes[2], .whole_height = sizes[3]};
    in.take(part.rows.rgba);
    in.take(part.depth);
    return part;
}

/// A part without rows, as there may be more shares than rows of tiles, has one transparent row that does not count.
Facts PictureParts::store(detail::PicturePart part, const std::string& note) const {
    if (part.rows.height == 0) {
        part.rows = Image(part.rows.width, 1);
        part.first_row = std::min(part.first_row, part.whole_height - 1);
    }
    part.note = note;
    detail::write_picture_part(path, part);
    return {};
}

OpenedPart<detail::PicturePart> PictureParts::open(const std::string& file) {
    detail::PicturePart part = detail::read_picture_part(file);
    if (part.note.empty()) return {};
    const std::string text = std::move(part.note);
    const PartNote note = note_from(text, file);
    const int begin = how_of(note.how, "first_row", -1, file), end = how_of(note.how, "end_row", -1, file);
    if (begin >= 0 && begin == end) {  // a file of no rows has one that does not count
        part.rows = Image(part.rows.width, 0);
        part.first_row = begin;
        part.depth.clear();
    }
    if (begin != part.first_row || end - begin != part.rows.height) {
        throw Error(ErrorCode::InvalidInput, "its rows do not fit to those of the other parts", file);
    }
    return {text, [part] { return part; }};
}

}  // namespace subvol::cli
