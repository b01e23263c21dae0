// SPDX-License-Identifier: Apache-2.0
#include "gl_tet_lists.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "gl_dispatch.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

// The same as in the shaders.
constexpr GLuint kCountsBinding = 3, kOffsetsBinding = 4, kEntriesBinding = 5, kRanksBinding = 6, kMissesBinding = 11;
constexpr std::size_t kSegment_bytes = 16, kCrossing_bytes = 8, kPixel_bytes = 16;
constexpr double kCounting = 0.2;  // the part of counting in the work, roughly

constexpr std::size_t kMostPixels = std::size_t{1} << 20;  // of a part: the numbers kept for each pixel have to fit too

/// Splits a row that has too many fragments as a whole.
void split_row(std::span<const std::uint32_t> counts, int y, std::size_t most, std::vector<PixelRect>& parts) {
    int first = 0;
    std::size_t sum = 0;
    const int width = static_cast<int>(counts.size());
    for (int x = 0; x < width; ++x) {
        const std::size_t count = counts[static_cast<std::size_t>(x)];
        if (count > most) {
            throw Error(ErrorCode::InvalidInput, "a pixel has " + std::to_string(count) + " segments", {},
                        "memory for lists of more than " + std::to_string(most));
        }
        if (sum + count > most) {
            parts.push_back({first, y, x, y + 1});
            first = x;
            sum = 0;
        }
        sum += count;
    }
    parts.push_back({first, y, width, y + 1});
}

}  // namespace

std::vector<PixelRect> split_into_parts(std::span<const std::uint32_t> counts, int width, int height,
                                        std::size_t most_fragments) {
    std::vector<PixelRect> parts;
    const auto row_pixels = static_cast<std::size_t>(width);
    PixelRect part{0, 0, width, 0};
    std::size_t sum = 0;
    const auto end_part = [&](int next_row) {
        if (!part.empty()) parts.push_back(part);
        part = {0, next_row, width, next_row};
        sum = 0;
    };
    for (int y = 0; y < height; ++y) {
        const auto row = counts.subspan(static_cast<std::size_t>(y) * row_pixels, row_pixels);
        const std::size_t count = std::accumulate(row.begin(), row.end(), std::size_t{0});
        const auto pixels = static_cast<std::size_t>(y + 1 - part.y0) * row_pixels;
        if (sum + count > most_fragments || pixels > kMostPixels) end_part(y);
        if (count > most_fragments) {
            split_row(row, y, most_fragments, parts);
            part = {0, y + 1, width, y + 1};
            continue;
        }
        part.y1 = y + 1;
        sum += count;
    }
    end_part(height);
    return parts;
}

GlTetLists::Drawn GlTetLists::draw_tets(std::size_t most_fragments, const DrawStage& stage) {
    return draw(Items::Tets, most_fragments, stage);
}

GlTetLists::Drawn GlTetLists::draw_faces(std::size_t kbuffer, std::size_t most_fragments, const DrawStage& stage) {
    kbuffer_ = static_cast<std::uint32_t>(kbuffer);
    return draw(Items::Faces, most_fragments, stage);
}

GlTetLists::Drawn GlTetLists::draw(Items items, std::size_t most_fragments, const DrawStage& stage) {
    const View& view = tets_.view();
    std::array<std::uint32_t, 2> misses{};
    misses_.grow(sizeof misses);
    misses_.clear();
    misses_.bind(kMissesBinding);
    const auto counts = count_fragments(items, stage.part(0, kCounting));
    const auto parts = split_into_parts(counts, view.width(), view.height(), most_fragments);
    Drawn drawn{Image(view.width(), view.height()), std::accumulate(counts.begin(), counts.end(), std::size_t{0}),
                parts.size()};
    const double share = (1 - kCounting) / static_cast<double>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
        draw_part(items, parts[i], counts, drawn.image, stage.part(kCounting + share * static_cast<double>(i), share));
    misses_.read(sizeof misses, misses.data());
    drawn.wrong_pixels = misses[0];
    drawn.late_faces = misses[1];
    return drawn;
}

std::vector<std::uint32_t> GlTetLists::count_fragments(Items items, const DrawStage& stage) {
    const View& view = tets_.view();
    std::vector<std::uint32_t> counts(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()));
    const std::size_t bytes = counts.size() * sizeof(std::uint32_t);
    counts_.grow(bytes);
    counts_.clear();
    counts_.bind(kCountsBinding);
    tets_.draw_into_lists(items, tets_.program(items, "FRAGMENT_COUNT"), {0, 0, view.width(), view.height()}, stage);
    counts_.read(bytes, counts.data());
    return counts;
}

void GlTetLists::draw_part(Items items, const PixelRect& part, const std::vector<std::uint32_t>& counts, Image& image,
                           const DrawStage& stage) {
    const auto width = static_cast<std::size_t>(tets_.view().width());
    std::vector<std::uint32_t> offsets{0};
    for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x)
            offsets.push_back(offsets.back() + counts[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]);
    }
    if (offsets.back() == 0) return;
    counts_.clear();
    counts_.bind(kCountsBinding);
    offsets_.grow(offsets.size() * sizeof(std::uint32_t));
    offsets_.upload(offsets.size() * sizeof(std::uint32_t), offsets.data());
    offsets_.bind(kOffsetsBinding);
    entries_.grow(offsets.back() * (items == Items::Tets ? kSegment_bytes : kCrossing_bytes));
    entries_.bind(kEntriesBinding);
    ranks_.grow(offsets.back() * sizeof(std::uint32_t));
    ranks_.bind(kRanksBinding);
    tets_.draw_into_lists(items, tets_.program(items, "FRAGMENT_KEEP"), part, stage);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    resolve_part(items, part, image);
}

void GlTetLists::resolve_part(Items items, const PixelRect& part, Image& image) {
    constexpr std::uint32_t kGroup = 64;
    const auto width = static_cast<std::size_t>(part.x1 - part.x0), height = static_cast<std::size_t>(part.y1 - part.y0);
    const auto pixels = static_cast<std::uint32_t>(width * height);
    picture_.grow(pixels * kPixel_bytes);
    picture_.bind(kCountsBinding);
    const GlProgram& resolver = tets_.resolver(items);
    tets_.set_uniforms(resolver, part);
    if (items == Items::Faces) {
        glProgramUniform1ui(resolver.id(), resolver.uniform("kbuffer"), kbuffer_);
        glProgramUniform1f(resolver.id(), resolver.uniform("eye_value"), static_cast<float>(tets_.frame().eye_value));
    }
    resolver.use();
    dispatch((pixels + kGroup - 1) / kGroup);
    std::vector<std::array<float, 4>> colors(pixels);
    picture_.read(pixels * kPixel_bytes, colors.data());
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto pixel = image.pixel(part.x0 + static_cast<int>(i % width), part.y0 + static_cast<int>(i / width));
        std::copy(colors[i].begin(), colors[i].end(), pixel.begin());
    }
}

}  // namespace subvol::detail
