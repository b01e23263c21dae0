// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The intervals in which the ray of each pixel is inside a closed surface. Pixel p (row by row) has the depth pairs {enter,
/// exit} depths[2·offsets[p] .. 2·offsets[p+1]), ascending and disjoint. A slice is an interval without length.
struct PixelIntervals {
    static constexpr std::uint32_t kNoTriangle = 0xffffffff, kFirstFace = 0xffff0000;
    std::vector<std::uint32_t> offsets;
    std::vector<float> depths;
    /// Where each interval is entered; kNoTriangle at the near depth, kFirstFace + i at face i of a clip.
    std::vector<std::uint32_t> triangles;
    std::size_t hits = 0;  ///< crossings of all rays

    [[nodiscard]] bool is_slice(std::size_t i) const { return depths[2 * i] == depths[2 * i + 1]; }
};

/// What lies before this depth, in parts of the volume's diagonal, is not seen in perspective: there a pixel has no width.
/// Parallel rays begin at the eye's plane.
inline constexpr double kNearest = 1e-4;
[[nodiscard]] inline double nearest_depth(const View& view, double diagonal) {
    return view.perspective() ? kNearest * diagonal : 0.0;
}

/// The triangles of a surface in a picture, whose intervals are found in bands of rows, so that those of a whole picture need
/// not be kept.
class BoundaryRaster {
public:
    /// near, middle: as of `boundary_intervals`; surface, view: are kept by reference
    BoundaryRaster(const Surface& surface, const View& view, double near, double middle, int band_rows = 8);
    ~BoundaryRaster();
    BoundaryRaster(const BoundaryRaster&) = delete;
    BoundaryRaster& operator=(const BoundaryRaster&) = delete;

    [[nodiscard]] int band_count() const;
    /// The first row of a band; that of the band after the last one is the height of the picture.
    [[nodiscard]] int first_row(int band) const;
    /// The intervals of the pixels of a band, as `boundary_intervals` has them for all. For several threads at once.
    void find(int band, PixelIntervals& result) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Rasterizes a closed surface without gaps: vertices are snapped to 1/4096 px, and a pixel centre on a shared edge counts
/// once. A ray is inside where the surface goes round it, however often and in whichever direction: shells may be nested,
/// overlap, enclose the eye, and fold.
///
/// near:   depth below which nothing is seen
/// middle: the depth that all depths of the result are relative to
[[nodiscard]] PixelIntervals boundary_intervals(const Surface& surface, const View& view, double near, double middle);

/// The most intervals of a ray that shaders go through: a dispatch must not take any time that a scene asks for.
inline constexpr std::uint32_t kMostGlIntervals = 4096;

/// throws: Error(MissingCapability) if a ray has more of them
void check_for_gl(const PixelIntervals& intervals);

/// Whether any of the points lies before the near depth, or so far beside the picture that triangles are clipped.
[[nodiscard]] bool needs_clipping(std::span<const Vec3> points, const View& view, double near);

}  // namespace subvol::detail
