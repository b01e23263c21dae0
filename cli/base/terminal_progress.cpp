// SPDX-License-Identifier: Apache-2.0
#include "terminal_progress.h"

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>

#include "interrupt.h"
#include "quantities.h"

namespace subvol::cli {
namespace {

constexpr std::size_t kBarWidth = 24, kStageWidth = 26;
constexpr double kRedraw_s = .08, kTick_s = .2;
constexpr double kWindow_s = 8;      // of the past that an estimate looks at
constexpr double kLeastPast_s = .4;  // before there is one
constexpr double kStart_s = 3;       // what there is to do before the first report may take most of it
constexpr double kLong_s = 10;       // what is worth a hint

}  // namespace

std::string progress_line(const std::string& stage, double fraction, double left, double spent) {
    std::string line = stage.substr(0, kStageWidth);
    line += std::string(kStageWidth - line.size(), ' ') + " [";
    if (fraction > 0) {
        const auto filled = static_cast<std::size_t>(fraction * kBarWidth);
        line += std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] ";
        const std::string percent = std::to_string(static_cast<int>(100 * fraction));
        line += std::string(3 - std::min<std::size_t>(percent.size(), 3), ' ') + percent + " %";
        if (left >= 1) line += ", " + seconds_text(left) + " left";
        return line;
    }
    // Not known: a mark that walks, two steps a second.
    std::string bar(kBarWidth, '.');
    const auto at = static_cast<std::size_t>(2 * spent) % (kBarWidth - 2);
    std::fill_n(bar.data() + at, 3, '#');
    return line + bar + "]" + (spent >= 1 ? " " + seconds_text(spent) : "");
}

void Pace::add(double seconds, double fraction) {
    if (!past_.empty() && fraction < past_.back().fraction) past_.clear();  // it began again
    past_.push_back({seconds, fraction});
    while (past_.size() > 2 && past_[1].seconds < seconds - kWindow_s) past_.pop_front();
}

double Pace::left() const {
    const auto since = [&](const Mark& first, double least_s) {
        const double seconds = past_.back().seconds - first.seconds, done = past_.back().fraction - first.fraction;
        return seconds < least_s || done <= 0 ? -1 : (1 - past_.back().fraction) * seconds / done;
    };
    const auto begun = std::ranges::find_if(past_, [](const Mark& mark) { return mark.fraction > 0; });
    if (begun == past_.end()) return -1;
    const double left = since(*begun, kLeastPast_s);
    return left >= 0 ? left : since(past_.front(), kStart_s);
}

TerminalProgress::TerminalProgress(bool visible) : visible_(visible) {
    if (!visible_) return;
    try {
        drawer_ = std::jthread([this](const std::stop_token& stop) { keep_drawing(stop); });
    } catch (const std::system_error&) {  // no more threads: the bar moves with reports only
    }
}

TerminalProgress::~TerminalProgress() {
    drawer_ = {};
    clear();
}

void TerminalProgress::keep_drawing(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        stopped_.wait_for(lock, stop, std::chrono::duration<double>(kTick_s), [] { return false; });
        if (active_ && now() - last_draw_ > kTick_s) draw();
    }
}

/// Stages that differ in a number only, as "frame 3 of 8" and "frame 4 of 8", follow each other in one bar.
std::string_view TerminalProgress::kind(std::string_view stage) {
    return stage.substr(0, stage.find_first_of("0123456789"));
}

void TerminalProgress::report(std::string_view stage, double fraction) {
    if (!visible_ && !say_) return;
    const std::lock_guard lock(mutex_);
    fraction = std::clamp(fraction, 0.0, 1.0);
    std::string name(stage);
    if (!part_.empty()) {
        part_done_ = std::max(part_done_, fraction);
        fraction = part_begin_ + part_size_ * part_done_;
        name = part_ + ": " + name;
    }
    const double time = now();
    const bool in_parts = !part_.empty();
    const bool begins = !active_ || (!in_parts && (kind(name) != kind(stage_) || fraction < fraction_));
    const bool other = begins || name != stage_;
    if (begins && (!in_parts || part_begin_ == 0)) {
        pace_.clear();
        stage_start_ = time;
    }
    stage_ = std::move(name);
    fraction_ = fraction;
    active_ = true;
    // The stages of a part take longer or shorter, so only whole parts show the pace (begin_part).
    if (in_parts ? begins && part_begin_ == 0 : fraction > 0 || begins) pace_.add(time, fraction);
    hint(time);
    if (visible_ && (other || time - last_draw_ >= kRedraw_s)) draw();
}

void TerminalProgress::draw() {
    last_draw_ = now();
    drawn_ = true;
    const std::string line = progress_line(stage_, fraction_, pace_.left(), last_draw_ - stage_start_);
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
}

void TerminalProgress::hint(double now) {
    const double left = pace_.left();
    if (!say_ || left + now - stage_start_ < kLong_s || left < 0) return;
    const auto say = std::exchange(say_, nullptr);
    if (drawn_) std::fputs("\r\033[K", stderr);
    drawn_ = false;
    const std::string whole = part_.empty() ? stage_ + " takes about " : "all of it takes about ";
    say(whole + seconds_text(left + now - stage_start_) + "; quicker: " + quicker_);
}

bool TerminalProgress::cancelled() const {
    return interrupt_signal() != 0;
}

void TerminalProgress::begin_part(const std::string& name, std::size_t index, std::size_t count) {
    const std::lock_guard lock(mutex_);
    part_ = name;
    part_size_ = count > 0 ? 1.0 / static_cast<double>(count) : 1;
    part_begin_ = static_cast<double>(index) * part_size_;
    part_done_ = 0;
    if (active_ && index > 0 && index < count) pace_.add(now(), part_begin_);
}

void TerminalProgress::hint_at(std::string quicker, std::function<void(const std::string&)> say) {
    const std::lock_guard lock(mutex_);
    quicker_ = std::move(quicker);
    say_ = std::move(say);
}

void TerminalProgress::clear() {
    const std::lock_guard lock(mutex_);
    active_ = false;
    if (!drawn_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace subvol::cli
