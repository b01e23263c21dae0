// SPDX-License-Identifier: Apache-2.0
#include "clip_intervals.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

/// What is left of the intervals of one row of pixels.
struct PixelRow {
    std::vector<std::uint32_t> counts;  // of each pixel
    std::vector<float> depths;
    std::vector<std::uint32_t> triangles;

    void add(float enter, float exit, std::uint32_t triangle) {
        depths.insert(depths.end(), {enter, exit});
        triangles.push_back(triangle);
    }
};

class IntervalClipper {
public:
    IntervalClipper(const RayClip& clip, double middle) : alone_(clip.slices_alone()), middle_(middle) {}

    void add(float enter, float exit, std::uint32_t triangle, const RayCut& cut, PixelRow& row) const {
        const auto relative = [&](double depth) { return static_cast<float>(depth - middle_); };
        if (cut.near_face != RayCut::kNoFace && relative(cut.near) > enter) {
            enter = relative(cut.near);
            triangle = PixelIntervals::kFirstFace + static_cast<std::uint32_t>(cut.near_face);
        }
        exit = std::min(exit, relative(cut.far));
        for (const RaySlice& slice : cut.slices) {
            const auto from = static_cast<double>(enter), to = static_cast<double>(exit);
            const RaySlice near{slice.depth - middle_, slice.tolerance};
            if (!near.meets(from, to)) continue;
            const auto z = static_cast<float>(near.within(from, to));
            if (!alone_ && z > enter) row.add(enter, z, triangle);
            row.add(z, z, PixelIntervals::kNoTriangle);
            enter = z;
            triangle = PixelIntervals::kNoTriangle;
        }
        if (!alone_ && exit > enter) row.add(enter, exit, triangle);
    }

private:
    bool alone_;
    double middle_;
};

/// first_row: of those that the intervals are of
PixelRow clipped_row(const PixelIntervals& intervals, int first_row, int y, const View& view, const RayClip& clip,
                     double middle) {
    const IntervalClipper clipper(clip, middle);
    const auto width = static_cast<std::size_t>(view.width()), row_before = static_cast<std::size_t>(y - first_row) * width;
    PixelRow row;
    row.counts.resize(width);
    RayCut cut;
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t first = intervals.offsets[row_before + x], end = intervals.offsets[row_before + x + 1];
        if (first == end) continue;
        const std::size_t before = row.triangles.size();
        clip.cut(view.ray(static_cast<double>(x) + 0.5, y + 0.5), cut);
        if (cut.empty()) continue;
        for (std::size_t i = first; i < end; ++i) {
            clipper.add(intervals.depths[2 * i], intervals.depths[2 * i + 1], intervals.triangles[i], cut, row);
        }
        row.counts[x] = static_cast<std::uint32_t>(row.triangles.size() - before);
    }
    return row;
}

PixelIntervals joined(const std::vector<PixelRow>& rows, std::size_t hits) {
    PixelIntervals result;
    result.hits = hits;
    result.offsets.push_back(0);
    for (const PixelRow& row : rows) {
        for (const auto count : row.counts) result.offsets.push_back(result.offsets.back() + count);
        result.depths.insert(result.depths.end(), row.depths.begin(), row.depths.end());
        result.triangles.insert(result.triangles.end(), row.triangles.begin(), row.triangles.end());
    }
    return result;
}

/// One interval for each pixel, as deep as all sheets.
PixelIntervals whole_rays(const View& view, const SheetStack& sheets) {
    const auto pixels = pixel_count(view.width(), view.height());
    const float end = sheets.depth(sheets.count - 1) + sheets.distance;
    PixelIntervals whole;
    whole.offsets.resize(pixels + 1);
    whole.triangles.assign(pixels, PixelIntervals::kNoTriangle);
    for (std::size_t i = 0; i < pixels; ++i) {
        whole.offsets[i + 1] = static_cast<std::uint32_t>(i + 1);
        whole.depths.insert(whole.depths.end(), {sheets.near, end});
    }
    return whole;
}

/// Puts a slice before the intervals in which rays begin. Those are the first ones of their pixels, and were not entered.
PixelIntervals with_material_at_eye(const PixelIntervals& intervals) {
    const auto begins = [&](std::size_t i) {
        return intervals.triangles[i] == PixelIntervals::kNoTriangle && !intervals.is_slice(i);
    };
    PixelIntervals result;
    result.hits = intervals.hits;
    result.offsets.push_back(0);
    for (std::size_t pixel = 0; pixel + 1 < intervals.offsets.size(); ++pixel) {
        const std::size_t first = intervals.offsets[pixel], end = intervals.offsets[pixel + 1];
        if (first < end && begins(first)) {
            result.depths.insert(result.depths.end(), 2, intervals.depths[2 * first]);
            result.triangles.push_back(PixelIntervals::kNoTriangle);
        }
        const auto at = [](const auto& values, std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
        result.depths.insert(result.depths.end(), at(intervals.depths, 2 * first), at(intervals.depths, 2 * end));
        result.triangles.insert(result.triangles.end(), at(intervals.triangles, first), at(intervals.triangles, end));
        result.offsets.push_back(static_cast<std::uint32_t>(result.triangles.size()));
    }
    return result;
}

}  // namespace

PixelIntervals clip_intervals(const PixelIntervals& intervals, const View& view, const RayClip& clip, double middle) {
    std::vector<PixelRow> rows(static_cast<std::size_t>(view.height()));
    tbb::parallel_for(0, view.height(),
                      [&](int y) { rows[static_cast<std::size_t>(y)] = clipped_row(intervals, 0, y, view, clip, middle); });
    return joined(rows, intervals.hits);
}

PixelIntervals clip_rows(const PixelIntervals& intervals, int first_row, const View& view, const RayClip& clip, double middle) {
    std::vector<PixelRow> rows;
    const std::size_t count = (intervals.offsets.size() - 1) / static_cast<std::size_t>(view.width());
    for (int y = first_row; rows.size() < count; ++y) rows.push_back(clipped_row(intervals, first_row, y, view, clip, middle));
    return joined(rows, intervals.hits);
}

bool has_cuts(const SplatScene& scene, const View& view) {
    return !scene.clip.empty() || view.ends_rays();
}

PixelIntervals scene_intervals(const SplatScene& scene, const View& view, const SheetStack& sheets) {
    const double middle = view.to_eye(scene.middle).z;
    if (scene.half_weight > 0) {
        return has_cuts(scene, view) ? clip_intervals(whole_rays(view, sheets), view, scene.clip, middle) : PixelIntervals{};
    }
    PixelIntervals intervals =
        boundary_intervals(scene.volume->boundary, view, static_cast<double>(sheets.near) + middle, middle);
    if (has_cuts(scene, view)) intervals = clip_intervals(intervals, view, scene.clip, middle);
    const bool inside = std::ranges::find(intervals.triangles, PixelIntervals::kNoTriangle) != intervals.triangles.end();
    return scene.solid && inside ? with_material_at_eye(intervals) : intervals;
}

}  // namespace subvol::detail
