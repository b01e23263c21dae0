// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <string>

#include "node_merger.h"
#include "subvol/detail/kernel_source.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/points_range.h"
#include "subvol/error.h"
#include "svk_file.h"

namespace subvol {

namespace {

static_assert(detail::kLeafSize == detail::SvkLayout::kLeafSize);

std::vector<Index> numbers_from(std::size_t first, std::size_t count) {
    std::vector<Index> numbers(count);
    std::iota(numbers.begin(), numbers.end(), static_cast<Index>(first));
    return numbers;
}

std::string node_bytes(const KernelHierarchy& tree, std::size_t first, std::size_t count) {
    return detail::svk_bytes(tree.nodes, numbers_from(first, count), tree.widths, tree.errors);
}

std::string number_bytes(std::span<const Index> numbers) {
    std::string bytes;
    for (const Index i : numbers) {
        const auto number = static_cast<std::uint32_t>(i);
        bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
    return bytes;
}

/// A block: its tree, and the bytes of its parts.
struct Block {
    KernelHierarchy tree{};
    std::vector<std::string> parts{};
};

class FileWriter {
public:
    FileWriter(const std::filesystem::path& path, const detail::KernelSource& source, Progress* progress)
        : source_(source), progress_(progress), out_(path, source.contents()) {}

    std::uint64_t write() {
        const detail::SvkLayout& layout = out_.layout();
        report_progress(progress_, "sort kernels", 0);
        order_ = source_.order(std::size_t{1} << layout.levels());
        out_.write_boundary(source_.boundary());
        KernelHierarchy top;
        constexpr std::size_t kWrittenInTurn = 128;  // blocks that are in memory together
        for (std::size_t first = 0; first < layout.blocks(); first += kWrittenInTurn) {
            report_progress(progress_, "merge kernels", first, layout.blocks());
            std::vector<Block> blocks(std::min(kWrittenInTurn, layout.blocks() - first));
            const std::uint64_t first_slot = layout.first_slot(first), end = layout.first_slot(first + blocks.size());
            const RbfVolume kernels = source_.kernels(slots(first_slot, end));
            const detail::NodeMerger merger(kernels);
            if (first == 0) merger.allocate(top, 2 * layout.blocks() - 1);
            tbb::parallel_for(std::size_t{0}, blocks.size(),
                              [&](std::size_t b) { blocks[b] = make_block(first + b, kernels, first_slot, merger); });
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                detail::copy_node(blocks[b].tree, 0, top, layout.blocks() - 1 + first + b);
            }
            for (std::size_t p = 0; p < layout.parts(); ++p) {  // the same part of neighbours is together in the file
                for (std::size_t b = 0; b < blocks.size(); ++b) out_.write_part(first + b, p, blocks[b].parts[p]);
            }
        }
        const RbfVolume none = source_.kernels({});
        const detail::NodeMerger merger(none);
        for (std::size_t node = layout.blocks() - 1; node-- > 0;) merger.merge_nodes(top, node);
        out_.write_top(node_bytes(top, 0, top.nodes.size()));
        out_.finish();
        report_progress(progress_, "merge kernels", 1);
        return layout.file_bytes();
    }

private:
    /// kernels: those from `first_slot` on
    [[nodiscard]] Block make_block(std::size_t number, const RbfVolume& kernels, std::uint64_t first_slot,
                                   const detail::NodeMerger& merger) const {
        const detail::SvkLayout& layout = out_.layout();
        const std::size_t leaves = std::size_t{1} << layout.below(), first_leaf = number * leaves;
        Block block;
        merger.allocate(block.tree, 2 * leaves - 1);
        for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
            const std::uint64_t begin = layout.first_slot_of_leaf(first_leaf + leaf);
            const std::uint64_t end = layout.first_slot_of_leaf(first_leaf + leaf + 1);
            merger.merge_kernels(block.tree, leaves - 1 + leaf, numbers_from(begin - first_slot, end - begin));
        }
        for (std::size_t node = leaves - 1; node-- > 0;) merger.merge_nodes(block.tree, node);
        for (std::size_t p = 0; p < layout.node_parts(); ++p) {
            const std::size_t first = (std::size_t{1} << layout.first_level(p)) - 1;
            block.parts.push_back(node_bytes(block.tree, first, layout.part(number, p).count));
        }
        const std::uint64_t begin = layout.first_slot(number), end = layout.first_slot(number + 1);
        block.parts.push_back(number_bytes(slots(begin, end)));
        block.parts.push_back(detail::svk_bytes(kernels, numbers_from(begin - first_slot, end - begin)));
        return block;
    }

    [[nodiscard]] std::span<const Index> slots(std::uint64_t first, std::uint64_t end) const {
        return std::span(order_).subspan(first, end - first);
    }

    const detail::KernelSource& source_;
    Progress* progress_;
    detail::SvkWriter out_;
    std::vector<Index> order_{};
};

/// A volume in memory.
class VolumeKernels : public detail::KernelSource {
public:
    explicit VolumeKernels(const RbfVolume& volume) : volume_(volume) {}
    [[nodiscard]] detail::SvkContents contents() const override { return detail::svk_contents(volume_); }
    [[nodiscard]] const Surface& boundary() const override { return volume_.boundary; }
    [[nodiscard]] std::vector<Index> order(std::size_t leaves) const override {
        return detail::median_order(volume_.centers, leaves);
    }
    [[nodiscard]] RbfVolume kernels(std::span<const Index> numbers) const override {
        const std::vector<std::size_t> places(numbers.begin(), numbers.end());
        return detail::chosen_kernels(volume_, places);
    }

private:
    const RbfVolume& volume_;
};

}  // namespace

KernelFileContents detail::write_kernel_file(const std::filesystem::path& path, const KernelSource& source,
                                             Progress* progress) {
    const SvkContents contents = source.contents();
    constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
    const std::uint64_t most = std::max({contents.kernels, contents.boundary_points, contents.boundary_triangles});
    if (most >= kMost) {
        throw Error(ErrorCode::InvalidInput, std::to_string(most) + " kernels, points or triangles are too many", path.string(),
                    "fewer than 2³²");
    }
    FileWriter writer(path, source, progress);
    const std::uint64_t bytes = writer.write();
    return kernel_file_contents(contents, SvkLayout(contents, 0), bytes);
}

KernelFileContents write_kernel_file(const std::filesystem::path& path, const RbfVolume& volume, Progress* progress) {
    validate(volume);
    if (volume.size() == 0) throw Error(ErrorCode::InvalidInput, "there are no kernels to be written", path.string());
    return detail::write_kernel_file(path, VolumeKernels(volume), progress);
}

}  // namespace subvol
