// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <string>

#include "kernel_file_contents.h"
#include "node_merger.h"
#include "subvol/detail/median_tree.h"
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
    FileWriter(const std::filesystem::path& path, const RbfVolume& volume, Progress* progress)
        : volume_(volume), progress_(progress), out_(path, detail::svk_contents(volume)), merger_(volume) {}

    std::uint64_t write() {
        const detail::SvkLayout& layout = out_.layout();
        report_progress(progress_, "sort kernels", 0);
        order_ = detail::median_order(volume_.centers, std::size_t{1} << layout.levels());
        out_.write_boundary(volume_.boundary);
        KernelHierarchy top;
        merger_.allocate(top, 2 * layout.blocks() - 1);
        constexpr std::size_t kWrittenInTurn = 128;  // blocks that are in memory together
        for (std::size_t first = 0; first < layout.blocks(); first += kWrittenInTurn) {
            report_progress(progress_, "merge kernels", static_cast<double>(first) / static_cast<double>(layout.blocks()));
            std::vector<Block> blocks(std::min(kWrittenInTurn, layout.blocks() - first));
            tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) { blocks[b] = make_block(first + b); });
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                detail::copy_node(blocks[b].tree, 0, top, layout.blocks() - 1 + first + b);
            }
            for (std::size_t p = 0; p < layout.parts(); ++p) {  // the same part of neighbours is together in the file
                for (std::size_t b = 0; b < blocks.size(); ++b) out_.write_part(first + b, p, blocks[b].parts[p]);
            }
        }
        for (std::size_t node = layout.blocks() - 1; node-- > 0;) merger_.merge_nodes(top, node);
        out_.write_top(node_bytes(top, 0, top.nodes.size()));
        out_.finish();
        report_progress(progress_, "merge kernels", 1);
        return layout.file_bytes();
    }

private:
    [[nodiscard]] Block make_block(std::size_t number) const {
        const detail::SvkLayout& layout = out_.layout();
        const std::size_t leaves = std::size_t{1} << layout.below(), first_leaf = number * leaves;
        Block block;
        merger_.allocate(block.tree, 2 * leaves - 1);
        for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
            merger_.merge_kernels(
                block.tree, leaves - 1 + leaf,
                slots(layout.first_slot_of_leaf(first_leaf + leaf), layout.first_slot_of_leaf(first_leaf + leaf + 1)));
        }
        for (std::size_t node = leaves - 1; node-- > 0;) merger_.merge_nodes(block.tree, node);
        for (std::size_t p = 0; p < layout.node_parts(); ++p) {
            const std::size_t first = (std::size_t{1} << layout.first_level(p)) - 1;
            block.parts.push_back(node_bytes(block.tree, first, layout.part(number, p).count));
        }
        const auto kernels = slots(layout.first_slot(number), layout.first_slot(number + 1));
        block.parts.push_back(number_bytes(kernels));
        block.parts.push_back(detail::svk_bytes(volume_, kernels));
        return block;
    }

    [[nodiscard]] std::span<const Index> slots(std::uint64_t first, std::uint64_t end) const {
        return std::span(order_).subspan(first, end - first);
    }

    const RbfVolume& volume_;
    Progress* progress_;
    detail::SvkWriter out_;
    detail::NodeMerger merger_;
    std::vector<Index> order_{};
};

}  // namespace

KernelFileContents write_kernel_file(const std::filesystem::path& path, const RbfVolume& volume, Progress* progress) {
    validate(volume);
    if (volume.size() == 0) throw Error(ErrorCode::InvalidInput, "there are no kernels to be written", path.string());
    constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
    const std::uint64_t most = std::max({volume.size(), volume.boundary.points.size(), volume.boundary.triangles.size()});
    if (most >= kMost) {
        throw Error(ErrorCode::InvalidInput, std::to_string(most) + " kernels, points or triangles are too many", path.string(),
                    "fewer than 2³²");
    }
    FileWriter writer(path, volume, progress);
    const std::uint64_t bytes = writer.write();
    const detail::SvkContents contents = detail::svk_contents(volume);
    return detail::kernel_file_contents(contents, detail::SvkLayout(contents, 0), bytes);
}

}  // namespace subvol
