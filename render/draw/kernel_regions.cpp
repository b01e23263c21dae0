// SPDX-License-Identifier: Apache-2.0
#include "kernel_regions.h"

#include <fcntl.h>
#include <tbb/parallel_sort.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <system_error>

#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr int kMostAcross = 16;            // regions: files, each of which is opened once
constexpr int kTile_px = 32;               // of the splatter: a tile lies in one region
constexpr double kMargin_px = 3;           // more than the splatter adds for rounding
constexpr std::size_t kWaiting = 1 << 16;  // bytes before they are written

/// What a file has of a kernel, apart from its Hessian.
struct Record {
    std::uint64_t number;
    std::array<double, 3> center;
    Symmetric3 frame;
    std::array<float, 3> gradient;
    float value, moment;
    float unused = 0;
};
static_assert(sizeof(Record) == 80);

struct BentRecord {
    Record record;
    Symmetric3 hessian;
};

}  // namespace

KernelRegions::KernelRegions(const View& view, const PixelRows& rows, double nearest, double widening,
                             std::filesystem::path scratch)
    : view_(view), rows_(rows), nearest_(nearest), widening_(widening), scratch_(std::move(scratch)) {
    std::error_code error;
    if (scratch_.empty()) scratch_ = std::filesystem::temp_directory_path(error);
    if (error) {
        errno = error.value();
        fail();
    }
    const int longest = std::max(view.width(), view.height());
    side_ = std::max(1, (longest + kMostAcross * kTile_px - 1) / (kMostAcross * kTile_px)) * kTile_px;
    across_ = (view.width() + side_ - 1) / side_;
    down_ = (view.height() + side_ - 1) / side_;
    const auto count = static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
    waiting_.resize(count);
    counts_.assign(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
        std::string name = (scratch_ / "subvol_kernels_XXXXXX").string();
        const int file = ::mkostemp(name.data(), O_CLOEXEC);
        if (file < 0) fail();
        ::unlink(name.c_str());
        files_.emplace_back(::fdopen(file, "w+b"));
        if (!files_.back()) fail();
    }
}

KernelRegions::Region KernelRegions::region(std::size_t k) const {
    const int x = static_cast<int>(k) % across_ * side_, y = static_cast<int>(k) / across_ * side_;
    return {x, y, std::min(x + side_, view_.width()), std::min(y + side_, view_.height())};
}

bool KernelRegions::is_drawn(std::size_t k) const {
    const Region pixels = region(k);
    return pixels.y0 < rows_.end && pixels.y1 > rows_.first;
}

/// The box around a kernel on the picture, with a margin.
KernelRegions::PixelBox KernelRegions::pixels_of(const RbfVolume& kernels, std::size_t i) const {
    const Mat3 s = widening_ * matrix(kernels.frames[i]);
    const Vec3 center = view_.to_eye(kernels.centers[i]);
    Vec3 half;
    for (int d = 0; d < 3; ++d) {
        const Vec3& axis = view_.axes()[static_cast<std::size_t>(d)];
        half[d] = 1.001 * std::sqrt(std::max(0.0, glm::dot(axis, s * axis)));
    }
    if (view_.perspective() && center.z - half.z <= nearest_) return {-HUGE_VAL, -HUGE_VAL, HUGE_VAL, HUGE_VAL};
    PixelBox box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 8; ++k) {
        const Vec3 corner = center + Vec3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
        const Vec2 px = view_.to_pixels(corner);
        box = {std::min(box.left, px.x), std::min(box.top, px.y), std::max(box.right, px.x), std::max(box.bottom, px.y)};
    }
    return {box.left - kMargin_px, box.top - kMargin_px, box.right + kMargin_px, box.bottom + kMargin_px};
}

/// The regions that are drawn and that the box touches: from x0, y0 to before x1, y1.
KernelRegions::Region KernelRegions::regions_of(const RbfVolume& kernels, std::size_t i) const {
    const PixelBox box = pixels_of(kernels, i);
    const auto region = [&](double px, int most) {
        return static_cast<int>(std::clamp(std::floor(px / side_), -1.0, static_cast<double>(most)));
    };
    const int first = std::max(0, rows_.first / side_), end = std::min(down_, (rows_.end + side_ - 1) / side_);
    return {std::max(0, region(box.left, across_)), std::max(first, region(box.top, down_)),
            std::min(across_, region(box.right, across_) + 1), std::min(end, region(box.bottom, down_) + 1)};
}

std::vector<PixelRows> KernelRegions::rows_of(const RbfVolume& kernels) const {
    std::vector<PixelRows> rows(kernels.size());
    const auto row = [&](double px) {
        return static_cast<int>(std::clamp(std::floor(px), -1.0, static_cast<double>(view_.height())));
    };
    parallel_each(rows.size(), [&](std::size_t i) {
        const PixelBox box = pixels_of(kernels, i);
        rows[i] = {std::max(0, row(box.top)), std::min(view_.height(), row(box.bottom) + 1)};
    });
    return rows;
}

void KernelRegions::add(const RbfVolume& kernels, std::span<const std::uint64_t> numbers) {
    const RbfChannel& channel = kernels.channels.front();
    bent_ = !channel.hessians.empty();
    std::vector<Region> rows(kernels.size());
    parallel_each(rows.size(), [&](std::size_t i) { rows[i] = regions_of(kernels, i); });
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Vec3& c = kernels.centers[i];
        BentRecord kernel{
            {numbers[i], {c.x, c.y, c.z}, kernels.frames[i], channel.gradients[i], channel.values[i], channel.moments[i]}, {}};
        if (bent_) kernel.hessian = channel.hessians[i];
        const auto* bytes = reinterpret_cast<const char*>(&kernel);
        for (int y = rows[i].y0; y < rows[i].y1; ++y) {
            for (int x = rows[i].x0; x < rows[i].x1; ++x) {
                const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x);
                waiting_[k].insert(waiting_[k].end(), bytes, bytes + (bent_ ? sizeof kernel : sizeof kernel.record));
                ++counts_[k];
                if (waiting_[k].size() >= kWaiting) flush(k);
            }
        }
    }
}

void KernelRegions::flush(std::size_t k) {
    if (waiting_[k].empty()) return;
    if (std::fwrite(waiting_[k].data(), 1, waiting_[k].size(), files_[k].get()) != waiting_[k].size()) fail();
    waiting_[k].clear();
}

void KernelRegions::fail() const {
    throw Error(ErrorCode::Io, "kernels cannot be written: " + std::generic_category().message(errno), scratch_.string(),
                "TMPDIR names the folder for temporary files");
}

void KernelRegions::take(std::span<const std::size_t> regions, RbfVolume& into) {
    const std::size_t bytes = bent_ ? sizeof(BentRecord) : sizeof(Record);
    std::size_t count = 0;
    for (const std::size_t k : regions) count += counts_[k];
    std::vector<char> rows(count * bytes);
    std::size_t at = 0;
    for (const std::size_t k : regions) {
        flush(k);
        if (std::fflush(files_[k].get()) != 0) fail();
        std::rewind(files_[k].get());
        const std::size_t size = counts_[k] * bytes;
        if (size > 0 && std::fread(rows.data() + at, 1, size, files_[k].get()) != size) fail();
        at += size;
        files_[k].reset();  // gives the room on the disk back
    }
    struct RowPlace {
        std::uint64_t number;
        std::size_t row;
    };
    std::vector<RowPlace> order(count);
    parallel_each(count, [&](std::size_t i) {
        order[i].row = i;
        std::memcpy(&order[i].number, &rows[i * bytes], sizeof order[i].number);
    });
    tbb::parallel_sort(order.begin(), order.end(), [](const RowPlace& a, const RowPlace& b) {
        return a.number != b.number ? a.number < b.number : a.row < b.row;
    });
    order.erase(
        std::unique(order.begin(), order.end(), [](const RowPlace& a, const RowPlace& b) { return a.number == b.number; }),
        order.end());
    const std::size_t kept = order.size();
    RbfChannel& channel = into.channels.front();
    into.centers.resize(kept);
    into.frames.resize(kept);
    channel.values.resize(kept);
    channel.gradients.resize(kept);
    channel.moments.resize(kept);
    channel.hessians.resize(bent_ ? kept : 0);
    parallel_each(kept, [&](std::size_t i) {
        BentRecord kernel{};
        std::memcpy(&kernel, &rows[order[i].row * bytes], bytes);
        const auto& c = kernel.record.center;
        into.centers[i] = {c[0], c[1], c[2]};
        into.frames[i] = kernel.record.frame;
        channel.values[i] = kernel.record.value;
        channel.gradients[i] = kernel.record.gradient;
        channel.moments[i] = kernel.record.moment;
        if (bent_) channel.hessians[i] = kernel.hessian;
    });
}

}  // namespace subvol::detail
