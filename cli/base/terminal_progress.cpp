// SPDX-License-Identifier: Apache-2.0
#include "terminal_progress.h"

#include <algorithm>
#include <cstdio>

#include "interrupt.h"

namespace subvol::cli {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kRedrawInterval{80};

}  // namespace

void TerminalProgress::report(std::string_view stage, double fraction) {
    if (!visible_) return;
    const auto now = std::chrono::steady_clock::now();
    if (drawn_ && stage == stage_ && now - last_ < kRedrawInterval) return;
    stage_ = stage;
    last_ = now;
    drawn_ = true;
    const double part = std::clamp(fraction, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(part * kBarWidth);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    std::fprintf(stderr, "\r\033[K%-24s [%s] %3.0f %%", stage_.c_str(), bar.c_str(), 100 * part);
    std::fflush(stderr);
}

bool TerminalProgress::cancelled() const {
    return interrupt_signal() != 0;
}

void TerminalProgress::clear() {
    if (!drawn_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace subvol::cli
