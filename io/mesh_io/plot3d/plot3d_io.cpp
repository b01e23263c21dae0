// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <tuple>

#include "assemble.h"
#include "formats.h"
#include "mesh_file.h"
#include "subvol/detail/number_type.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

// The encoding of numbers. Sizes are in bytes, in a text file in words.
//
// mark: size of the length that Fortran writes before and after each record; 0 if there is none
struct Encoding {
    bool text = false;
    std::endian order = std::endian::little;
    std::size_t integer = 4, real = 4, mark = 0;
};

// The layout of a file. The file does not state it: it is the first layout that gives the size of the file.
struct Plot3dLayout {
    Encoding encoding;
    bool several = false;  // the file begins with the number of blocks
    bool blanks = false;   // one integer for each point, 0 where there is no flow
    std::vector<StructuredGrid> blocks;
};

bool is_text(std::string_view bytes) {
    constexpr std::string_view kOfNumbers = "0123456789+-.,eEdDnNaAiIfF \t\r\n";
    return bytes.substr(0, 256).find_first_not_of(kOfNumbers) == std::string_view::npos;
}

std::vector<Encoding> encodings(bool text) {
    if (text) return {{.text = true, .integer = 1, .real = 1}};
    std::vector<Encoding> all;
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        for (const std::size_t real : {4u, 8u}) {
            for (const std::size_t mark : {4u, 0u}) all.push_back({.order = order, .real = real, .mark = mark});
        }
    }
    return all;
}

class Numbers {
public:
    Numbers(const TextScanner& in, const Encoding& encoding) : in_(in), encoding_(encoding) {}

    void mark() { in_.bytes(encoding_.mark, {"mark of a record"}); }
    std::int64_t integer(const Place& place) {
        if (encoding_.text) return in_.integer(place);
        return integer_from(in_.bytes(encoding_.integer, place), NumberType::Int32, encoding_.order);
    }
    double real(const Place& place) {
        if (encoding_.text) return in_.real(place);
        const NumberType type = encoding_.real == 4 ? NumberType::Float32 : NumberType::Float64;
        return real_from(in_.bytes(encoding_.real, place), type, encoding_.order);
    }
    [[nodiscard]] std::size_t position() const { return in_.position(); }
    [[nodiscard]] std::size_t bytes_left() const { return in_.bytes_left(); }

private:
    TextScanner in_;
    Encoding encoding_;
};

// Reads the sizes of the blocks; nothing if these numbers cannot be sizes.
std::optional<std::vector<StructuredGrid>> read_sizes(Numbers& in, bool several) {
    std::int64_t count = 1;
    if (several) {
        in.mark();
        count = in.integer({"blocks"});
        in.mark();
    }
    if (count < 1 || static_cast<std::uint64_t>(count) > in.bytes_left()) return std::nullopt;
    const std::size_t most = std::min<std::size_t>(in.bytes_left(), kNone - 1);  // a point takes more than a byte
    std::size_t points_in_all = 0;
    std::vector<StructuredGrid> blocks;
    in.mark();
    for (std::int64_t b = 0; b < count; ++b) {
        StructuredGrid& grid = blocks.emplace_back();
        for (std::size_t& along : grid.points) {
            const std::int64_t points = in.integer({"size of a block"});
            if (points < 1) return std::nullopt;
            along = static_cast<std::size_t>(points);
        }
        points_in_all += grid.point_count();
        if (points_in_all > most) return std::nullopt;
    }
    in.mark();
    return blocks;
}

// The size of a file with this layout: the header, then for each block a record with so many reals and integers per point,
// after a record of `extra` reals if there are any.
std::size_t size_of_file(const Plot3dLayout& layout, std::size_t reals, std::size_t integers, std::size_t extra) {
    const Encoding& encoding = layout.encoding;
    const auto record = [&](std::size_t size) { return size + 2 * encoding.mark; };
    std::size_t size = record(3 * layout.blocks.size() * encoding.integer);
    if (layout.several) size += record(encoding.integer);
    for (const StructuredGrid& grid : layout.blocks) {
        size += record(grid.point_count() * (reals * encoding.real + integers * encoding.integer));
        if (extra > 0) size += record(extra * encoding.real);
    }
    return size;
}

// The kinds of files: coordinates (3 reals per point, perhaps an integer) and flow (5 reals per point, 4 before each block).
struct Kind {
    std::size_t reals, extra;
};
constexpr Kind kPlaces{3, 0};
constexpr Kind kFlow{5, 4};

std::optional<Plot3dLayout> layout_of(const TextScanner& in, const Kind& kind) {
    TextScanner words = in;
    const bool text = is_text(in.rest());
    std::size_t size = in.bytes_left();
    if (text) {
        for (size = 0; !words.at_end(); ++size) words.word();
    }
    for (const Encoding& encoding : encodings(text)) {
        for (const bool several : {false, true}) {
            for (const bool blanks : {false, true}) {
                Plot3dLayout layout{encoding, several, blanks, {}};
                try {
                    Numbers numbers(in, encoding);
                    auto blocks = read_sizes(numbers, several);
                    if (!blocks) continue;
                    layout.blocks = std::move(*blocks);
                } catch (const Error&) {  // the file is shorter than such a header
                    continue;
                }
                if (size_of_file(layout, kind.reals, blanks ? 1 : 0, kind.extra) == size) return layout;
            }
        }
    }
    return std::nullopt;
}

// Reads all x of a block, then all y, then all z, then its blanks.
void read_block(Numbers& in, const Plot3dLayout& layout, const StructuredGrid& grid, MeshFile& found, FileArray& ghosts) {
    const std::size_t first = found.points.size(), count = grid.point_count();
    std::vector<Vec3> points(count);
    in.mark();
    for (int a = 0; a < 3; ++a) {
        for (std::size_t p = 0; p < count; ++p) points[p][a] = in.real({"coordinate"});
    }
    for (const Vec3& point : points) add_point(found, point, in.position());
    for (std::size_t p = 0; layout.blanks && p < count; ++p) {
        ghosts.values.push_back(in.integer({"blank"}) == 0 ? kHiddenPoint : 0);
    }
    in.mark();
    add_hexes(found, grid, first, found.hexes.corners.size());
}

// For each block the file has the densities of all points, then each of the three components of momentum, then the energies.
void read_flow(std::string_view text, std::string_view file, const Plot3dLayout& places, MeshFile& found) {
    const TextScanner in(text, file, TextScanner::Comments::None);
    const auto layout = layout_of(in, kFlow);
    const auto same = [](const StructuredGrid& a, const StructuredGrid& b) { return a.points == b.points; };
    if (!layout || !std::ranges::equal(layout->blocks, places.blocks, same)) {
        return found.ignore(
            {"file", std::filesystem::path(file).filename().string(), 1, "the flow in it does not have these blocks"});
    }
    Numbers numbers(in, layout->encoding);
    std::ignore = read_sizes(numbers, layout->several);
    std::vector<FileArray> arrays{{"Density", 1, false, {}}, {"Momentum", 3, false, {}}, {"StagnationEnergy", 1, false, {}}};
    std::size_t first = 0;
    for (FileArray& array : arrays) array.values.resize(found.points.size() * static_cast<std::size_t>(array.components));
    for (const StructuredGrid& grid : layout->blocks) {
        numbers.mark();
        for (std::size_t k = 0; k < kFlow.extra; ++k) numbers.real({"state of the flow"});
        numbers.mark();
        numbers.mark();
        for (FileArray& array : arrays) {
            const auto components = static_cast<std::size_t>(array.components);
            for (std::size_t c = 0; c < components; ++c) {
                for (std::size_t p = 0; p < grid.point_count(); ++p) {
                    array.values[(first + p) * components + c] = numbers.real({"value of the flow"});
                }
            }
        }
        numbers.mark();
        first += grid.point_count();
    }
    for (FileArray& array : arrays) found.arrays.push_back(std::move(array));
}

}  // namespace

ReadResult read_plot3d(std::string_view text, std::string_view file, const ReadOptions& options, const Plot3dFlow& flow) {
    constexpr EntityNames kNames{"point", "cell", 0};
    TextScanner in(text, file, TextScanner::Comments::None);
    if (text.empty()) in.fail("the file is empty");
    const auto layout = layout_of(in, kPlaces);
    if (!layout) {
        throw Error(ErrorCode::InvalidInput,
                    "not a Plot3D grid: the size of the file does not match the sizes of the blocks at its beginning",
                    std::string(file), "whole grids in three dimensions, as text, records or plain bytes");
    }
    if (!layout->encoding.text) in.name_bytes();
    Numbers numbers(in, layout->encoding);
    std::ignore = read_sizes(numbers, layout->several);
    MeshFile found;
    FileArray ghosts{std::string(kGhostArray), 1, false, {}};
    for (const StructuredGrid& grid : layout->blocks) read_block(numbers, *layout, grid, found, ghosts);
    if (!flow.text.empty()) read_flow(flow.text, flow.file, *layout, found);
    if (layout->blanks) found.arrays.push_back(std::move(ghosts));
    add_left_out_warning(found, {}, file);
    return assemble(std::move(found), in, file, kNames, options);
}

}  // namespace subvol::detail
