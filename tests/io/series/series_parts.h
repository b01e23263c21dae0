// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "series_format.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/vtu_bytes.h"
#include "wavelet_bytes.h"

namespace subvol::test {

/// A step before compression. head: all before the sizes of blocks; block: the only one, empty if there is none
struct SeriesStepParts {
    std::string head, block;
};

/// A file of steps in parts, before compression: to damage what is in it and pack it again with the right hashes, so that the
/// damage is not found by these. Steps have one block each, as those of small meshes have.
///
/// index:      what `packed` writes, but for the places of parts, which it finds itself
/// index_text: contents of the index instead
struct SeriesParts {
    detail::SeriesIndex index;
    std::optional<std::string> index_text{};
    std::vector<std::string> meshes;
    std::vector<SeriesStepParts> steps;

    static SeriesParts of(const std::string& file, std::size_t points) {
        const auto number = [&](std::size_t k) {
            std::uint64_t n = 0;
            for (std::size_t b = 0; b < 8; ++b) {
                n |= std::uint64_t{static_cast<unsigned char>(file[detail::kSeriesMagic.size() + 8 * k + b])} << 8 * b;
            }
            return n;
        };
        SeriesParts parts;
        const std::string text = plain(std::string_view(file).substr(number(0), number(1)), number(2));
        parts.index = index_of(text);
        for (const detail::SeriesMesh& mesh : parts.index.meshes)
            parts.meshes.push_back(plain(std::string_view(file).substr(mesh.place.place, mesh.place.length), mesh.unpacked));
        for (const detail::SeriesStep& step : parts.index.steps)
            parts.steps.push_back(step_of(file.substr(step.place.place, step.place.length), parts.index, points));
        return parts;
    }

    /// The file. The index says where its parts are, unless it is given as text.
    [[nodiscard]] std::string packed() const { return pack(true).file; }
    /// The same as a file of the first version, which has no hashes.
    [[nodiscard]] std::string packed_as_first() const { return pack(false).file; }
    /// What the index of that file is.
    [[nodiscard]] std::string index_of_packed() const { return pack(true).index; }

    /// The contents of an index, and what they say.
    static std::string text_of(const detail::SeriesIndex& index) {
        detail::Bytes out;
        out.number(index.meshes.size());
        for (const detail::SeriesMesh& mesh : index.meshes) {
            put_place(mesh.place, out);
            out.number(mesh.unpacked);
        }
        out.number(index.arrays.size());
        for (const detail::SeriesArray& array : index.arrays) {
            out.text(array.name);
            out.number(array.channels.size());
            for (const detail::Quantization& q : array.channels) {
                for (const double x : {q.origin, q.step, q.min, q.max}) out.real(x);
            }
        }
        out.number(index.steps.size());
        for (const detail::SeriesStep& step : index.steps) {
            out.real(step.time);
            out.number(step.mesh);
            out.number(step.key ? 1 : 0);
            put_place(step.place, out);
        }
        return out.all();
    }

    static detail::SeriesIndex index_of(const std::string& text) {
        const std::string file = "index";
        detail::Contents in(text, file);
        detail::SeriesIndex index;
        index.meshes.resize(in.number());
        for (detail::SeriesMesh& mesh : index.meshes) {
            mesh.place = place_of(in);
            mesh.unpacked = in.number();
        }
        index.arrays.resize(in.number());
        for (detail::SeriesArray& array : index.arrays) {
            array.name = in.text();
            array.channels.resize(in.number());
            for (detail::Quantization& q : array.channels) {
                for (double* x : {&q.origin, &q.step, &q.min, &q.max}) *x = in.real();
            }
        }
        index.steps.resize(in.number());
        for (detail::SeriesStep& step : index.steps) {
            step.time = in.real();
            step.mesh = in.number();
            step.key = in.number() != 0;
            step.place = place_of(in);
        }
        return index;
    }

private:
    struct Packed {
        std::string file, index;
    };

    [[nodiscard]] Packed pack(bool with_hashes) const {
        std::string file(with_hashes ? detail::kSeriesHead : detail::kFirstSeriesHead, '\0');
        const std::size_t head_size = file.size();
        const auto put = [&](const std::string& bytes) {
            detail::SeriesPlace place{file.size(), bytes.size()};
            if (with_hashes) place.hash = detail::hash_of(bytes);
            file += bytes;
            return place;
        };
        detail::SeriesIndex at = index;
        for (std::size_t k = 0; k < meshes.size(); ++k)
            at.meshes[k] = {put(detail::compressed_numbers(meshes[k])), meshes[k].size()};
        for (std::size_t k = 0; k < steps.size(); ++k) {
            const std::string block = steps[k].block.empty() ? "" : detail::compressed_numbers(steps[k].block);
            detail::Bytes sizes;
            if (!block.empty()) sizes.number(block.size());
            at.steps[k].place = put(steps[k].head + sizes.all() + block);
        }
        const std::string text = index_text ? *index_text : text_of(at), bytes = detail::compressed_numbers(text);
        std::string head(with_hashes ? detail::kSeriesMagic : detail::kFirstSeriesMagic);
        const auto put_number = [&](std::uint64_t n) {
            for (int b = 0; b < 8; ++b) head += static_cast<char>(n >> 8 * b & 255);
        };
        for (const std::uint64_t n : {std::uint64_t{file.size()}, std::uint64_t{bytes.size()}, std::uint64_t{text.size()}})
            put_number(n);
        if (with_hashes) put_number(detail::hash_of(head + bytes));
        return {head + file.substr(head_size) + bytes, text};
    }

    static std::string plain(std::string_view bytes, std::uint64_t length) {
        auto text = detail::decompressed(detail::Compressor::Lzma, bytes, length);
        if (!text) throw std::runtime_error("the file is not one of steps");
        return *text;
    }

    static detail::SeriesPlace place_of(detail::Contents& in) {
        detail::SeriesPlace place;
        place.place = in.number();
        place.length = in.number();
        place.hash = in.number();
        return place;
    }
    static void put_place(const detail::SeriesPlace& place, detail::Bytes& out) {
        out.number(place.place);
        out.number(place.length);
        if (place.hash) out.number(*place.hash);
    }

    static SeriesStepParts step_of(const std::string& text, const detail::SeriesIndex& index, std::size_t points) {
        const std::string file = "step";
        detail::Contents in(text, file);
        std::vector<const detail::SeriesArray*> there;
        for (const detail::SeriesArray& array : index.arrays) {
            if (in.byte() != 0) there.push_back(&array);
        }
        std::size_t length = 0;
        for (const detail::SeriesArray* array : there) {
            for (std::size_t c = 0; c < array->channels.size(); ++c) {
                in.byte();
                length += points * in.byte();
                for (std::uint64_t exact = in.number(); exact > 0; --exact) {
                    in.number();
                    in.real();
                }
            }
        }
        for (std::size_t a = 0; a < there.size(); ++a) {
            for (std::uint64_t bounds = in.number(); bounds > 0; --bounds) {
                in.real();
                in.real();
            }
        }
        SeriesStepParts step{text.substr(0, text.size() - in.left()), {}};
        if (length == 0) return step;
        const std::uint64_t packed = in.number();
        step.block = plain(std::string_view(text).substr(text.size() - packed), length);
        return step;
    }
};

}  // namespace subvol::test
