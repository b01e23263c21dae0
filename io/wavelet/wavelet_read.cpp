// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "subvol/detail/child_topology.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/error.h"
#include "subvol/wavelet.h"
#include "wavelet_bytes.h"
#include "wavelet_format.h"

namespace subvol::detail {

namespace {

SchemeOptions read_scheme(Contents& in) {
    const std::uint64_t kind = in.number();
    if (kind > static_cast<std::uint64_t>(Scheme::Linear)) in.fail("there is no scheme " + std::to_string(kind), "0 to 3");
    SchemeOptions scheme{.kind = static_cast<Scheme>(kind), .tension = in.real()};
    if (!std::isfinite(scheme.tension)) in.fail("the tension is not a finite number");
    return scheme;
}

int read_levels(Contents& in) {
    const std::uint64_t levels = in.number();
    if (levels < 1 || levels > 10) in.fail("the number of levels is " + std::to_string(levels), "1 to 10");
    return static_cast<int>(levels);
}

/// Refuses levels with more points than there are bytes, or than the file may stand for, before memory is taken for them.
void check_size(const Topology& topology, int levels, std::size_t most_points, const Contents& in) {
    EntityCounts counts{topology.point_count, topology.edges.size(), topology.faces.size(), topology.cells.size()};
    for (int l = 0; l < levels; ++l) {
        check_child(counts);
        counts = child_counts(counts);
        if (counts.points - topology.point_count > in.left()) {
            in.fail(std::to_string(levels) + " levels of " + std::to_string(topology.cells.size()) +
                    " cells have more points than the file has details");
        }
        if (counts.points > most_points) {
            in.fail(std::to_string(counts.points) + " points are more than so few bytes stand for",
                    "at most " + std::to_string(most_points));
        }
    }
}

std::vector<double> read_array(const WaveletBasis& basis, std::size_t channels, Contents& in) {
    QuantizedWavelets numbers{.channels = channels, .step = in.real(), .coarse = {}, .details = {}};
    if (!(numbers.step > 0) || !std::isfinite(numbers.step)) in.fail("the step of an array is not a positive number");
    if (channels == 0 || channels > in.left() / basis.points()) {
        in.fail("an array of " + std::to_string(channels) + " channels does not fit into the file");
    }
    numbers.coarse.resize(basis.control_points * channels);
    for (const WaveletStep& step : basis.steps) numbers.details.emplace_back(step.new_points() * channels);
    constexpr std::uint64_t kMore = 255;
    for (std::size_t k = 0; k < channels; ++k) {
        std::uint64_t before = 0;  // without a sign, whose overflow is defined
        for (std::size_t i = k; i < numbers.coarse.size(); i += channels) {
            before += static_cast<std::uint64_t>(in.signed_number());
            numbers.coarse[i] = static_cast<std::int64_t>(before);
        }
        std::vector<std::int64_t*> long_ones;
        for (auto& details : numbers.details) {
            for (std::size_t i = k; i < details.size(); i += channels) {
                const std::uint64_t n = in.byte();
                details[i] = unfolded(n);
                if (n == kMore) long_ones.push_back(&details[i]);
            }
        }
        for (std::int64_t* n : long_ones) *n = unfolded(in.number() + kMore);
    }
    return synthesize(basis, restore(basis, numbers));
}

/// The points and fields of all levels; cells are still those of the finest level.
HexMesh read_arrays(const WaveletBasis& basis, Contents& in) {
    HexMesh mesh;
    const std::size_t arrays = in.count("arrays", basis.points());
    if (arrays == 0) in.fail("there are no points");
    for (std::size_t a = 0; a < arrays; ++a) {
        const std::string name = in.text();
        const std::size_t channels = in.number();
        if (a == 0 && channels != 3) in.fail("points have " + std::to_string(channels) + " coordinates", "3");
        if (channels > 1000) in.fail("an array has " + std::to_string(channels) + " channels", "at most 1000");
        std::vector<double> values = read_array(basis, channels, in);
        if (a > 0) {
            mesh.attributes.push_back({name, static_cast<int>(channels), std::move(values)});
            continue;
        }
        for (std::size_t i = 0; i < values.size(); i += 3) mesh.points.emplace_back(values[i], values[i + 1], values[i + 2]);
    }
    return mesh;
}

/// Fields at cells, if the file has some. cells: of the mesh
void read_fields_at_cells(std::size_t cells, HexMesh& mesh, Contents& in) {
    if (in.left() == 0) return;
    const std::size_t fields = in.count("fields at cells", 1);
    for (std::size_t f = 0; f < fields; ++f) {
        const std::uint64_t a = in.number();
        if (a >= mesh.attributes.size()) in.fail("field " + std::to_string(a) + " is at cells, but not at points");
        Attribute& field = mesh.attributes[a];
        field.constant = in.number() != 0;
        const double low = in.real(), step = in.real();
        if (!std::isfinite(low) || !(step > 0) || !std::isfinite(step))
            in.fail("the step of a field at cells is no positive number");
        const auto channels = static_cast<std::size_t>(field.channels);
        if (cells > in.left() / channels) in.fail("a field at cells ends too early");
        field.cells.assign(cells * channels, 0);
        for (std::size_t k = 0; k < channels; ++k) {
            std::uint64_t before = 0;  // without a sign, whose overflow is defined
            for (std::size_t c = 0; c < cells; ++c) {
                before += static_cast<std::uint64_t>(in.signed_number());
                const double value = low + step * static_cast<double>(static_cast<std::int64_t>(before));
                if (!std::isfinite(value)) in.fail("a value at a cell is not finite");
                field.cells[c * channels + k] = value;
            }
        }
    }
}

HexMesh read_contents(Contents& in, const std::string& file, std::size_t most_points) {
    const SchemeOptions scheme = read_scheme(in);
    const int levels = read_levels(in);
    try {
        const HexMesh control = read_cells(in, 3);
        validate(control);
        const Topology topology = build_topology(control);
        check_size(topology, levels, most_points, in);
        std::size_t fine_cells = topology.cells.size();
        for (int l = 0; l < levels; ++l) fine_cells *= 8;
        std::vector<std::uint8_t> there;
        if (in.number() != 0) {
            if (fine_cells / 8 > in.left()) in.fail("the list of cells ends too early");
            there.resize(fine_cells / 8);
            for (auto& bits : there) bits = static_cast<std::uint8_t>(in.byte());
        }
        WaveletBasis basis = wavelet_basis(topology, {.scheme = scheme, .levels = levels});
        HexMesh mesh = read_arrays(basis, in);
        if (there.empty()) {
            mesh.cells = std::move(basis.cells);
            mesh.creases = std::move(basis.creases);
            mesh.sharp_faces = std::move(basis.sharp_faces);
        } else {
            for (std::size_t c = 0; c < basis.cells.size(); ++c) {
                if (there[c / 8] >> c % 8 & 1) mesh.cells.push_back(basis.cells[c]);
            }
        }
        read_fields_at_cells(mesh.cells.size(), mesh, in);
        in.expect_end();
        return without_unused_points(std::move(mesh));
    } catch (const Error& error) {
        if (error.where() == file) throw;
        throw Error(error.code(), error.message(), file, error.allowed());
    }
}

}  // namespace

HexMesh mesh_of_wavelets(std::string_view contents, const std::string& file) {
    Contents in(contents, file);
    return read_contents(in, file, contents.size());
}

HexMesh read_wavelet_mesh(std::string_view text, const std::string& file) {
    const std::size_t head = kWaveletMagic.size() + 8;
    if (text.size() < head || !text.starts_with(kWaveletMagic)) {
        throw Error(ErrorCode::InvalidInput, "not a file of wavelets", file, "it begins with subvol-wavelets-1");
    }
    std::uint64_t length = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        length |= std::uint64_t{static_cast<unsigned char>(text[kWaveletMagic.size() + k])} << 8 * k;
    }
    // Longer contents are read while they are decompressed, so that bytes that do not describe a mesh end the reading early. A
    // mesh with so many details never packs this well.
    constexpr std::uint64_t kAtOnce = std::uint64_t{64} << 20, kMostPacked = 8192;  // LZMA packs zeros 6,800 : 1
    const std::string_view packed = text.substr(head);
    // A point takes some 500 bytes of memory while it is read, and in smooth meshes far less than one byte of the file.
    const std::size_t most_points = std::max(std::size_t{1} << 21, 128 * packed.size());
    if (length > 4 * kAtOnce && length / kMostPacked > packed.size()) {
        throw Error(ErrorCode::InvalidInput,
                    std::string(Contents::kDamaged) + ": " + std::to_string(packed.size()) + " bytes say that they are " +
                        std::to_string(length),
                    file, "at most 8192 times as many, or 256 MB");
    }
    if (length > kAtOnce) {
        LzmaReader more(packed);
        Contents in({}, file, &more, length);
        return read_contents(in, file, most_points);
    }
    const auto contents = decompressed(Compressor::Lzma, packed, length);
    if (!contents) throw Error(ErrorCode::InvalidInput, Contents::kDamaged, file);
    Contents in(*contents, file);
    return read_contents(in, file, most_points);
}

}  // namespace subvol::detail
