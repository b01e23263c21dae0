// SPDX-License-Identifier: Apache-2.0
#include "gl_tet_lists.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>

#include "gl_dispatch.h"
#include "gl_pace.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

// The same as in the shaders.
constexpr GLuint kCountsBinding = 3, kOffsetsBinding = 4, kEntriesBinding = 5, kRanksBinding = 6, kOtherEntriesBinding = 7,
                 kOtherRanksBinding = 8, kCountersBinding = 11, kBlocksBinding = 12;  // the states of pixels, too
constexpr std::size_t kSegment_bytes = 16, kCrossing_bytes = 8, kPixel_bytes = 16, kState_bytes = 24;
constexpr std::uint32_t kRun = 64;  // entries that a thread sorts or merges

/// Numbers that shaders count.
struct Counters {
    std::uint32_t wrong_pixels = 0, late_faces = 0, unfinished = 0;
};

std::uint32_t groups_of(std::size_t threads) {
    constexpr std::size_t kGroup = 64;
    return static_cast<std::uint32_t>((threads + kGroup - 1) / kGroup);
}
constexpr double kCounting = 0.2;  // the part of counting in the work, roughly
constexpr double kStoring = 0.5;   // the part of storing the fragments in the rest
constexpr std::size_t kFirstSteps = 4096, kLeastSteps = 64, kMostSteps = 1 << 15;  // of a pixel in a dispatch

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
    Counters counters;
    counters_.grow(sizeof counters);
    counters_.clear();
    counters_.bind(kCountersBinding);
    const auto counts = count_fragments(items, stage.part(0, kCounting));
    const auto parts = split_into_parts(counts, view.width(), view.height(), most_fragments);
    Drawn drawn{Image(view.width(), view.height()), std::accumulate(counts.begin(), counts.end(), std::size_t{0}),
                parts.size()};
    const double share = (1 - kCounting) / static_cast<double>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
        draw_part(items, parts[i], counts, drawn.image, stage.part(kCounting + share * static_cast<double>(i), share));
    counters_.read(sizeof counters, &counters);
    drawn.wrong_pixels = counters.wrong_pixels;
    drawn.late_faces = counters.late_faces;
    return drawn;
}

std::vector<std::uint32_t> GlTetLists::count_fragments(Items items, const DrawStage& stage) {
    const View& view = tets_.view();
    std::vector<std::uint32_t> counts(pixel_count(view.width(), view.height()));
    const std::size_t bytes = counts.size() * sizeof(std::uint32_t);
    counts_.grow(bytes);
    counts_.clear();
    counts_.bind(kCountsBinding);
    tets_.draw_into_lists(items, false, {0, 0, view.width(), view.height()}, stage);
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
    const std::size_t bytes = std::size_t{offsets.back()} * (items == Items::Tets ? kSegment_bytes : kCrossing_bytes);
    entries_.grow(bytes);
    entries_.bind(kEntriesBinding);
    ranks_.grow(std::size_t{offsets.back()} * sizeof(std::uint32_t));
    ranks_.bind(kRanksBinding);
    tets_.draw_into_lists(items, true, part, stage.part(0, kStoring));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    sort_part(items, part, offsets);
    composite_part(items, part, image, stage.part(kStoring, 1 - kStoring));
}

/// Sorts the lists: blocks of kRun entries by insertion, then pairs of runs are merged until each list is one run. The blocks
/// of longer lists come first, as only these are merged; where they end up in the other buffers, they begin there too.
void GlTetLists::sort_part(Items items, const PixelRect& part, const std::vector<std::uint32_t>& offsets) {
    std::vector<std::array<std::uint32_t, 2>> blocks, short_lists;
    std::uint32_t longest = 0;
    for (std::uint32_t list = 0; list + 1 < offsets.size(); ++list) {
        const std::uint32_t count = offsets[list + 1] - offsets[list];
        longest = std::max(longest, count);
        if (count > 1 && count <= kRun) short_lists.push_back({list, 0});
        for (std::uint32_t block = 0; count > kRun && block * kRun < count; ++block) blocks.push_back({list, block});
    }
    const auto merged = static_cast<std::uint32_t>(blocks.size());
    blocks.insert(blocks.end(), short_lists.begin(), short_lists.end());
    if (blocks.empty()) return;
    blocks_.grow(blocks.size() * sizeof blocks[0]);
    blocks_.upload(blocks.size() * sizeof blocks[0], blocks.data());
    blocks_.bind(kBlocksBinding);
    if (merged > 0) {
        other_entries_.grow(entries_.bytes());
        other_ranks_.grow(ranks_.bytes());
    }
    bool swapped = false;  // whether the lists that are merged are in the other buffers
    const auto run_program = [&](GlTets::ListStep step, std::uint32_t count, const char* name, std::uint32_t value) {
        (swapped ? other_entries_ : entries_).bind(kEntriesBinding);
        (swapped ? other_ranks_ : ranks_).bind(kRanksBinding);
        (swapped ? entries_ : other_entries_).bind(kOtherEntriesBinding);
        (swapped ? ranks_ : other_ranks_).bind(kOtherRanksBinding);
        const GlProgram& program = tets_.program(items, step);
        tets_.set_uniforms(program, part);
        glProgramUniform1ui(program.id(), program.uniform("block_count"), count);
        glProgramUniform1ui(program.id(), program.uniform(name), value);
        program.use();
        dispatch(groups_of(count));
    };
    int merges = 0;
    for (std::uint64_t run = kRun; run < longest; run *= 2) ++merges;
    const bool odd = merges % 2 == 1;
    run_program(GlTets::ListStep::Sort, static_cast<std::uint32_t>(blocks.size()), "moved_blocks", odd ? merged : 0);
    swapped = odd;
    for (int i = 0; i < merges; ++i) {
        run_program(GlTets::ListStep::Merge, merged, "run", kRun << i);
        swapped = !swapped;
    }
    entries_.bind(kEntriesBinding);
    ranks_.bind(kRanksBinding);
}

/// Repeats a dispatch until no pixel is unfinished.
void GlTetLists::repeat(const GlProgram& program, std::uint32_t pixels, const DrawStage& stage) {
    program.use();
    Counters counters;
    GlPace pace(kFirstSteps, kLeastSteps, kMostSteps);
    Stopwatch watch;
    for (bool resumed = false; !resumed || counters.unfinished > 0; resumed = true) {
        glProgramUniform1i(program.id(), program.uniform("resumed"), resumed);
        constexpr std::uint32_t kNone = 0;
        counters_.upload(sizeof kNone, &kNone, offsetof(Counters, unfinished));
        glProgramUniform1ui(program.id(), program.uniform("list_steps"), static_cast<GLuint>(pace.amount()));
        dispatch(groups_of(pixels));
        counters_.read(sizeof counters, &counters);
        pace.took(watch.restart());
        stage.report(1 - static_cast<double>(counters.unfinished) / pixels);
    }
}

void GlTetLists::composite_part(Items items, const PixelRect& part, Image& image, const DrawStage& stage) {
    const auto width = static_cast<std::size_t>(part.x1 - part.x0), height = static_cast<std::size_t>(part.y1 - part.y0);
    const auto pixels = static_cast<std::uint32_t>(width * height);
    picture_.grow(pixels * kPixel_bytes);
    picture_.bind(kCountsBinding);
    states_.grow(pixels * kState_bytes);
    states_.bind(kBlocksBinding);
    if (items == Items::Faces) {
        const GlProgram& window = tets_.program(items, GlTets::ListStep::Window);
        tets_.set_uniforms(window, part);
        glProgramUniform1ui(window.id(), window.uniform("kbuffer"), kbuffer_);
        repeat(window, pixels, stage.part(0, 0.5));
    }
    const GlProgram& composite = tets_.program(items, GlTets::ListStep::Composite);
    tets_.set_uniforms(composite, part);
    glProgramUniform1f(composite.id(), composite.uniform("eye_value"), static_cast<float>(tets_.frame().eye_value));
    repeat(composite, pixels, stage.part(0.5, 0.5));
    std::vector<std::array<float, 4>> colors(pixels);
    picture_.read(pixels * kPixel_bytes, colors.data());
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto pixel = image.pixel(part.x0 + static_cast<int>(i % width), part.y0 + static_cast<int>(i / width));
        std::copy(colors[i].begin(), colors[i].end(), pixel.begin());
    }
}

}  // namespace subvol::detail
