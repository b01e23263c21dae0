// SPDX-License-Identifier: Apache-2.0
// Why the pictures of parts are those of the whole. A ray walks from a face of the hull to another one, through tetrahedra that
// it crosses. All of these are among the cells that are gathered for its part of the picture, with the same points in the same
// order, so it takes the same steps. The cells that were left out are beside all rays of the part, hence so are the faces at
// which the gathered ones end: no ray begins or ends there. Boxes are widened by more than the error of Embree's floats, whose
// scene has the box of the whole mesh.
#include "subvol/render_brick_tets.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "pixel_tiles.h"
#include "pixel_wedge.h"
#include "subvol/detail/gather_cells.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "tet_scene.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMarginOfBox = 1e-5;        // of the diagonal: a hundred times the precision of floats
constexpr double kMarginOfDistance = 1e-12;  // of the distance to the eye: ten thousand times that of doubles

// The memory of a control cell that was gathered, with its share of points, while parts are put together; that of a refined
// cell, and of one with its tetrahedra while their faces are sorted.
constexpr double kBytesOfControl = 400, kBytesOfRefined = 200, kBytesOfTets = 800;

double children(const RefineOptions& refine) {
    return static_cast<double>(std::uint64_t{1} << 3 * refine.levels);
}

std::size_t cells_in(double bytes, double bytes_of_cell) {
    return static_cast<std::size_t>(std::min(bytes / bytes_of_cell, 1e18));
}

[[noreturn]] void fail_memory(const std::string& things) {
    throw Error(ErrorCode::InvalidInput, things + " do not fit into the memory", {}, "a larger --memory, or fewer --levels");
}

/// The number of cells whose tetrahedra may be there at a time.
std::size_t cells_at_once(const BrickTetsOptions& options) {
    return cells_in(0.75 * static_cast<double>(options.memory_bytes), children(options.refine) * kBytesOfTets);
}

void check(const MeshSource& source, const BrickTetsOptions& options) {
    source.check_halo(kHaloOfLimit, "values of the limit");
    if (options.refine.levels < 0 || options.refine.levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(options.refine.levels), {}, "0 to 10");
    }
    if (cells_at_once(options) == 0) fail_memory("the tetrahedra of one cell");
}

std::vector<Index> owned_cells(const MeshPiece& part) {
    std::vector<Index> cells;
    for (Index c = 0; c < part.owned_cells.size(); ++c) {
        if (part.owned_cells[c]) cells.push_back(c);
    }
    return cells;
}

Box box_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    Box box;
    for (const Index p : cell) box.add(mesh.points[p]);
    return box;
}

/// How far the descendants of a cell reach out of its box, as a part of the box's diagonal.
double overhang_of(const Box& box, const HexMesh& fine, std::span<const std::array<Index, 8>> descendants) {
    Vec3 most(0.0);
    for (const auto& cell : descendants) {
        for (const Index p : cell) {
            most = glm::max(most, glm::max(box.lower - fine.points[p], fine.points[p] - box.upper));
        }
    }
    const double farthest = std::max({most.x, most.y, most.z});
    return farthest > 0 ? farthest / box.diagonal() : 0;
}

/// The largest of some cells. fine: these cells refined
double overhang_of(const HexMesh& control, std::span<const Index> cells, const HexMesh& fine) {
    const std::size_t each = fine.cells.size() / cells.size();
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, cells.size(), 64), 0.0,
        [&](const auto& range, double most) {
            for (std::size_t k = range.begin(); k < range.end(); ++k) {
                const auto descendants = std::span(fine.cells).subspan(k * each, each);
                most = std::max(most, overhang_of(box_of(control, control.cells[cells[k]]), fine, descendants));
            }
            return most;
        },
        [](double a, double b) { return std::max(a, b); });
}

/// Divides a picture into parts that are small enough to be drawn.
class PictureParts {
public:
    /// Calls draw(PixelRect) for the picture, or for halves of halves of it where that returns false. What was too large once
    /// is not tried again.
    template <class Draw>
    void each(const PixelRect& picture, const Draw& draw) {
        std::vector<PixelRect> left{picture};
        while (!left.empty()) {
            const PixelRect part = left.back();
            left.pop_back();
            if (part.empty()) continue;
            if (pixels(part) <= most_) {
                if (draw(part)) continue;
                most_ = pixels(part) - 1;
            }
            if (pixels(part) == 1) {
                fail_memory("the cells that the rays of one pixel may cross");
            }
            PixelRect one = part, other = part;
            if (part.x1 - part.x0 > part.y1 - part.y0) {
                one.x1 = other.x0 = (part.x0 + part.x1) / 2;
            } else {
                one.y1 = other.y0 = (part.y0 + part.y1) / 2;
            }
            left.push_back(other);
            left.push_back(one);
        }
    }

    static std::int64_t pixels(const PixelRect& part) {
        return static_cast<std::int64_t>(part.x1 - part.x0) * (part.y1 - part.y0);
    }

private:
    std::int64_t most_ = std::numeric_limits<std::int64_t>::max();
};

/// The progress of a part of the picture as that of the picture, whose fraction grows while rays are traced.
class DrawnPixels : public Progress {
public:
    DrawnPixels(Progress* whole, const PixelRect& picture)
        : whole_(whole), all_(static_cast<double>(PictureParts::pixels(picture))) {}

    void begin(const PixelRect& part) { part_ = static_cast<double>(PictureParts::pixels(part)); }
    void end() {
        done_ += part_;
        part_ = 0;
    }
    void report(std::string_view stage, double fraction) override {
        if (whole_) whole_->report("draw", (done_ + (stage == "draw" ? fraction * part_ : 0)) / all_);
    }
    [[nodiscard]] bool cancelled() const override { return whole_ && whole_->cancelled(); }

private:
    Progress* whole_;
    double all_, done_ = 0, part_ = 0;
};

class BrickTetsDrawer {
public:
    BrickTetsDrawer(const BrickTets& all, const View& view, const Optics& optics, const BrickTetsOptions& options,
                    const PixelRect& picture)
        : all_(all),
          view_(view),
          optics_(optics),
          options_(options),
          clip_(without_far_faces(options.tets.clip, all.bounds), all.bounds.diagonal()),
          progress_(options.tets.progress, picture),
          result_{Image(view.width(), view.height()), {}} {
        const double distance = glm::length(view.ray(0.5 * view.width(), 0.5 * view.height()).origin - all.bounds.center());
        margin_ = kMarginOfBox * all.bounds.diagonal() + kMarginOfDistance * distance;
        result_.report.tets = all.tets;
        result_.report.degenerate_tets = all.degenerate_tets;
        result_.report.inverted_tets = all.inverted_tets;
    }

    /// The control cells that the rays through a part of the picture may cross; nothing if they are too many.
    [[nodiscard]] std::optional<MeshPiece> gather(const MeshSource::Stored& bricks, const PixelRect& part,
                                                  std::size_t most_cells) {
        const PixelWedge wedge(view_, part, margin_);
        return gather_cells(bricks, {.reads = [&](std::size_t b) { return wedge.may_touch(all_.of_bricks[b]); },
                                     .chooses = [&](const MeshPiece& brick) { return crossed(brick, wedge); },
                                     .layers = kHaloOfLimit,
                                     .most_cells = most_cells,
                                     .progress = &progress_});
    }

    /// Draws a part of the picture from the control cells that its rays may cross; false if it is too large.
    bool draw(const PixelRect& part, const MeshPiece& control, std::size_t most_cells) {
        const Stopwatch build;
        const std::vector<std::uint8_t> chosen = crossed(control, PixelWedge(view_, part, margin_));
        if (static_cast<std::size_t>(std::ranges::count(chosen, 1)) > most_cells) return false;
        const MeshPiece gathered = chosen_cells(control, chosen, kHaloOfLimit);
        const std::vector<Index> cells = owned_cells(gathered);
        progress_.begin(part);
        if (!cells.empty()) trace(part, limit_of_cells(gathered.mesh, cells, quiet()), build);
        progress_.end();
        return true;
    }

    [[nodiscard]] TetsResult take() { return std::move(result_); }

private:
    /// Which of the owned cells of a part some rays may cross.
    [[nodiscard]] std::vector<std::uint8_t> crossed(const MeshPiece& part, const PixelWedge& wedge) const {
        std::vector<std::uint8_t> flags = part.owned_cells;
        parallel_each(flags.size(), [&](std::size_t c) {
            if (!flags[c]) return;
            const Box box = box_of(part.mesh, part.mesh.cells[c]);
            const Vec3 more(all_.overhang * box.diagonal());
            flags[c] = wedge.may_touch({box.lower - more, box.upper + more});
        });
        return flags;
    }

    [[nodiscard]] RefineOptions quiet() const {
        RefineOptions refine = options_.refine;
        refine.progress = nullptr;
        return refine;
    }

    void trace(const PixelRect& part, HexMesh fine, const Stopwatch& build) {
        const TetScene scene(fine, scalar_field(fine, {}).values, all_.bounds, &progress_);
        fine = {};
        TetsReport& report = result_.report;
        report.seconds_build += build.seconds();
        const Stopwatch watch;
        const TraceCounts counts = scene.draw(view_, optics_, options_.tets.samples, clip_, part, &progress_, result_.image);
        report.rays += counts.rays;
        report.segments += counts.segments;
        report.lost_rays += counts.lost_rays;
        report.seconds_draw += watch.seconds();
    }

    const BrickTets& all_;
    const View& view_;
    const Optics& optics_;
    const BrickTetsOptions& options_;
    RayClip clip_;
    DrawnPixels progress_;
    TetsResult result_;
    double margin_ = 0;
};

}  // namespace

void BrickTets::add(const BrickTets& other) {
    bounds.add(other.bounds);
    of_bricks.insert(of_bricks.end(), other.of_bricks.begin(), other.of_bricks.end());
    overhang = std::max(overhang, other.overhang);
    tets += other.tets;
    degenerate_tets += other.degenerate_tets;
    inverted_tets += other.inverted_tets;
}

BrickTets measure_tets(const MeshSource& source, const BrickTetsOptions& options, std::size_t begin, std::size_t end) {
    check(source, options);
    const MeshSource::Stored stored = source.in_pieces();
    RefineOptions refine = options.refine;
    refine.progress = nullptr;
    const double memory = static_cast<double>(options.memory_bytes);
    const std::size_t most = cells_in(memory, children(refine) * kBytesOfRefined);
    BrickTets all;
    for (std::size_t b = begin; b < end; ++b) {
        MeshPiece brick = stored.read(b);
        brick.mesh.attributes.clear();
        BrickTets gathered;
        const std::vector<Index> cells = owned_cells(brick);
        for (std::size_t first = 0; first < cells.size(); first += most) {
            const double done = static_cast<double>(b - begin) + static_cast<double>(first) / static_cast<double>(cells.size());
            report_progress(options.tets.progress, "measure", done / static_cast<double>(end - begin));
            const auto some = std::span(cells).subspan(first, std::min(most, cells.size() - first));
            const HexMesh fine = limit_of_cells(brick.mesh, some, refine);
            const TetShapes shapes = tet_shapes(fine);
            gathered.add({.bounds = bounds(fine),
                          .overhang = overhang_of(brick.mesh, some, fine),
                          .tets = 6 * fine.cells.size(),
                          .degenerate_tets = shapes.degenerate,
                          .inverted_tets = shapes.inverted});
        }
        gathered.of_bricks = {gathered.bounds};
        all.add(gathered);
    }
    return all;
}

TetsResult render_tets(const MeshSource& source, const BrickTets& all, const View& view, const Optics& optics,
                       const BrickTetsOptions& options) {
    check_samples(options.tets.samples);
    check(source, options);
    const MeshSource::Stored stored = source.in_pieces();
    const PixelRect picture = rect_of(options.tets.rows, view.width(), view.height());
    BrickTetsDrawer drawer(all, view, optics, options, picture);
    // Control cells take little of the memory, so each brick is read for few large parts; these are then drawn in smaller ones.
    const std::size_t most_control = cells_in(0.25 * static_cast<double>(options.memory_bytes), kBytesOfControl);
    const std::size_t most_tets = cells_at_once(options);
    PictureParts outer, inner;
    outer.each(picture, [&](const PixelRect& gathered) {
        const auto control = drawer.gather(stored, gathered, most_control);
        if (!control) return false;
        inner.each(gathered, [&](const PixelRect& part) { return drawer.draw(part, *control, most_tets); });
        return true;
    });
    return drawer.take();
}

}  // namespace subvol
