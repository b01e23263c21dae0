// SPDX-License-Identifier: Apache-2.0
// Draws a volume by rays through grids of the limit at level L. The level is given, estimated from the limit before drawing, or
// raised until the picture changes by less than a tolerance (RMS over RGB). One level is drawn in this order:
//
//     find    each control cell is refined; cells with invisible values or outside the picture are left out; grids are kept as
//             long as all of them fit into the memory
//     plan    the picture is halved until no part needs more grids than fit into memory at once
//     draw    for each part its grids are made anew, unless all are kept, and its rays traced in tiles
//
// Where light ends within a tenth of the diagonal and there are no slices, grids are made from outside inwards instead: those
// at the boundary first, then those that rays wait for and layers around them, twice as many each time. Pixels that wait are
// traced again. If these grids do not fit into the memory, this is given up, and nothing is kept of it. Grids and pixels are
// sorted before they are used.
#include "subvol/render_dense.h"

#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <vector>

#include "dense_level.h"
#include "dense_tracer.h"
#include "pixel_tiles.h"
#include "subvol/detail/all_cells.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/hex_mesh.h"

namespace subvol {

using namespace detail;

namespace {

/// A grid that can be seen, and its rectangle in the picture.
struct SeenGrid {
    Index cell;
    PixelRect rect;
};

/// A part of the picture, and the cells of all grids that its rays may meet.
struct DensePass {
    PixelRect rect;
    std::vector<Index> cells;
};

bool overlap(const PixelRect& a, const PixelRect& b) {
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

void plan(const PixelRect& rect, const std::vector<SeenGrid>& grids, std::size_t at_once, std::vector<DensePass>& passes) {
    constexpr int kTile = 16;
    std::vector<SeenGrid> inside;
    std::copy_if(grids.begin(), grids.end(), std::back_inserter(inside),
                 [&](const SeenGrid& grid) { return overlap(grid.rect, rect); });
    if (inside.empty()) return;
    const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
    if (inside.size() > at_once && std::max(width, height) > kTile) {
        PixelRect first = rect, second = rect;
        if (width >= height) {
            first.x1 = second.x0 = rect.x0 + width / 2;
        } else {
            first.y1 = second.y0 = rect.y0 + height / 2;
        }
        plan(first, inside, at_once, passes);
        plan(second, inside, at_once, passes);
        return;
    }
    DensePass pass{rect, {}};
    for (const SeenGrid& grid : inside) pass.cells.push_back(grid.cell);
    passes.push_back(std::move(pass));
}

/// The pixels whose rays may meet a box: nothing if it lies outside the picture or behind the eye, all pixels if it reaches
/// behind the eye.
std::optional<PixelRect> pixels_of(const Box& box, const View& view) {
    constexpr double kMargin = 1;  // in pixels, for rounding
    const PixelRect all{0, 0, view.width(), view.height()};
    Vec2 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
    int near_eye = 0, behind = 0;
    for (int k = 0; k < 8; ++k) {
        const Vec3 corner(k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                          k & 4 ? box.upper.z : box.lower.z);
        const Vec3 eye = view.to_eye(corner);
        if (!(eye.z > 1e-6 * glm::length(eye))) {
            ++near_eye;
            behind += eye.z <= 0;
            continue;
        }
        const Vec2 at = view.to_pixels(eye);
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    if (behind == 8) return std::nullopt;
    if (near_eye > 0) return all;
    const auto pixel = [](double x, int most) { return static_cast<int>(std::clamp(x, 0.0, double(most))); };
    const PixelRect rect{pixel(std::floor(low.x - kMargin), all.x1), pixel(std::floor(low.y - kMargin), all.y1),
                         pixel(std::ceil(high.x + kMargin), all.x1), pixel(std::ceil(high.y + kMargin), all.y1)};
    if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1) return std::nullopt;
    return rect;
}

/// Halves the picture until each part has at most `at_once` grids. A part of 16 × 16 pixels is not halved, whatever it needs.
std::vector<DensePass> plan_passes(const View& view, const std::vector<SeenGrid>& grids, std::size_t at_once) {
    std::vector<DensePass> passes;
    plan({0, 0, view.width(), view.height()}, grids, std::max<std::size_t>(at_once, 1), passes);
    return passes;
}

constexpr int kMostLevels = 8;  // faces of tetrahedra are numbered with 32 bits

void check(const DenseOptions& options) {
    check_samples(options.samples);
    for (const int levels : {options.levels.value_or(1), options.max_levels}) {
        if (levels >= 0 && levels <= kMostLevels) continue;
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(levels), {},
                    "0 to " + std::to_string(kMostLevels));
    }
    if (const double tolerance = options.image_tolerance.value_or(1); !(tolerance > 0 && std::isfinite(tolerance))) {
        throw Error(ErrorCode::InvalidInput, "the tolerance of the image is " + number_text(tolerance), {}, "more than 0");
    }
}

/// The mesh with the field as its only attribute.
HexMesh with_field_alone(const HexMesh& mesh, std::string_view field) {
    return {mesh.points, mesh.cells, {scalar_field(mesh, field)}, mesh.creases, mesh.sharp_faces};
}

bool visible(const Optics& optics, double min, double max) {
    const auto opaque = [&](double value) { return optics.extinction(value) > 0; };
    const auto knots = optics.knots();
    return opaque(min) || opaque(max) ||
           std::any_of(knots.begin(), knots.end(), [&](double knot) { return knot > min && knot < max && opaque(knot); });
}

double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        const double change = double{a.rgba[i]} - double{b.rgba[i]};
        if (i % 4 != 3) sum += change * change;
    }
    return std::sqrt(sum / (0.75 * static_cast<double>(a.rgba.size())));
}

/// How far light comes in the clearest value, in world units; infinity if a value may be invisible.
double farthest_sight(const Optics& optics) {
    double least = optics.extinction(0);
    for (const double knot : optics.knots()) least = std::min(least, optics.extinction(knot));
    if (std::ranges::any_of(optics.spans(), &Optics::Span::transparent)) least = 0;
    return -std::log(kRayCutoff) / least;
}

/// The cells with a point on an open side.
std::vector<std::uint8_t> cells_at_boundary(const HexMesh& mesh, const CellSides& sides) {
    std::vector<std::uint8_t> at_boundary(mesh.points.size(), 0), chosen(mesh.cells.size(), 0);
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t side = 0; side < 6; ++side) {
            if (!sides.open(c, side)) continue;
            for (const std::size_t corner : kCellFaces[side]) at_boundary[mesh.cells[c][corner]] = 1;
        }
    }
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        chosen[c] = std::ranges::any_of(mesh.cells[c], [&](Index p) { return at_boundary[p] != 0; }) ? 1 : 0;
    }
    return chosen;
}

// What the tracers of a picture have found: counts, and what has to wait for grids.
struct TraceSums {
    TraceCounts counts;
    std::vector<Index> pixels, cells;

    TraceSums& operator+=(const TraceSums& other) {
        counts += other.counts;
        pixels.insert(pixels.end(), other.pixels.begin(), other.pixels.end());
        cells.insert(cells.end(), other.cells.begin(), other.cells.end());
        return *this;
    }
};

// Traces, and adds its counts to the sums when its tile is done.
class CountedTracer {
public:
    CountedTracer(const DenseScene& scene, const Optics& optics, const RayClip& clip, tbb::combinable<TraceSums>& sums)
        : tracer_(scene, optics, clip), sums_(&sums) {}
    CountedTracer(CountedTracer&&) = delete;
    ~CountedTracer() {
        found_.counts = tracer_.counts();
        sums_->local() += found_;
    }
    Segment operator()(const Ray& ray) {
        const Segment seen = tracer_.trace(ray);
        if (tracer_.awaited() != kNone) found_.cells.push_back(tracer_.awaited());
        return seen;
    }
    /// Traces a pixel. One that has to wait for a grid is not written or counted.
    void draw(const View& view, int samples, Index pixel, Image& image) {
        const TraceCounts before = tracer_.counts();
        const std::size_t waited = found_.cells.size();
        const int x = static_cast<int>(pixel) % view.width(), y = static_cast<int>(pixel) / view.width();
        const Segment seen = trace_pixel(view, x, y, samples, *this);
        if (found_.cells.size() == waited) return write_pixel(image, x, y, seen);
        found_.pixels.push_back(pixel);
        tracer_.set_counts(before);
    }

private:
    DenseTracer tracer_;
    tbb::combinable<TraceSums>* sums_;
    TraceSums found_;
};

/// Draws one level.
class LevelPainter {
public:
    LevelPainter(const HexMesh& mesh, const CellSides& sides, const View& view, const Optics& optics,
                 const DenseOptions& options, int levels)
        : mesh_(mesh),
          sides_(sides),
          view_(view),
          optics_(optics),
          options_(options),
          clip_(options.clip, bounds(mesh).diagonal()),
          refine_(options.refine),
          image_(view.width(), view.height()) {
        refine_.levels = levels;
        refine_.progress = nullptr;
        report_.levels = levels;
    }

    DenseResult run() {
        Stopwatch watch;
        report_progress(options_.progress, "build", 0);
        if (draw_from_outside()) return {std::move(image_), report_};
        find_seen({});
        const std::size_t at_once = most_bytes_ > 0 ? options_.memory / most_bytes_ : seen_.size();
        const std::vector<DensePass> passes = plan_passes(view_, seen_, at_once);
        report_.passes = passes.size();
        const bool kept_suffice = passes.size() == 1 && kept_.size() == seen_.size();
        for (const DensePass& pass : passes) {
            if (!kept_suffice) build(pass.cells);
            sort_kept();
            report_.seconds_build += watch.restart();
            draw(pass.rect);
            report_.seconds_draw += watch.restart();
        }
        report_.seconds_build += watch.seconds();
        return {std::move(image_), report_};
    }

private:
    /// Where light does not come far, most grids inside are not seen. Makes those at the boundary, and as long as rays come to
    /// others, these and some around them: twice as many layers each time. False if that does not pay, needs too much memory,
    /// or rays begin in the body's box, as they may begin in a grid that is not there; then nothing has been done.
    bool draw_from_outside() {
        constexpr double kFar = .1;              // of the diagonal
        constexpr std::size_t kMostWaiting = 4;  // one pixel of so many; then all grids are made
        const Box box = bounds(mesh_);
        if (clip_.has_slices() || !(farthest_sight(optics_) < kFar * box.diagonal())) return false;
        const Vec3& eye = view_.eye();
        if (glm::all(glm::lessThanEqual(box.lower, eye)) && glm::all(glm::lessThanEqual(eye, box.upper))) return false;
        std::vector<std::uint8_t> made = cells_at_boundary(mesh_, sides_);
        std::vector<Index> wanted;
        for (Index c = 0; c < made.size(); ++c) {
            if (made[c] != 0) wanted.push_back(c);
        }
        if (4 * wanted.size() > 3 * made.size()) return false;
        std::vector<Index> pixels(image_.rgba.size() / 4);
        std::iota(pixels.begin(), pixels.end(), Index{0});
        for (int layers = 1; !pixels.empty(); layers *= 2) {
            Stopwatch watch;
            find_seen(wanted);
            if (kept_.size() < seen_.size() || wanted.empty()) return forget();
            sort_kept();
            report_.seconds_build += watch.restart();
            TraceSums sums = draw_pixels(pixels);
            report_.seconds_draw += watch.restart();
            const bool many = kMostWaiting * sums.pixels.size() > pixels.size();
            wanted = many ? all_cells(mesh_) : cells_around(std::move(sums.cells), layers);
            std::erase_if(wanted, [&](Index c) { return made[c] != 0; });
            for (const Index c : wanted) made[c] = 1;
            std::ranges::sort(sums.pixels);
            pixels = std::move(sums.pixels);
        }
        report_.skipped_blocks = mesh_.cells.size() - report_.blocks;
        report_.passes = 1;
        return true;
    }

    bool forget() {
        drop();
        seen_.clear();
        most_bytes_ = 0;
        report_ = {.levels = report_.levels};
        image_ = Image(view_.width(), view_.height());
        return false;
    }

    [[nodiscard]] TraceSums draw_pixels(const std::vector<Index>& pixels) {
        constexpr std::size_t kRun = 256;
        const DenseScene scene(kept_, sides_, DenseScene::Absent::NotYet);
        tbb::combinable<TraceSums> sums;
        tbb::parallel_for(std::size_t{0}, (pixels.size() + kRun - 1) / kRun, [&](std::size_t run) {
            CountedTracer tracer(scene, optics_, clip_, sums);
            for (std::size_t i = run * kRun; i < std::min(pixels.size(), (run + 1) * kRun); ++i) {
                tracer.draw(view_, options_.samples, pixels[i], image_);
            }
        });
        TraceSums all;
        sums.combine_each([&](const TraceSums& sum) { all += sum; });
        count(all.counts);
        return all;
    }

    /// The cells and so many layers around them, through sides, in ascending order.
    [[nodiscard]] std::vector<Index> cells_around(std::vector<Index> cells, int layers) const {
        std::vector<std::uint8_t> chosen(mesh_.cells.size(), 0);
        for (const Index c : cells) chosen[c] = 1;
        for (std::size_t begin = 0; layers > 0; --layers) {
            const std::size_t end = cells.size();
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t side = 0; side < 6; ++side) {
                    const Index next = sides_.link(cells[i], side).cell;
                    if (next == kNone || chosen[next] != 0) continue;
                    chosen[next] = 1;
                    cells.push_back(next);
                }
            }
            begin = end;
        }
        std::ranges::sort(cells);
        cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
        return cells;
    }

    /// Finds the grids that are visible in the picture, and keeps them as long as they fit into memory. Adds them to those
    /// that were found before.
    ///
    /// cells: none: all
    void find_seen(std::optional<std::vector<Index>> cells) {
        std::mutex adding;
        std::atomic<bool> full = false;
        const auto inspect = [&](const DenseCell& cell) {
            Box box;
            for (const Vec3& p : cell.points) box.add(p);
            const auto [min, max] = std::ranges::minmax(cell.values[0]);
            const auto rect = clip_.has_slices() || visible(optics_, min, max) ? pixels_of(box, view_) : std::nullopt;
            std::optional<DenseGrid> grid;
            if (rect && !full) grid.emplace(cell, 0);
            const std::lock_guard lock(adding);
            report_.micro_cells += std::size_t{1} << (3 * refine_.levels);
            ++(rect ? report_.blocks : report_.skipped_blocks);
            if (!rect) return;
            seen_.push_back({cell.cell, *rect});
            if (full || !grid) return;
            most_bytes_ = std::max(most_bytes_, grid->bytes());
            if (kept_bytes_ + grid->bytes() <= options_.memory) return keep(std::move(*grid));
            full = true;
            drop();
        };
        for_each_dense_cell(mesh_, refine_, {.cells = std::move(cells), .on_limit = true}, inspect);
        std::sort(seen_.begin(), seen_.end(), [](const SeenGrid& a, const SeenGrid& b) { return a.cell < b.cell; });
    }

    void build(const std::vector<Index>& cells) {
        drop();
        std::mutex adding;
        for_each_dense_cell(mesh_, refine_, {.cells = cells, .on_limit = true}, [&](const DenseCell& cell) {
            DenseGrid grid(cell, 0);
            const std::lock_guard lock(adding);
            keep(std::move(grid));
        });
    }

    void keep(DenseGrid&& grid) {
        kept_bytes_ += grid.bytes();
        report_.bytes = std::max(report_.bytes, kept_bytes_);
        kept_.push_back(std::move(grid));
    }
    void drop() {
        kept_ = {};
        kept_bytes_ = 0;
    }
    void sort_kept() {
        std::sort(kept_.begin(), kept_.end(), [](const DenseGrid& a, const DenseGrid& b) { return a.cell() < b.cell(); });
    }

    void draw(const PixelRect& rect) {
        const DenseScene scene(kept_, sides_);
        tbb::combinable<TraceSums> sums;
        draw_in_tiles(view_, options_.samples, rect, image_, options_.progress,
                      [&] { return CountedTracer(scene, optics_, clip_, sums); });
        sums.combine_each([&](const TraceSums& sum) { count(sum.counts); });
    }
    void count(const TraceCounts& sum) {
        report_.rays += sum.rays;
        report_.segments += sum.segments;
        report_.lost_rays += sum.lost_rays;
    }

    const HexMesh& mesh_;
    const CellSides& sides_;
    const View& view_;
    const Optics& optics_;
    const DenseOptions& options_;
    RayClip clip_;
    RefineOptions refine_;
    std::vector<SeenGrid> seen_;
    std::vector<DenseGrid> kept_;
    std::size_t kept_bytes_ = 0, most_bytes_ = 0;
    Image image_;
    DenseReport report_;
};

}  // namespace

DenseResult render_dense(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                         const DenseOptions& options) {
    check(options);
    const HexMesh control = with_field_alone(mesh, field);
    validate(control);
    const CellSides sides(control.cells);
    const auto draw = [&](int levels) { return LevelPainter(control, sides, view, optics, options, levels).run(); };
    if (options.levels) return draw(*options.levels);
    if (!options.image_tolerance) {
        const Stopwatch watch;
        const DenseLevel found = find_dense_level(control, sides, options.refine, view, optics, options.max_levels);
        const double seconds = watch.seconds();
        DenseResult result = draw(found.level);
        result.report.error_px = found.error_px;
        result.report.error_color = found.error_color;
        result.report.converged = found.within;
        result.report.seconds_build += seconds;
        return result;
    }
    DenseResult result = draw(std::min(1, options.max_levels));
    while (!result.report.converged && result.report.levels < options.max_levels) {
        DenseResult next = draw(result.report.levels + 1);
        next.report.image_change = rms(next.image, result.image);
        next.report.converged = *next.report.image_change < *options.image_tolerance;
        next.report.seconds_build += result.report.seconds_build;
        next.report.seconds_draw += result.report.seconds_draw;
        result = std::move(next);
    }
    return result;
}

}  // namespace subvol
