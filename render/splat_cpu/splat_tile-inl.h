// SPDX-License-Identifier: Apache-2.0
// Draws one tile of the picture: the method of sheet buffers [mnmq2007, westover1990, mc1998], cut up so that sums stay in
// cache.
//
// The volume is cut by planes of constant eye depth, the sheets. On each sheet the field is the normalised sum over the kernels
// that it cuts, x = Σ w·v / Σ w. Between two sheets the field is taken to be linear along the ray, so the light of a stretch
// follows from its two values and a table of integrals of the transfer function (pre-integration [rke2000]):
//
//     eye -> | batch 0 | batch 1 | ...     For each batch of kBatch sheets, front to back:
//            |.|.|.|.|.|.|.|.|.|.|           sum        add the tile's kernels to Σw and Σwv of its pixels and sheets
//            sheets                          composite  walk each block of pixels through the sheets: classify, blend
//
// A batch is passed over if no ray is inside the volume there, or if bounds of its kernels' values show that all of it is
// invisible. A block is one vector of pixels, as square as possible. kPlain selects the short loops for volumes without
// Hessians, second channel or light. docs/adr/0011 gives the reasons. Included once for every instruction set: see
// splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_TILE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_TILE_INL_H
#undef SUBVOL_SPLAT_TILE_INL_H
#else
#define SUBVOL_SPLAT_TILE_INL_H
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "splat_composite-inl.h"
#include "splat_general-inl.h"
#include "subvol/raster.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

template <bool kPlain>
class TileRenderer {
public:
    explicit TileRenderer(const SplatFrame& frame)
        : frame_(frame), view_(*frame.view), sheets_(frame.sheets), classifier_(*frame.classification), general_(frame) {
        scratch().resize();
        x_offset_ = value_offset(*frame.scene, *frame.classification);
        color_offset_ = color_offset(*frame.scene, *frame.classification);
        batch_.mid_x = 0.5f * static_cast<float>(view_.width());
        batch_.mid_y = 0.5f * static_cast<float>(view_.height());
        least_gradient_ = kLeastChange * PreintegratedTable::kCells / static_cast<float>(frame.scene->diagonal);
    }

    HWY_ATTR void draw(int tile, Drawn& drawn) {
        x0_ = tile % frame_.tiles_x * SplatFrame::kTile_px;
        y0_ = tile / frame_.tiles_x * SplatFrame::kTile_px;
        tile_id_ = static_cast<std::size_t>(tile);
        place_pixels(view_, x0_, y0_, tile_);
        if (!start_blocks()) return;
        if (done()) return write(drawn);
        list_batches(tile);
        bool passed_over = false;  // whether the batch before was needed but invisible
        for (int batch = 0; batch < sheets_.batches() && !done(); ++batch) {
            if (!scratch().wanted[static_cast<std::size_t>(batch)]) continue;
            if (invisible(batch)) {
                passed_over = true;
                continue;
            }
            if (passed_over) look_back(batch - 1);
            passed_over = false;
            if (find_needed(batch)) go_through(batch);
        }
        write(drawn);
    }

private:
    static constexpr std::size_t kStride = kPlain ? 2 : kSums;  // sums for each pixel
    // The cells of FinerSheets along a side of a tile, and the blocks of each.
    static constexpr std::size_t kCells = kTile / FinerSheets::kSide_px, kCellRows = kRows / kCells,
                                 kCellColumns = kColumns / kCells;

    /// Memory that each thread keeps from tile to tile.
    struct Scratch {
        std::vector<float> sums_storage;
        float* sums = nullptr;
        hwy::AlignedFreeUniquePtr<BlockState[]> blocks;
        std::vector<std::size_t> offsets;
        std::vector<std::uint32_t> splats;
        std::vector<std::size_t> part_offsets;  // of a batch that has more sheets
        std::vector<std::uint32_t> part_splats;
        std::vector<std::uint8_t> wanted;
        // One bit for each sheet of a batch on which a block is needed: of all batches and blocks, as far as intervals of rays
        // are there; and of the blocks of one batch, less those whose rays are done.
        std::vector<std::uint8_t> sheets;
        std::array<std::uint8_t, kBlocks> of_stack, needed;

        void resize() {
            if (blocks) return;
            sums_storage.resize(kBatch * kBlocks * kSums * kBlock + 64);
            blocks = hwy::AllocateAligned<BlockState>(kBlocks);
            if (!blocks) throw std::bad_alloc();
            const auto address = reinterpret_cast<std::uintptr_t>(sums_storage.data());
            sums = sums_storage.data() + ((64 - address % 64) % 64) / sizeof(float);
        }
    };
    static Scratch& scratch() {
        thread_local Scratch memory;
        return memory;
    }

    /// Returns whether the ray of any pixel of the tile meets the volume.
    HWY_ATTR bool start_blocks() {
        if (!frame_.meets_intervals(x0_, y0_)) return false;
        bool any = false;
        const std::size_t batches = static_cast<std::size_t>(sheets_.batches());
        scratch().wanted.assign(batches, 0);
        scratch().sheets.assign(batches * kBlocks, frame_.intervals.offsets.empty() ? 0xff : 0);
        for (std::size_t block = 0; block < kBlocks; ++block) {
            BlockState& b = scratch().blocks[block];
            for (float* zero : {b.opacity, b.red, b.green, b.blue, b.depth, b.value, b.known}) std::fill_n(zero, kBlock, 0.0f);
            if constexpr (!kPlain) {
                for (float* zero : {b.weight, b.color, b.diffuse, b.specular, b.enter_color, b.exit_color, b.enter_diffuse,
                                    b.exit_diffuse, b.enter_specular, b.exit_specular}) {
                    std::fill_n(zero, kBlock, 0.0f);
                }
            }
            std::fill_n(b.enter_x, kBlock, kUnknownValue);
            std::fill_n(b.exit_x, kBlock, kUnknownValue);
            marked_ = {1, 0};
            for (std::size_t lane = 0; lane < kBlock; ++lane) any |= start_pixel(b, block, lane);
        }
        for (std::size_t i = 0; i < batches * kBlocks; ++i) scratch().wanted[i / kBlocks] |= scratch().sheets[i];
        return any;
    }

    bool start_pixel(BlockState& b, std::size_t block, std::size_t lane) {
        const float sx = tile_.x[block % kColumns * kBlock + lane], sy = tile_.y[block / kColumns * kBlock + lane];
        b.ray_length[lane] = view_.perspective() ? std::sqrt(1 + sx * sx + sy * sy) : 1.0f;
        b.enter[lane] = b.exit[lane] = kNever;
        const auto [x, y] = pixel(block, lane);
        if (x >= view_.width() || y >= view_.height()) return false;
        if (frame_.intervals.offsets.empty()) {
            b.enter[lane] = sheets_.near;
            return true;
        }
        const auto id = pixel_index(view_.width(), x, y);
        const std::size_t first = frame_.intervals.offsets[id], end = frame_.intervals.offsets[id + 1];
        b.interval[lane] = static_cast<std::uint32_t>(first);
        b.intervals_end[lane] = static_cast<std::uint32_t>(end);
        take_interval<kPlain>(frame_, b, lane);
        if (b.enter[lane] == kNever) return b.opacity[lane] == 1;
        for (std::size_t i = first; i < end; ++i)
            mark(block, frame_.intervals.depths[2 * i], frame_.intervals.depths[2 * i + 1]);
        return true;
    }

    /// Marks the sheets that a block needs for a ray that is inside the volume between two depths: those between them, and the
    /// next one on either side.
    void mark(std::size_t block, float enter, float exit) {
        const auto sheet = [&](float z, float more) {
            return static_cast<std::size_t>(
                std::clamp((z - sheets_.first) / sheets_.distance + more, 0.0f, static_cast<float>(sheets_.count - 1)));
        };
        const std::size_t first = sheet(enter, -1.01f), last = sheet(exit, 1.01f);
        if (first >= marked_.first && last <= marked_.second) return;
        marked_ = {first, last};
        for (std::size_t b = first / kBatch; b <= last / kBatch; ++b) {
            const std::size_t from = std::max(first, b * kBatch) % kBatch,
                              to = std::min(last, b * kBatch + kBatch - 1) % kBatch;
            scratch().sheets[b * kBlocks + block] |= static_cast<std::uint8_t>((2u << to) - (1u << from));
        }
    }

    [[nodiscard]] std::pair<int, int> pixel(std::size_t block, std::size_t lane) const {
        return {x0_ + static_cast<int>(block % kColumns * kBlockWidth + lane % kBlockWidth),
                y0_ + static_cast<int>(block / kColumns * kBlockHeight + lane / kBlockWidth)};
    }

    /// Lists the tile's kernels by batches; within a batch they keep their order.
    void list_batches(int tile) {
        const auto& wanted = scratch().wanted;
        const auto begin =
            frame_.tile_splats.begin() + static_cast<std::ptrdiff_t>(frame_.tile_offsets[static_cast<std::size_t>(tile)]);
        const auto end =
            frame_.tile_splats.begin() + static_cast<std::ptrdiff_t>(frame_.tile_offsets[static_cast<std::size_t>(tile) + 1]);
        list_by(static_cast<std::size_t>(sheets_.batches()), std::span(begin, end), scratch().offsets, scratch().splats,
                [&](std::uint32_t id, const auto& visit) {
                    const auto [first, last] = frame_.batches[id];
                    for (std::size_t b = first; b <= last; ++b) {
                        if (wanted[b]) visit(b);
                    }
                });
    }

    [[nodiscard]] bool done() const {
        for (std::size_t block = 0; block < kBlocks; ++block) {
            const BlockState& b = scratch().blocks[block];
            for (std::size_t lane = 0; lane < kBlock; ++lane) {
                if (b.enter[lane] != kNever) return false;
            }
        }
        return true;
    }

    /// Whether all values between the sheets of a batch, and between it and the sheet before, are invisible.
    [[nodiscard]] bool invisible(int batch) const {
        const auto& ranges = frame_.kernels.ranges;
        if (ranges.empty() || classifier_.all_visible() || frame_.scene->clip.has_slices()) return false;
        EyeRange range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
        const auto& offsets = scratch().offsets;
        const auto& splats = scratch().splats;
        const auto b = static_cast<std::size_t>(batch);
        for (std::size_t i = offsets[b > 0 ? b - 1 : b]; i < offsets[b + 1]; ++i) {
            range.low = std::min(range.low, ranges[splats[i]].low);
            range.high = std::max(range.high, ranges[splats[i]].high);
        }
        return range.low > range.high || classifier_.transparent(range.low, range.high);
    }

    /// Finds the sheets of a batch that its blocks need: none if all rays are done or enter the volume later. Returns whether
    /// there are any.
    HWY_ATTR bool find_needed(int batch) {
        const Lanes d;
        const int last = std::min(batch * kBatch + kBatch, sheets_.count) - 1;
        const auto limit = hn::Set(d, sheets_.depth(last) + 1.5f * sheets_.distance);
        auto& needed = scratch().of_stack;
        std::uint32_t any = 0;
        for (std::size_t block = 0; block < kBlocks; ++block) {
            const bool reached = !hn::AllFalse(d, hn::Lt(hn::Load(d, scratch().blocks[block].enter), limit));
            needed[block] = reached ? scratch().sheets[static_cast<std::size_t>(batch) * kBlocks + block] : std::uint8_t{0};
            any |= needed[block];
        }
        return any != 0;
    }

    /// Sums and composites a batch with as many sheets in place of each as its finest block needs, kBatch of them at a time.
    HWY_ATTR void go_through(int batch) {
        find_levels(batch);
        const int sheets = std::min(kBatch, sheets_.count - batch * kBatch) << level_;
        if (level_ > 0) list_parts(batch);
        for (int first = 0; first < sheets; first += kBatch) {
            place_sheets(batch, first);
            if (!choose_blocks(first)) continue;
            KeptValues* const kept = kept_of(batch);
            batch_.begin = 0;
            batch_.end = std::min(kBatch, sheets - first);
            kept_ = nullptr;
            if (kept == nullptr || !has_needed(*kept)) {
                sum(level_ > 0 ? kernels_of_part(first / kBatch) : kernels_of(batch));
                if (kept != nullptr) keep(*kept);
            }
            kept_ = kept;
            for (std::size_t block = 0; block < kBlocks; ++block) {
                if (scratch().needed[block] != 0) composite(block, batch);
            }
        }
    }

    /// Where the values of a batch are kept; null: nowhere.
    [[nodiscard]] KeptValues* kept_of(int batch) const {
        if (!kPlain || frame_.kept.empty() || level_ > 0) return nullptr;
        return &frame_.kept[tile_id_ * static_cast<std::size_t>(sheets_.batches()) + static_cast<std::size_t>(batch)];
    }
    [[nodiscard]] static bool has_needed(const KeptValues& kept) {
        if (kept.sheets.empty()) return false;
        const auto& needed = scratch().needed;
        for (std::size_t block = 0; block < kBlocks; ++block) {
            if ((needed[block] & ~kept.sheets[block]) != 0) return false;
        }
        return true;
    }

    /// Keeps the values of the sheets that blocks need.
    HWY_ATTR void keep(KeptValues& kept) {
        const Lanes d;
        const auto& needed = scratch().needed;
        kept.sheets.clear();
        kept.first.resize(kBlocks);
        std::uint32_t size = 0;
        for (std::size_t block = 0; block < kBlocks; ++block) {
            kept.first[block] = size;
            size += static_cast<std::uint32_t>(static_cast<std::size_t>(std::popcount(needed[block])) * kBlock);
        }
        kept.x.resize(size);
        for (std::size_t block = 0; block < kBlocks; ++block) {
            float* to = kept.x.data() + kept.first[block];
            for (std::uint32_t bits = needed[block]; bits != 0; bits &= bits - 1, to += kBlock) {
                const SheetValues sheet = values(block, std::countr_zero(bits));
                hn::StoreU(hn::IfThenElse(sheet.known, sheet.x, hn::NaN(d)), d, to);
            }
        }
        kept.sheets.assign(needed.begin(), needed.end());  // last, so that an error leaves nothing half kept
    }
    [[nodiscard]] HWY_ATTR SheetValues kept_values(std::size_t block, int k) const {
        const Lanes d;
        const auto before = static_cast<std::uint8_t>(kept_->sheets[block] & ((1u << k) - 1));
        const auto x =
            hn::LoadU(d, kept_->x.data() + kept_->first[block] + static_cast<std::size_t>(std::popcount(before)) * kBlock);
        const auto known = hn::Eq(x, x);
        const auto zero = hn::Zero(d);
        return {hn::IfThenElseZero(known, x), known, zero, zero, {zero, zero}};
    }

    [[nodiscard]] static std::span<const std::uint32_t> kernels_of(int batch) {
        const auto& offsets = scratch().offsets;
        const auto b = static_cast<std::size_t>(batch);
        return std::span(scratch().splats).subspan(offsets[b], offsets[b + 1] - offsets[b]);
    }
    [[nodiscard]] static std::span<const std::uint32_t> kernels_of_part(int part) {
        const auto& offsets = scratch().part_offsets;
        const auto p = static_cast<std::size_t>(part);
        return std::span(scratch().part_splats).subspan(offsets[p], offsets[p + 1] - offsets[p]);
    }

    /// Lists a batch's kernels by parts, of kBatch sheets each; within a part they keep their order.
    void list_parts(int batch) {
        const auto parts = std::size_t{1} << level_;
        const float first = sheets_.depth(batch * kBatch - 1),
                    per_part = static_cast<float>(parts) / (kBatch * sheets_.distance);
        // A little more on each side, so that rounding does not lose a kernel.
        constexpr float kMore = 1e-2f;
        const auto part_of = [&](float z) {
            return static_cast<std::size_t>(std::clamp((z - first) * per_part, 0.0f, static_cast<float>(parts - 1)));
        };
        list_by(parts, kernels_of(batch), scratch().part_offsets, scratch().part_splats,
                [&](std::uint32_t id, const auto& visit) {
                    const EyeSplat& s = frame_.kernels.splats[id];
                    const float reach = 1.0f / std::sqrt(s.inv_szz) + kMore / per_part;
                    for (std::size_t p = part_of(s.depth - reach); p <= part_of(s.depth + reach); ++p) visit(p);
                });
    }

    /// Finds the levels of a batch's cells, and the most of them.
    void find_levels(int batch) {
        static_assert(FinerSheets::kSheets == kBatch);
        level_ = 0;
        if (!frame_.finer.any()) return;
        for (std::size_t cell = 0; cell < kCells * kCells; ++cell) {
            constexpr int kSide = FinerSheets::kSide_px;
            const int x = x0_ + static_cast<int>(cell % kCells) * kSide, y = y0_ + static_cast<int>(cell / kCells) * kSide;
            levels_[cell] = frame_.finer.level(x, y, batch * kBatch);
            if (levels_[cell] > 0) levels_[cell] = level_in_light(levels_[cell], light_left(cell));
            level_ = std::max(level_, levels_[cell]);
        }
    }

    /// The most light that is left of any ray in a cell that is not done.
    [[nodiscard]] float light_left(std::size_t cell) const {
        float most = 0;
        for (std::size_t i = 0; i < kCellRows * kCellColumns; ++i) {
            const std::size_t row = cell / kCells * kCellRows + i / kCellColumns;
            const BlockState& b = scratch().blocks[row * kColumns + cell % kCells * kCellColumns + i % kCellColumns];
            for (std::size_t lane = 0; lane < kBlock; ++lane) {
                if (b.enter[lane] != kNever) most = std::max(most, 1 - b.opacity[lane]);
            }
        }
        return most;
    }
    [[nodiscard]] int level_of(std::size_t block) const {
        return level_ == 0 ? 0 : levels_[block / kColumns / kCellRows * kCells + block % kColumns / kCellColumns];
    }

    /// Places the sheets that are summed next: the first-th and those behind it, with 2^level_ in place of each of a batch.
    void place_sheets(int batch, int first) {
        step_ = 1.0f / static_cast<float>(1 << level_);
        before_ = static_cast<float>(batch * kBatch - 1) + static_cast<float>(first) * step_;
    }
    /// The place in the stack of the k-th of these sheets.
    [[nodiscard]] float place_of(int k) const { return before_ + static_cast<float>(k + 1) * step_; }

    /// Finds which of these sheets each block needs: those of its level in place of a sheet that it needs. Returns whether any
    /// block needs one.
    bool choose_blocks(int first) {
        const auto& of_stack = scratch().of_stack;
        auto& needed = scratch().needed;
        if (level_ == 0) {
            needed = of_stack;
        } else {
            needed.fill(0);
            for (std::size_t block = 0; block < kBlocks; ++block) {
                const int stride = 1 << (level_ - level_of(block));
                for (int k = (stride - 1) & (stride - 1 - first); k < kBatch; k += stride) {
                    if ((of_stack[block] >> ((first + k) >> level_) & 1) != 0 && place_of(k) >= 0)
                        needed[block] |= static_cast<std::uint8_t>(1u << k);
                }
            }
        }
        for (std::size_t row = 0; row < kRows; ++row) batch_.need(row, needed.data() + row * kColumns);
        return std::ranges::any_of(needed, [](std::uint8_t sheets) { return sheets != 0; });
    }

    /// Takes the values of the last sheet of a batch that was passed over.
    HWY_ATTR void look_back(int batch) {
        batch_.need_all();
        level_ = 0;
        place_sheets(batch, 0);
        batch_.begin = kBatch - 1;
        batch_.end = kBatch;
        kept_ = nullptr;
        sum(kernels_of(batch));
        for (std::size_t block = 0; block < kBlocks; ++block) {
            BlockWalk<kPlain> walk(frame_, classifier_, scratch().blocks[block]);
            walk.skip_to(values(block, kBatch - 1));
            walk.store();
        }
    }

    /// Sums kernels on the placed sheets of the batch.
    HWY_ATTR void sum(std::span<const std::uint32_t> kernels) {
        for (int k = 0; k < kBatch; ++k) {
            const auto i = static_cast<std::size_t>(k);
            batch_.depth[i] = sheets_.depth(place_of(k));
            batch_.across[i] = view_.perspective() ? sheets_.middle + batch_.depth[i] : 1.0f;
            batch_.to_pixels[i] = 1.0f / (batch_.across[i] * static_cast<float>(view_.pixel()));
        }
        float* sums = scratch().sums;
        for (int k = batch_.begin; k < batch_.end; ++k) {
            for (std::size_t row = 0; row < kRows; ++row) {
                if (batch_.first_column[k][row] > batch_.last_column[k][row]) continue;
                const auto first = static_cast<std::size_t>(batch_.first_column[k][row]);
                const auto count = static_cast<std::size_t>(batch_.last_column[k][row]) + 1 - first;
                float* to = sums + ((static_cast<std::size_t>(k) * kRows + row) * kColumns + first) * (kStride * kBlock);
                std::fill_n(to, count * kStride * kBlock, 0.0f);
            }
        }
        for (const std::uint32_t id : kernels) {
            if constexpr (kPlain) {
                add_plain(frame_.kernels.splats[id], batch_, tile_, cuts_, sums);
            } else {
                general_.add(id, batch_, tile_, cuts_, sums);
            }
        }
    }

    HWY_ATTR void composite(std::size_t block, int batch) {
        BlockWalk<kPlain> walk(frame_, classifier_, scratch().blocks[block]);
        const float step = 1.0f / static_cast<float>(1 << level_of(block));
        for (int k = 0; k < batch_.end; ++k) {
            if ((scratch().needed[block] >> k & 1) == 0) continue;
            const SheetValues at_sheet = values(block, k);
            if (place_of(k) > 0) {
                walk.go(sheets_.depth(place_of(k) - step), sheets_.depth(place_of(k)), at_sheet);
            } else {
                walk.skip_to(at_sheet);
            }
            if (frame_.optical_depths) keep_depths(block, batch * kBatch + k, walk.optical_depth());
        }
        walk.store();
    }

    HWY_ATTR void keep_depths(std::size_t block, int sheet, Floats depths) const {
        const Lanes d;
        HWY_ALIGN float kept[kBlock];
        hn::Store(depths, d, kept);
        const auto width = static_cast<std::size_t>(view_.width()), height = static_cast<std::size_t>(view_.height());
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const auto [x, y] = pixel(block, lane);
            if (x >= view_.width() || y >= view_.height()) continue;
            const std::size_t row = static_cast<std::size_t>(sheet) * height + static_cast<std::size_t>(y);
            frame_.optical_depths[row * width + static_cast<std::size_t>(x)] = kept[lane];
        }
    }

    HWY_ATTR SheetValues values(std::size_t block, int k) const {
        if (kPlain && kept_ != nullptr) return kept_values(block, k);
        const Lanes d;
        const float* sums = scratch().sums + (static_cast<std::size_t>(k) * kBlocks + block) * (kStride * kBlock);
        SheetValues result;
        result.weight = hn::Load(d, sums);
        result.color = result.light.diffuse = result.light.specular = hn::Zero(d);
        const bool normalized = kPlain || frame_.scene->normalized;
        result.known = normalized ? hn::Gt(result.weight, hn::Set(d, static_cast<float>(kLeastWeight)))
                                  : hn::Eq(result.weight, result.weight);
        const auto per_weight = hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(result.known, result.weight, hn::Set(d, 1.0f)));
        const auto mean = [&](std::size_t which, float offset) HWY_ATTR {
            const auto total = hn::Load(d, sums + which * kBlock);
            if (!normalized) return hn::Add(total, hn::Set(d, offset));
            return hn::IfThenElseZero(result.known, hn::Div(total, result.weight));
        };
        const auto far = hn::Set(d, kFarCells);
        result.x = hn::Min(hn::Max(mean(kValue, x_offset_), hn::Neg(far)), far);
        if constexpr (!kPlain) {
            if (frame_.scene->color_channel) result.color = hn::Min(hn::Max(mean(kColor, color_offset_), hn::Neg(far)), far);
            result.light = light_on(block, sums, per_weight, batch_.across[static_cast<std::size_t>(k)],
                                    batch_.depth[static_cast<std::size_t>(k)]);
        }
        return result;
    }

    HWY_ATTR Light light_on(std::size_t block, const float* sums, Floats per_weight, float across, float depth) const {
        const Lanes d;
        const auto one = hn::Set(d, 1.0f);
        Arrival arrives{one, one};
        if (frame_.scene->light) {
            const auto scale = hn::Set(d, across);
            arrives = arrival_at(*frame_.scene->light, frame_.to_light,
                                 {hn::Mul(scale, hn::Load(d, tile_.x + block % kColumns * kBlock)),
                                  hn::Mul(scale, hn::Load(d, tile_.y + block / kColumns * kBlock)), hn::Set(d, depth)});
        }
        if (!frame_.scene->shading) return unlit(Shading{}, arrives);
        const auto scale = frame_.scene->normalized ? per_weight : one;
        const auto part = [&](std::size_t axis)
                              HWY_ATTR { return hn::Mul(hn::Load(d, sums + (kGradient + axis) * kBlock), scale); };
        const auto back = hn::Set(d, view_.perspective() ? -1.0f : 0.0f);
        const Vector to_eye{hn::Mul(back, hn::Load(d, tile_.x + block % kColumns * kBlock)),
                            hn::Mul(back, hn::Load(d, tile_.y + block / kColumns * kBlock)), hn::Set(d, -1.0f)};
        return light(*frame_.scene->shading, {part(0), part(1), part(2)}, normalize(to_eye), least_gradient_, arrives);
    }

    void write(Drawn& drawn) const {
        for (std::size_t block = 0; block < kBlocks; ++block) {
            const BlockState& b = scratch().blocks[block];
            for (std::size_t lane = 0; lane < kBlock; ++lane) {
                const auto [x, y] = pixel(block, lane);
                if (x >= view_.width() || y >= view_.height()) continue;
                const auto out = drawn.image.pixel(x, y);
                const float opacity = b.opacity[lane];
                out[0] = b.red[lane];
                out[1] = b.green[lane];
                out[2] = b.blue[lane];
                out[3] = opacity;
                if (opacity > 0) {
                    drawn.depth[pixel_index(view_.width(), x, y)] = sheets_.middle + b.depth[lane] / opacity;
                }
            }
        }
    }

    const SplatFrame& frame_;
    const View& view_;
    const SheetStack& sheets_;
    Classifier classifier_;
    GeneralSums general_;
    TilePixels tile_;
    BatchView batch_{};
    Cuts cuts_;
    std::pair<std::size_t, std::size_t> marked_;  // sheets of a block, the last one included
    float x_offset_ = 0, color_offset_ = 0, least_gradient_ = 0;
    int x0_ = 0, y0_ = 0;
    std::size_t tile_id_ = 0;
    const KeptValues* kept_ = nullptr;  // of the sheets that are composited; null: they are in the sums
    // The sheets that are summed: the place in the stack of the one before them, and their distance there. Levels: the most of
    // those of the batch, and of its cells.
    float before_ = -1, step_ = 1;
    int level_ = 0;
    std::array<int, kCells * kCells> levels_{};
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
