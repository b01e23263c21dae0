#include "splat_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <string_view>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kChunks = 64;

// Squares of lengths, and their inverses, have to be normal floats.
constexpr double kLeastSize_world = 1e-12, kMostSize_world = 1e18;
constexpr double kLeastRange = 1e-30, kMostRange = 1e37;
constexpr double kRounding = 0x1p-24;  // of a 32-bit float, relative

double range_of(const PreintegratedTable& table) {
    return table.max > table.min ? table.max - table.min : 1;
}

bool finite(const PreintegratedTable& table) {
    const auto all = [](const auto& rows) {
        return std::all_of(rows.begin(), rows.end(), [](const auto& row) {
            return std::all_of(row.begin(), row.end(), [](float v) { return std::isfinite(v); });
        });
    };
    return all(table.prefixes) && all(table.points);
}

[[noreturn]] void refuse(std::string_view what, double amount, const char* allowed) {
    std::ostringstream message;
    message << what << amount << ", beyond what kernels hold in 32-bit floats";
    throw Error(ErrorCode::InvalidInput, message.str(), {}, allowed);
}

void check_floats(const RbfVolume& volume, const RbfChannel& channel, const PreintegratedTable& table) {
    const double size = volume.bounds.diagonal(), range = range_of(table);
    if (!(size >= kLeastSize_world && size <= kMostSize_world)) refuse("the volume's diagonal is ", size, "1e-12 to 1e18");
    if (!(range >= kLeastRange && range <= kMostRange)) refuse("the transfer function's range is ", range, "1e-30 to 1e37");
    for (const float v : channel.values) {
        const double value = static_cast<double>(v);
        if (!std::isfinite(value)) refuse("a value is ", value, "up to 3e38");
        const double rounding = std::abs(value) * kRounding;
        // Rounded to a tenth of the range and more, a field is noise.
        if (rounding > 0.1 * range && value + rounding >= table.min && value - rounding <= table.max) {
            refuse("beside a value of " + std::to_string(value) + " the transfer function's range is ", range,
                   "a wider range, or the field less its mean");
        }
    }
    if (!finite(table)) {
        throw Error(ErrorCode::InvalidInput, "the extinction is beyond 32-bit floats", {}, "a larger opacity unit");
    }
}

/// Half the Hessian of what a kernel stands for, its moment's part included.
Mat3 half_hessian(const RbfVolume& volume, const RbfChannel& channel, std::size_t i) {
    const auto& f = volume.frames[i];
    Mat3 half = static_cast<double>(channel.moments[i]) *
                glm::inverse(Mat3(Vec3(f[0], f[1], f[2]), Vec3(f[1], f[3], f[4]), Vec3(f[2], f[4], f[5])));
    if (channel.hessians.empty()) return half;
    const auto& h = channel.hessians[i];
    return half + 0.5 * Mat3(Vec3(h[0], h[1], h[2]), Vec3(h[1], h[3], h[4]), Vec3(h[2], h[4], h[5]));
}

EyeSplat to_eye(const RbfVolume& volume, const RbfChannel& channel, std::size_t i, const View& view,
                const PreintegratedTable& table) {
    const auto& axes = view.axes();
    const Mat3 to_world(axes[0], axes[1], axes[2]);  // columns: the eye's axes in the world
    const auto& f = volume.frames[i];
    const Mat3 world(Vec3(f[0], f[1], f[2]), Vec3(f[1], f[3], f[4]), Vec3(f[2], f[4], f[5]));
    const Mat3 s = glm::transpose(to_world) * world * to_world;
    const Vec3 center = view.to_eye(volume.centers[i]);
    const auto& gw = channel.gradients[i];
    const double scale = 1 / range_of(table);
    const Vec3 g = scale * (glm::transpose(to_world) * Vec3(gw[0], gw[1], gw[2]));

    const double szz = s[2][2], shear_x = s[2][0] / szz, shear_y = s[2][1] / szz;
    const double cxx = s[0][0] - s[2][0] * shear_x, cxy = s[0][1] - s[2][0] * shear_y, cyy = s[1][1] - s[2][1] * shear_y;
    const double det = cxx * cyy - cxy * cxy;
    EyeSplat splat{};
    splat.center_x = static_cast<float>(center.x);
    splat.center_y = static_cast<float>(center.y);
    splat.depth = static_cast<float>(center.z);
    splat.inv_szz = static_cast<float>(1 / szz);
    splat.shear_x = static_cast<float>(shear_x);
    splat.shear_y = static_cast<float>(shear_y);
    splat.conic_xx = static_cast<float>(cyy / det);
    splat.conic_xy = static_cast<float>(-cxy / det);
    splat.conic_yy = static_cast<float>(cxx / det);
    splat.value = static_cast<float>((static_cast<double>(channel.values[i]) - table.min) * scale);
    splat.gradient_x = static_cast<float>(g.x);
    splat.gradient_y = static_cast<float>(g.y);
    splat.value_slope = static_cast<float>(g.x * shear_x + g.y * shear_y + g.z);
    const Mat3 bend = scale * (glm::transpose(to_world) * half_hessian(volume, channel, i) * to_world);
    const Vec3 shear(shear_x, shear_y, 1), sheared = bend * shear;
    splat.bend_zz = static_cast<float>(glm::dot(shear, sheared));
    splat.bend_zx = static_cast<float>(2 * sheared.x);
    splat.bend_zy = static_cast<float>(2 * sheared.y);
    splat.bend_xx = static_cast<float>(bend[0][0]);
    splat.bend_xy = static_cast<float>(bend[0][1]);
    splat.bend_yy = static_cast<float>(bend[1][1]);
    splat.extent_x = static_cast<float>(std::sqrt(std::max(cxx, 0.0)));
    splat.extent_y = static_cast<float>(std::sqrt(std::max(cyy, 0.0)));
    return splat;
}

/// Calls visit(bin) for every bin that a kernel meets, batch by batch.
template <class Visit>
void for_each_bin(const SplatFrame& frame, const View& view, const EyeSplat& s, const Visit& visit) {
    const float reach = 1.0f / std::sqrt(s.inv_szz);
    const auto sheet = [&](float depth) { return (depth - frame.first_depth) / frame.sheet_distance; };
    const int first = std::max(0, static_cast<int>(std::ceil(std::max(sheet(s.depth - reach), 0.0f))));
    const int last = std::min(frame.sheets - 1, static_cast<int>(std::floor(std::min(sheet(s.depth + reach), 1e9f))));
    const auto pixel = static_cast<float>(view.pixel());
    const float mid_x = 0.5f * static_cast<float>(view.width()), mid_y = 0.5f * static_cast<float>(view.height());
    for (int k = first; k <= last;) {
        const int batch = k / SplatFrame::kBatch, end = std::min(last + 1, (batch + 1) * SplatFrame::kBatch);
        float x0 = std::numeric_limits<float>::max(), x1 = -x0, y0 = x0, y1 = -x0;
        for (; k < end; ++k) {
            const Section c = section(s, frame.depth(k), view.perspective());
            if (c.half_x < 0) continue;
            x0 = std::min(x0, c.x - c.half_x);
            x1 = std::max(x1, c.x + c.half_x);
            y0 = std::min(y0, c.y - c.half_y);
            y1 = std::max(y1, c.y + c.half_y);
        }
        if (x0 > x1) continue;
        // One pixel more on each side: rounding may not lose a kernel's rim.
        const auto tile = [&](float px, int most) {
            return static_cast<int>(std::clamp(px / static_cast<float>(frame.tile_px), -1.0f, static_cast<float>(most)));
        };
        const float left = mid_x + x0 / pixel - 1, right = mid_x + x1 / pixel + 1;
        const float top = mid_y - y1 / pixel - 1, bottom = mid_y - y0 / pixel + 1;
        if (right < 0 || bottom < 0 || left >= 2 * mid_x || top >= 2 * mid_y) continue;
        const int tx0 = std::max(0, tile(left, frame.tiles_x)), tx1 = std::min(frame.tiles_x - 1, tile(right, frame.tiles_x));
        const int ty0 = std::max(0, tile(top, frame.tiles_y)), ty1 = std::min(frame.tiles_y - 1, tile(bottom, frame.tiles_y));
        for (int ty = ty0; ty <= ty1; ++ty) {
            for (int tx = tx0; tx <= tx1; ++tx) {
                visit(frame.bin(ty * frame.tiles_x + tx, batch));
            }
        }
    }
}

/// A counting sort in fixed chunks: the order within a bin is that of the ids, whatever the number of threads.
void fill_bins(SplatFrame& frame, const View& view) {
    const auto bins = static_cast<std::size_t>(frame.tiles_x) * static_cast<std::size_t>(frame.tiles_y) *
                      static_cast<std::size_t>(frame.batches);
    const std::size_t count = frame.splats.size();
    const std::size_t chunks = std::clamp<std::size_t>((std::size_t{1} << 24) / std::max<std::size_t>(bins, 1), 1, kChunks);
    std::vector<std::uint32_t> next(bins * chunks);
    const auto each = [&](const auto& visit) {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
            for (std::size_t i = count * chunk / chunks; i < count * (chunk + 1) / chunks; ++i) {
                for_each_bin(frame, view, frame.splats[i], [&](std::size_t bin) { visit(i, next[bin * chunks + chunk], bin); });
            }
        });
    };
    each([](std::size_t, std::uint32_t& slot, std::size_t) { ++slot; });
    frame.bin_offsets.resize(bins + 1);
    std::uint64_t sum = 0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        frame.bin_offsets[bin] = static_cast<std::uint32_t>(sum);
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            const std::uint32_t here = next[bin * chunks + chunk];
            next[bin * chunks + chunk] = static_cast<std::uint32_t>(sum);
            sum += here;
        }
        if (sum > std::numeric_limits<std::uint32_t>::max()) {
            throw Error(ErrorCode::InvalidInput, "the kernels overlap too many tiles and sheets for one pass", {},
                        "fewer sheets, a smaller picture or fewer points");
        }
    }
    frame.bin_offsets[bins] = static_cast<std::uint32_t>(sum);
    frame.bin_splats.resize(sum);
    each([&](std::size_t i, std::uint32_t& slot, std::size_t) { frame.bin_splats[slot++] = static_cast<std::uint32_t>(i); });
}

}  // namespace

SplatFrame prepare_splats(const RbfVolume& volume, const View& view, const PreintegratedTable& table,
                          const SplatOptions& options, int tile_px) {
    if (options.sheets < 2 || options.sheets > 65536) {
        throw Error(ErrorCode::InvalidInput, "the number of sheets is " + std::to_string(options.sheets), {}, "2 to 65536");
    }
    if (options.channel >= volume.channels.size()) {
        throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(options.channel), {},
                    "the volume has " + std::to_string(volume.channels.size()));
    }
    if (volume.boundary.triangles.empty()) {
        throw Error(ErrorCode::InvalidInput, "the points have no boundary surface to be clipped against");
    }
    if (!std::holds_alternative<CompactKernel>(volume.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the splatter draws compact kernels only, these points have others");
    }
    const auto& channel = volume.channels[options.channel];
    check_floats(volume, channel, table);
    report_progress(options.progress, "prepare splats", 0);
    SplatFrame frame;
    frame.tile_px = tile_px;
    frame.tiles_x = (view.width() + tile_px - 1) / tile_px;
    frame.tiles_y = (view.height() + tile_px - 1) / tile_px;
    frame.sheets = options.sheets;
    frame.batches = (options.sheets + SplatFrame::kBatch - 1) / SplatFrame::kBatch;

    double z_min = std::numeric_limits<double>::infinity(), z_max = -z_min;
    for (const auto& p : volume.boundary.points) {
        const double z = view.to_eye(p).z;
        z_min = std::min(z_min, z);
        z_max = std::max(z_max, z);
    }
    const double near = view.perspective() ? 1e-4 * volume.bounds.diagonal() : 0.0;
    z_min = std::max(z_min, near);
    z_max = std::max(z_max, z_min + near + std::numeric_limits<double>::min());  // all behind the eye: an empty picture
    frame.first_depth = static_cast<float>(z_min);
    frame.sheet_distance = static_cast<float>((z_max - z_min) / (options.sheets - 1));

    frame.intervals = boundary_intervals(volume.boundary, view, near);
    report_progress(options.progress, "prepare splats", 0.4);
    frame.splats.resize(volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(),
                      [&](std::size_t i) { frame.splats[i] = to_eye(volume, channel, i, view, table); });
    report_progress(options.progress, "prepare splats", 0.6);
    fill_bins(frame, view);
    report_progress(options.progress, "prepare splats", 1);
    return frame;
}

PreintegratedTable over_unit_range(PreintegratedTable table) {
    const double scale = 1 / range_of(table);
    for (auto& row : table.prefixes) {
        for (float& v : row) v = static_cast<float>(static_cast<double>(v) * scale);
    }
    table.min = 0;
    table.max = 1;
    return table;
}

}  // namespace subvol::detail
