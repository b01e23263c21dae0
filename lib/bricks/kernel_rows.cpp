// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/kernel_rows.h"

#include <optional>

#include "spilled_kernels.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/error.h"

namespace subvol::detail {

struct KernelRows::State {
    std::filesystem::path path;
    std::uint64_t kernels;
    const Surface& boundary;
    Progress* progress;
    std::optional<PlyRows> ply = {};
    std::optional<SpilledKernels> spilled = {};
};

KernelRows::KernelRows(const std::filesystem::path& path, const RbfVolume& like, std::uint64_t kernels, const Surface& boundary,
                       const std::string& note, Progress* progress)
    : state_(new State{path, kernels, boundary, progress}) {
    if (path.extension() != ".svk") {
        state_->ply.emplace(path, like, kernels, boundary, note);
        return;
    }
    if (kernels >= kNone) {
        throw Error(ErrorCode::InvalidInput, std::to_string(kernels) + " kernels are too many", path.string(),
                    "fewer than 2³²");
    }
    state_->spilled.emplace(std::filesystem::absolute(path).parent_path(), like, kernels, boundary);
}

KernelRows::~KernelRows() = default;

void KernelRows::write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels) {
    if (state_->ply) {
        state_->ply->write(numbers, kernels);
    } else {
        state_->spilled->write(numbers, kernels);
    }
}

void KernelRows::finish() {
    if (state_->ply) {
        state_->ply->finish(state_->boundary);
        return;
    }
    if (state_->spilled->written() != state_->kernels) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(state_->kernels - state_->spilled->written()) + " kernels have not been written",
                    state_->path.string());
    }
    write_kernel_file(state_->path, *state_->spilled, state_->progress);
}

}  // namespace subvol::detail
