// SPDX-License-Identifier: Apache-2.0
// The kernels that a view needs, from a file in blocks with a tree of merged kernels over them.
//
//     top of the tree ──► nodes that pass the test, and blocks whose roots do not
//     each block      ──► nodes that pass, level by level as they are reached; at leaves that do not, the slots of kernels
//     kernels' numbers, ascending ──► the place of each kernel in the result: its rank
//     blocks with kernels ──► their kernels, read and put into place
//
// The result has the kernels first, by their numbers in the volume that was written, then the nodes in the tree's order: as a
// cut of the tree in memory. Blocks are worked on in parallel, in turns, so that only those of one turn and those in the cache
// are in memory besides the result. After each turn the cache gives up what is beyond its size: parts that this view has not
// used, the longest unused first, then the last ones that it has read. A number that occurs twice is an error.
#include "subvol/kernel_file.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "node_test.h"
#include "subvol/detail/kernel_source.h"
#include "subvol/error.h"
#include "svk_file.h"

namespace subvol::detail {

namespace {

/// The parts of a file's blocks that were read for this view and the ones before it, up to some bytes.
class KernelCache {
public:
    /// file: referred to
    KernelCache(const SvkFile& file, std::uint64_t most_bytes);

    void begin_view() { ++view_; }

    /// The bytes of a part, until the next `trim`. Several threads may ask for parts of different blocks.
    [[nodiscard]] const std::string& part(std::size_t block, std::size_t part);

    /// Drops parts if there are too many bytes: those that this view has not used, the longest unused first; then the last that
    /// it has read, so that the next view finds the others.
    void trim();

private:
    struct Slot {
        std::string bytes{};
        std::uint64_t view = 0, turn = 0;  // when it was last used, and read
    };

    const SvkFile& file_;
    std::uint64_t most_bytes_, view_ = 0, turn_ = 0;
    std::atomic<std::uint64_t> bytes_ = 0;
    std::vector<Slot> slots_;
};

KernelCache::KernelCache(const SvkFile& file, std::uint64_t most_bytes)
    : file_(file), most_bytes_(most_bytes), slots_(file.layout().blocks() * file.layout().parts()) {
}

const std::string& KernelCache::part(std::size_t block, std::size_t part) {
    Slot& slot = slots_[block * file_.layout().parts() + part];
    if (slot.bytes.empty()) {  // no part is without bytes, but for numbers of no kernels
        slot.bytes = file_.part(block, part);
        slot.turn = turn_;
        bytes_ += slot.bytes.size();
    }
    slot.view = view_;
    return slot.bytes;
}

void KernelCache::trim() {
    ++turn_;
    if (bytes_ <= most_bytes_) return;
    std::vector<Slot*> held;
    for (Slot& slot : slots_) {
        if (!slot.bytes.empty()) held.push_back(&slot);
    }
    std::ranges::stable_sort(held, [&](const Slot* a, const Slot* b) {
        if (a->view != b->view) return a->view < b->view;
        return a->view == view_ && a->turn > b->turn;
    });
    for (Slot* const slot : held) {
        if (bytes_ <= most_bytes_) return;
        bytes_ -= slot->bytes.size();
        slot->bytes = {};
    }
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

namespace {

constexpr std::size_t kBlocksOfTurn = 512;  // blocks that are in memory together, besides those in the cache

/// A set of numbers that knows for each of them how many are less.
class RankedSet {
public:
    explicit RankedSet(std::size_t below) : words_((below + 63) / 64), ranks_(words_.size()) {}

    /// False if it was there already.
    bool add(std::uint32_t number) {
        std::uint64_t& word = words_[number / 64];
        const std::uint64_t bit = std::uint64_t{1} << number % 64;
        return (std::exchange(word, word | bit) & bit) == 0;
    }

    /// All numbers, ascending; `rank` can be called from then on.
    [[nodiscard]] std::vector<Index> sorted() {
        std::vector<Index> numbers;
        for (std::size_t w = 0; w < words_.size(); ++w) {
            ranks_[w] = static_cast<std::uint32_t>(numbers.size());
            for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
                numbers.push_back(static_cast<Index>(64 * w + static_cast<std::size_t>(std::countr_zero(word))));
            }
        }
        return numbers;
    }

    [[nodiscard]] std::size_t rank(std::uint32_t number) const {
        const std::uint64_t before = words_[number / 64] & ((std::uint64_t{1} << number % 64) - 1);
        return ranks_[number / 64] + static_cast<std::size_t>(std::popcount(before));
    }

private:
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> ranks_;
};

/// What a cut takes of a block.
///
/// nodes:   numbers in the tree, in its order; volume: their kernels
/// slots:   of kernels, within the block, ascending; numbers: of those kernels
struct BlockCut {
    std::size_t block = 0;
    std::vector<Index> nodes{};
    RbfVolume volume{};
    std::vector<std::uint32_t> slots{}, numbers{};
    double error = 0;
};

/// Cuts a block whose root is not taken. Levels are read when they are reached.
class BlockCutter {
public:
    BlockCutter(const detail::SvkFile& file, detail::KernelCache& cache, const detail::NodeTest& test, std::size_t block)
        : file_(file), layout_(file.layout()), cache_(cache), test_(test) {
        cut_.block = block;
    }

    [[nodiscard]] BlockCut cut(std::span<const std::size_t> channels) {
        if (layout_.below() == 0) {
            take_leaf(0);
        } else {
            descend(1, 0);
            descend(1, 1);
        }
        cut_.volume = detail::svk_volume(file_.contents(), taken_.size(), channels);
        for (std::size_t k = 0; k < taken_.size(); ++k) taken_[k].first->copy(taken_[k].second, cut_.volume, k, channels);
        if (!cut_.slots.empty()) {
            const std::vector<std::uint32_t> all =
                file_.numbers_in(cut_.block, cache_.part(cut_.block, layout_.numbers_part()));
            for (const std::uint32_t slot : cut_.slots) cut_.numbers.push_back(all[slot]);
        }
        return std::move(cut_);
    }

private:
    /// k: the node's place in its level, among those of the block
    void descend(int level, std::size_t k) {
        const detail::SvkArrays& nodes = nodes_of(level);
        const std::size_t i = detail::SvkLayout::first_of_level(level) + k;
        const float error = nodes.error(test_.channel(), i);
        if (test_.takes(nodes.center(i), nodes.width(i), error)) {
            const std::size_t of_level = (cut_.block << level) + k;
            cut_.nodes.push_back(static_cast<Index>((std::size_t{1} << (layout_.root_level() + level)) - 1 + of_level));
            cut_.error = std::max(cut_.error, double(error));
            taken_.emplace_back(&nodes, i);
        } else if (level == layout_.below()) {
            take_leaf(k);
        } else {
            descend(level + 1, 2 * k);
            descend(level + 1, 2 * k + 1);
        }
    }

    void take_leaf(std::size_t k) {
        const std::uint64_t leaf = (std::uint64_t{cut_.block} << layout_.below()) + k;
        const std::uint64_t first = layout_.first_slot(cut_.block);
        for (std::uint64_t slot = layout_.first_slot_of_leaf(leaf); slot < layout_.first_slot_of_leaf(leaf + 1); ++slot) {
            cut_.slots.push_back(static_cast<std::uint32_t>(slot - first));
        }
    }

    [[nodiscard]] const detail::SvkArrays& nodes_of(int level) {
        const std::size_t part = detail::SvkLayout::part_of_level(level);
        if (!nodes_[part]) {
            nodes_[part].emplace(file_.contents(), detail::SvkArrays::Kind::Nodes, cache_.part(cut_.block, part),
                                 layout_.part(cut_.block, part).count);
        }
        return *nodes_[part];
    }

    const detail::SvkFile& file_;
    const detail::SvkLayout& layout_;
    detail::KernelCache& cache_;
    const detail::NodeTest& test_;
    std::array<std::optional<detail::SvkArrays>, detail::SvkLayout::kBlockLevels> nodes_{};
    std::vector<std::pair<const detail::SvkArrays*, std::size_t>> taken_{};
    BlockCut cut_{};
};

}  // namespace

KernelFileContents detail::kernel_file_contents(const SvkContents& contents, const SvkLayout& layout, std::uint64_t bytes) {
    KernelFileContents result{.kernel = contents.kernel,
                              .kernels = contents.kernels,
                              .channels = {},
                              .bounds = contents.bounds,
                              .boundary_triangles = contents.boundary_triangles,
                              .levels = layout.levels() + 1,
                              .blocks = layout.blocks(),
                              .bytes = bytes};
    for (const SvkChannel& channel : contents.channels) result.channels.push_back({channel.name, channel.min, channel.max});
    return result;
}

struct KernelFile::State {
    State(const std::filesystem::path& path, std::uint64_t cache_bytes)
        : file(path),
          cache(file, cache_bytes),
          contents(detail::kernel_file_contents(file.contents(), file.layout(), file.layout().file_bytes())) {}

    /// A node of the top of the tree that is drawn, or a block whose root is not.
    struct Piece {
        bool is_block;
        std::size_t number;
    };

    [[nodiscard]] std::vector<Piece> cut_top(const detail::SvkArrays& nodes, const detail::NodeTest& test) const {
        const std::size_t blocks = file.layout().blocks();
        std::vector<Piece> pieces;
        std::vector<std::size_t> open{0};
        while (!open.empty()) {
            const std::size_t node = open.back();
            open.pop_back();
            if (test.takes(nodes.center(node), nodes.width(node), nodes.error(test.channel(), node))) {
                pieces.push_back({false, node});
            } else if (node >= blocks - 1) {
                pieces.push_back({true, node - (blocks - 1)});
            } else {
                open.push_back(2 * node + 2);
                open.push_back(2 * node + 1);
            }
        }
        return pieces;
    }

    /// Calls body(k) for k < count, some of them at once, and trims the cache between.
    template <class Body>
    void in_turns(std::size_t count, Progress* progress, const char* stage, const Body& body) {
        for (std::size_t first = 0; first < count; first += kBlocksOfTurn) {
            report_progress(progress, stage, first, count);
            tbb::parallel_for(first, std::min(first + kBlocksOfTurn, count), body);
            cache.trim();
        }
    }

    [[nodiscard]] StreamedKernels choose(const View& view, const LevelOptions& options, std::span<const std::size_t> channels,
                                         Progress* progress) {
        const detail::NodeTest test(&view, options, contents.kernels, contents.channels.size());
        cache.begin_view();
        if (top.empty()) top = file.top();
        const detail::SvkArrays nodes(file.contents(), detail::SvkArrays::Kind::Nodes, top, file.layout().top().count);
        const std::vector<Piece> pieces = cut_top(nodes, test);
        std::vector<BlockCut> cuts;
        for (const Piece& piece : pieces) {
            if (piece.is_block) cuts.emplace_back().block = piece.number;
        }
        in_turns(cuts.size(), progress, "choose kernels",
                 [&](std::size_t k) { cuts[k] = BlockCutter(file, cache, test, cuts[k].block).cut(channels); });

        StreamedKernels result;
        RankedSet kernels(contents.kernels);
        std::vector<std::size_t> first_nodes;  // of each block's nodes, among those of the cut
        auto next = cuts.begin();
        for (const Piece& piece : pieces) {
            if (!piece.is_block) {
                result.cut.nodes.push_back(static_cast<Index>(piece.number));
                result.cut.error = std::max(result.cut.error, double(nodes.error(test.channel(), piece.number)));
                continue;
            }
            const BlockCut& cut = *next++;
            first_nodes.push_back(result.cut.nodes.size());
            result.cut.nodes.insert(result.cut.nodes.end(), cut.nodes.begin(), cut.nodes.end());
            result.cut.error = std::max(result.cut.error, cut.error);
            for (const std::uint32_t number : cut.numbers) {
                if (!kernels.add(number)) file.fail("kernel " + std::to_string(number) + " is in it twice");
            }
        }
        result.cut.kernels = kernels.sorted();
        const std::size_t count = result.cut.kernels.size();
        RbfVolume& volume = result.volume = detail::svk_volume(file.contents(), result.cut.size(), channels);
        for (std::size_t k = 0; k < result.cut.nodes.size(); ++k) {
            if (result.cut.nodes[k] < nodes.size()) nodes.copy(result.cut.nodes[k], volume, count + k, channels);
        }
        for (std::size_t k = 0; k < cuts.size(); ++k) {
            put(std::exchange(cuts[k].volume, {}), volume, count + first_nodes[k]);
        }
        std::erase_if(cuts, [](const BlockCut& cut) { return cut.slots.empty(); });
        in_turns(cuts.size(), progress, "read kernels", [&](std::size_t k) {
            const std::size_t part = file.layout().kernels_part();
            const detail::SvkArrays arrays(file.contents(), detail::SvkArrays::Kind::Kernels, cache.part(cuts[k].block, part),
                                           file.layout().part(cuts[k].block, part).count);
            for (std::size_t i = 0; i < cuts[k].slots.size(); ++i) {
                arrays.copy(cuts[k].slots[i], volume, kernels.rank(cuts[k].numbers[i]), channels);
            }
        });
        return result;
    }

    /// Copies all kernels of a volume to the places from `first` on.
    static void put(const RbfVolume& from, RbfVolume& to, std::size_t first) {
        const auto place = [&](const auto& source, auto& target) { std::ranges::copy(source, target.data() + first); };
        place(from.centers, to.centers);
        place(from.frames, to.frames);
        for (std::size_t c = 0; c < from.channels.size(); ++c) {
            place(from.channels[c].values, to.channels[c].values);
            place(from.channels[c].gradients, to.channels[c].gradients);
            place(from.channels[c].moments, to.channels[c].moments);
            if (!from.channels[c].hessians.empty()) place(from.channels[c].hessians, to.channels[c].hessians);
        }
    }

    const Surface& surface() {
        if (!boundary) {
            boundary = file.boundary();
            RbfVolume about;
            about.boundary = *boundary;
            if (!boundary->points.empty()) bounds = box_of(about);
        }
        return *boundary;
    }

    detail::SvkFile file;
    detail::KernelCache cache;
    KernelFileContents contents;
    std::string top{};
    std::optional<Surface> boundary{};
    Box bounds{};  // of the boundary
};

KernelFile::KernelFile(const std::filesystem::path& path, std::uint64_t cache_bytes)
    : state_(std::make_unique<State>(path, cache_bytes)) {
}

KernelFile::~KernelFile() = default;
KernelFile::KernelFile(KernelFile&&) noexcept = default;
KernelFile& KernelFile::operator=(KernelFile&&) noexcept = default;

const KernelFileContents& KernelFile::contents() const {
    return state_->contents;
}

const Surface& KernelFile::boundary() {
    return state_->surface();
}

std::uint64_t KernelFile::bytes_read() const {
    return state_->file.bytes_read();
}

StreamedKernels KernelFile::choose_level(const View& view, const LevelOptions& options,
                                         const std::vector<std::size_t>& channels, Progress* progress) {
    State& state = *state_;
    const std::size_t known = state.contents.channels.size();
    std::vector<std::size_t> chosen = channels;
    if (chosen.empty()) {
        chosen.resize(known);
        std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    }
    for (const std::size_t channel : chosen) {
        if (channel < known) continue;
        throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(channel), {},
                    "the file has " + std::to_string(known));
    }
    const std::uint64_t before = bytes_read();
    StreamedKernels result = state.choose(view, options, chosen, progress);
    result.volume.boundary = state.surface();
    if (!state.bounds.empty()) result.volume.bounds = state.bounds;
    result.bytes_read = bytes_read() - before;
    return result;
}

}  // namespace subvol
