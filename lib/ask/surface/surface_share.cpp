// SPDX-License-Identifier: Apache-2.0
#include "settled_cut.h"

#include <algorithm>
#include <cstring>
#include <fstream>

#include "subvol/detail/byte_hash.h"
#include "subvol/detail/byte_lists.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"
#include "surface_shape.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kMagic = "subvol surface share 2\n";
constexpr std::uint64_t kMostCuts = 1 << 20;

/// How a share was made: what must be the same in all of them.
std::array<std::uint64_t, 3> head_of(const SurfaceShare& share) {
    return {sizeof(Index), share.improve ? 1U : 0U, share.cuts.size()};
}

void put_fields(std::span<const ProbedField> fields, BytePacker& out) {
    out.put(std::array{std::uint64_t{fields.size()}});
    for (const ProbedField& field : fields) {
        out.put(field.name);
        out.put(std::array{std::uint64_t{field.channels}});
        out.put(field.values);
        out.put(field.gradients);
    }
}

/// points: that each field has values at
std::vector<ProbedField> take_fields_of(std::size_t points, ByteUnpacker& in) {
    std::vector<std::uint64_t> count;
    in.take(count);
    if (count.size() != 1 || count[0] > kMostCuts) in.refuse();
    std::vector<ProbedField> fields;
    for (std::uint64_t f = 0; f < count[0]; ++f) {
        ProbedField& field = fields.emplace_back();
        std::vector<std::uint64_t> channels;
        in.take(field.name);
        in.take(channels);
        in.take(field.values);
        in.take(field.gradients);
        if (channels.size() != 1 || channels[0] == 0 || field.values.size() / channels[0] != points ||
            field.values.size() % channels[0] != 0 || field.gradients.size() != field.values.size()) {
            in.refuse();
        }
        field.channels = channels[0];
    }
    return fields;
}

void put_cut(const SettledCut& cut, BytePacker& out) {
    out.put(std::array{static_cast<std::uint64_t>(cut.level), std::uint64_t{cut.converged ? 1U : 0U}});
    out.put(std::array{cut.deviation_world});
    const std::size_t count = cut.soup.points.size();
    std::vector<std::array<VertexNumber, 2>> ends(count);
    std::vector<std::array<Index, 2>> cells(count);  // that names the point, and that its place is in
    std::vector<std::uint8_t> sides(count);
    std::vector<Vec3> parameters(count);
    for (std::size_t p = 0; p < count; ++p) {
        const SurfacePoint& point = cut.soup.points[p];
        ends[p] = {point.a, point.b};
        cells[p] = {point.cell, cut.settled.places[p].cell};
        sides[p] = point.side;
        parameters[p] = cut.settled.places[p].uvw;
    }
    out.put(ends);
    out.put(cells);
    out.put(sides);
    out.put(parameters);
    out.put(cut.settled.positions);
    out.put(cut.settled.normals);
    put_fields(cut.settled.fields, out);
    out.put(cut.soup.cells);
    out.put(cut.soup.ends);
    out.put(cut.soup.triangles);
    out.put(cut.soup.hull);
}

SettledCut take_cut(ByteUnpacker& in) {
    std::vector<std::uint64_t> head;
    std::vector<double> deviation;
    std::vector<std::array<VertexNumber, 2>> ends;
    std::vector<std::array<Index, 2>> cells;
    std::vector<std::uint8_t> sides;
    std::vector<Vec3> parameters;
    SettledCut cut;
    in.take(head);
    in.take(deviation);
    in.take(ends);
    in.take(cells);
    in.take(sides);
    in.take(parameters);
    in.take(cut.settled.positions);
    in.take(cut.settled.normals);
    cut.settled.fields = take_fields_of(ends.size(), in);
    in.take(cut.soup.cells);
    in.take(cut.soup.ends);
    in.take(cut.soup.triangles);
    in.take(cut.soup.hull);
    const std::size_t count = ends.size();
    const SurfaceSoup& soup = cut.soup;
    const bool fits = head.size() == 2 && head[0] <= 8 && deviation.size() == 1 && cells.size() == count &&
                      sides.size() == count && parameters.size() == count && cut.settled.positions.size() == count &&
                      cut.settled.normals.size() == count && soup.cells.size() == soup.ends.size() &&
                      soup.triangles.size() == soup.hull.size() && std::ranges::is_sorted(soup.ends) &&
                      (soup.ends.empty() ? 0 : soup.ends.back()) == soup.triangles.size() &&
                      std::ranges::all_of(soup.triangles, [&](const auto& t) { return std::ranges::max(t) < count; });
    if (!fits) in.refuse();
    cut.level = static_cast<int>(head[0]);
    cut.converged = head[1] != 0;
    cut.deviation_world = deviation[0];
    for (std::size_t p = 0; p < count; ++p) {
        cut.soup.points.push_back({ends[p][0], ends[p][1], cells[p][0], {}, {}, sides[p]});
        cut.settled.places.push_back({cells[p][1], parameters[p]});
    }
    return cut;
}

std::uint64_t hash_of(std::string_view note, std::string_view bytes) {
    ByteHash hash;
    hash.add_text(note);
    hash.add(bytes);
    return hash.value();
}

/// Throws Error(InvalidInput) unless the bytes are a share whose numbers fit together.
SurfaceShare share_from(std::string_view bytes) {
    ByteUnpacker in(bytes, "these bytes are not a share of a surface");
    std::vector<std::uint64_t> head;
    std::vector<double> slack;
    in.take(head);
    in.take(slack);
    if (head.size() != 3 || head[0] != sizeof(Index) || slack.size() != 1 || head[2] > kMostCuts) in.refuse();
    SurfaceShare share{.improve = head[1] != 0, .slack_world = slack[0]};
    for (std::uint64_t c = 0; c < head[2]; ++c) share.cuts.push_back(take_cut(in));
    if (in.left() > 0) in.refuse();
    return share;
}

/// Whether two shares can be of the same surface.
bool fit_together(const SurfaceShare& a, const SurfaceShare& b) {
    bool fit = head_of(a) == head_of(b) && a.slack_world == b.slack_world;
    for (std::size_t c = 0; fit && c < a.cuts.size(); ++c) {
        const auto same = [](const ProbedField& x, const ProbedField& y) {
            return x.name == y.name && x.channels == y.channels;
        };
        fit = a.cuts[c].level == b.cuts[c].level && a.cuts[c].deviation_world == b.cuts[c].deviation_world &&
              std::ranges::equal(a.cuts[c].settled.fields, b.cuts[c].settled.fields, same);
    }
    return fit;
}

}  // namespace

std::string bytes_of(const SurfaceShare& share) {
    BytePacker out;
    out.put(head_of(share));
    out.put(std::array{share.slack_world});
    for (const SettledCut& cut : share.cuts) put_cut(cut, out);
    return out.take();
}

std::string empty_surface_share() {
    return bytes_of(SurfaceShare{});
}

LimitSurface join_surface(std::vector<std::string> shares, std::span<const std::string> names, Progress* progress) {
    std::vector<SurfaceShare> read;
    for (std::size_t s = 0; s < shares.size(); ++s) {
        report_progress(progress, "read", s, shares.size());
        try {
            read.push_back(share_from(shares[s]));
        } catch (const Error& error) {
            throw Error(error.code(), error.message(), names[s]);
        }
        shares[s] = {};
        if (fit_together(read[0], read[s])) continue;
        throw Error(ErrorCode::InvalidInput, "is a share of another surface than " + names[0], names[s]);
    }
    LimitSurface all;
    all.report.converged = true;
    for (std::size_t c = 0; c < read[0].cuts.size(); ++c) {
        std::vector<SettledCut> parts;
        for (SurfaceShare& share : read) parts.push_back(std::move(share.cuts[c]));
        const SettledCut cut = joined(std::move(parts));
        report_progress(progress, "improve", c, read[0].cuts.size());
        add_cut(cut, read[0].improve, read[0].slack_world, all);
    }
    measure_surface(all.surface, all.report);
    return all;
}

void write_surface_share(const std::filesystem::path& path, const SurfaceShareFile& share) {
    OutputFile out(path);
    out.write(kMagic);
    for (const std::string* text : {&share.note, &share.bytes}) {
        const std::array<std::uint64_t, 1> length{text->size()};
        out.write_values(std::span<const std::uint64_t>(length));
        out.write(*text);
    }
    const std::array<std::uint64_t, 1> hash{hash_of(share.note, share.bytes)};
    out.write_values(std::span<const std::uint64_t>(hash));
    out.commit();
}

SurfaceShareFile read_surface_share(const std::filesystem::path& path) {
    const auto refuse = [&](const char* what) { throw Error(ErrorCode::InvalidInput, what, path.string()); };
    std::error_code none;
    const auto size = std::filesystem::file_size(path, none);
    std::ifstream in(path, std::ios::binary);
    if (none || !in) throw Error(ErrorCode::Io, "cannot be read", path.string());
    std::uint64_t left = size;
    const auto take = [&](std::uint64_t count) {
        if (count > left) refuse("is cut off: shares are longer than this");
        std::string bytes(count, '\0');
        in.read(bytes.data(), static_cast<std::streamsize>(count));
        if (!in) throw Error(ErrorCode::Io, "cannot be read to its end", path.string());
        left -= count;
        return bytes;
    };
    const auto number = [&] {
        std::uint64_t value = 0;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    };
    if (size < kMagic.size() || take(kMagic.size()) != kMagic) refuse("is not a share of a surface");
    SurfaceShareFile share;
    share.note = take(number());
    share.bytes = take(number());
    if (number() != hash_of(share.note, share.bytes) || left > 0)
        refuse("is damaged: its bytes are not those that were written");
    return share;
}

}  // namespace subvol::detail
