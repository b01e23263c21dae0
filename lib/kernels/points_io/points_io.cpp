// SPDX-License-Identifier: Apache-2.0
#include "subvol/points_io.h"

#include <cmath>
#include <fstream>

#include "points_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using namespace detail;

namespace {

constexpr const char* kRead = ".ply, .vtp or .svk";

std::string format_of(const std::filesystem::path& path) {
    return upper_case(path.extension().string());
}

/// numbers: null, or gets those of the points; only .ply has them
RbfVolume read(const std::filesystem::path& path, std::vector<double>* numbers) {
    const auto read_whole = [&] {
        if (format_of(path) == ".SVK") return read_svk(path);
        const std::string text = read_text(path);
        return format_of(path) == ".PLY" ? read_ply(text, path, numbers) : read_vtp(text, path);
    };
    try {
        RbfVolume volume = read_whole();
        for (RbfChannel& channel : volume.channels) channel.name = printable(channel.name);
        validate(volume);
        volume.bounds = box_of(volume);
        return volume;
    } catch (const Error& error) {
        const std::string_view said(error.what());
        if (said.starts_with(path.string()) || said.starts_with(boundary_path(path).string())) throw;
        throw Error(error.code(), error.what(), path.string());
    }
}

}  // namespace

bool is_points_file(const std::filesystem::path& path) {
    return format_of(path) == ".PLY" || format_of(path) == ".VTP" || format_of(path) == ".SVK";
}

void write_points(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options) {
    if (format_of(path) != ".PLY" && format_of(path) != ".VTP" && format_of(path) != ".NPZ" && format_of(path) != ".GLB") {
        throw Error(ErrorCode::InvalidInput, "points cannot be written in this format", path.string(),
                    format_of(path) == ".SVK" ? "write_kernel_file writes .svk" : ".ply, .vtp, .npz or .glb");
    }
    validate(volume);
    if (format_of(path) == ".PLY") {
        write_ply(path, volume, options);
    } else if (format_of(path) == ".NPZ") {
        write_npz(path, volume);
    } else if (format_of(path) == ".GLB") {
        write_glb(path, volume, options);
    } else {
        write_vtp(path, volume, options.note);
    }
}

RbfVolume read_points(const std::filesystem::path& path) {
    if (!is_points_file(path))
        throw Error(ErrorCode::InvalidInput, "points cannot be read from this format", path.string(), kRead);
    return read(path, nullptr);
}

NumberedPoints detail::read_numbered_points(const std::filesystem::path& path) {
    constexpr double kMost = 9007199254740992;  // 2^53: from there on doubles are not all whole numbers
    std::vector<double> numbers;
    NumberedPoints result{read(path, &numbers), {}};
    if (numbers.size() != result.volume.size())
        throw Error(ErrorCode::InvalidInput, "its points have no numbers", path.string());
    for (const double number : numbers) {
        if (!(number >= 0 && number < kMost && number == std::floor(number))) {
            throw Error(ErrorCode::InvalidInput, "a point has the number " + number_text(number), path.string(),
                        "a whole number below 2^53");
        }
        result.numbers.push_back(static_cast<std::uint64_t>(number));
    }
    return result;
}

std::optional<std::string> read_points_note(const std::filesystem::path& path) {
    constexpr std::size_t kStart = 1 << 16;  // bytes; notes come first
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(ErrorCode::Io, "cannot be read", path.string());
    std::string start(kStart, '\0');
    file.read(start.data(), kStart);
    start.resize(static_cast<std::size_t>(file.gcount()));
    const std::string_view mark = kNoteMark;
    const std::size_t at = start.find(mark);
    if (at == std::string::npos) return std::nullopt;
    const std::size_t end = start.find('\n', at);
    if (end == std::string::npos) return std::nullopt;
    std::string note = start.substr(at + mark.size(), end - at - mark.size());
    if (note.ends_with(kNoteEnd)) note.resize(note.size() - std::string_view(kNoteEnd).size());
    return note;
}

std::vector<Option> options_of(PointsWriteOptions& options) {
    return {
        Option("ascii", options.ascii).help(".ply: write text instead of binary numbers"),
        Option("splats", options.splats)
            .help(".ply: also for viewers of Gaussian splats; the boundary is then in a file beside it; .glb has splats alone"),
        Option("up", options.up)
            .help("AXIS", "with --splats: the axis that these viewers show at the top: x, y or z")
            .only_with("splats")};
}

}  // namespace subvol
