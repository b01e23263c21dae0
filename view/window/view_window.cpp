// SPDX-License-Identifier: Apache-2.0
// The session as the window sees it. GLFW and Dear ImGui are in a module, which is loaded here; it has no other way to the
// session than this host.
//
//     window ─► action as text ─► session     a file is read on another thread ─► session, which takes the place of the last
//     window ◄─ picture as sRGB bytes ◄─ session
//
// A picture is encoded only if it, or how it is composed, differs from the one on the screen. Square roots of linear light
// index a table of bytes, from which few steps up lead to the same bytes as those of a .png file. A file that is opened while
// another one is read cancels it; the same file with other options keeps the view. Errors of actions come back as text. A
// script's actions are played one at a time, each once the session is idle.
#include "subvol/view_window.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <future>
#include <mutex>
#include <utility>
#include <vector>

#include "cancel_flag.h"
#include "recent_files.h"
#include "seen_view.h"
#include "subvol/detail/module.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/srgb.h"
#include "subvol/vec.h"
#include "window_host.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kFine = 4096;

/// For each interval of square roots of linear light the byte at its lower end; from there a byte or two up are left to try.
struct Encoder {
    std::array<double, 256> first{};  // the least linear light that becomes the byte
    std::array<std::uint8_t, kFine + 1> near{};

    Encoder() {
        for (std::size_t k = 1; k < 256; ++k) first[k] = linear_from_srgb((static_cast<double>(k) - 0.5) / 255);
        for (std::size_t k = 0; k <= kFine; ++k) {
            const double root = static_cast<double>(k) / kFine;
            near[k] =
                static_cast<std::uint8_t>(std::upper_bound(first.begin() + 1, first.end(), root * root) - first.begin() - 1);
        }
    }

    [[nodiscard]] std::uint8_t operator()(double linear) const {
        if (!(linear > 0)) return 0;
        if (linear >= 1) return 255;
        std::size_t byte = near[static_cast<std::size_t>(std::sqrt(linear) * kFine)];
        while (byte < 255 && linear >= first[byte + 1]) ++byte;
        return static_cast<std::uint8_t>(byte);
    }
};

/// A picture over a background as 8-bit sRGB RGBA, opaque: the same bytes as those of a .png file.
std::vector<std::uint8_t> screen_pixels(const Image& image, const Vec3& background) {
    static const Encoder encode;
    std::vector<std::uint8_t> bytes(image.rgba.size());
    tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const auto pixel = image.pixel(x, y);
            std::uint8_t* const byte = bytes.data() + (pixel.data() - image.rgba.data());
            const double through = 1.0 - static_cast<double>(pixel[3]);
            for (std::size_t c = 0; c < 3; ++c)
                byte[c] = encode(static_cast<double>(pixel[c]) + through * background[static_cast<int>(c)]);
            byte[3] = 255;
        }
    });
    return bytes;
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

class Host : public WindowHost {
public:
    Host(std::unique_ptr<ViewSession> session, const WindowOptions& options)
        : session_(std::move(session)),
          options_(options),
          opened_(options.first),
          script_(ViewSession::split_script(options.script, options.script_file)) {
        look().dark = options.dark;
        if (session_ && !opened_.name.empty()) add_recent(options_.recent_list, opened_.name);
    }
    ~Host() override {
        if (opening_) opening_->stop = true;
    }
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

    /// The session that is shown; this host has none then.
    [[nodiscard]] std::unique_ptr<ViewSession> release() { return std::move(session_); }

    [[nodiscard]] bool has_session() const override { return session_ != nullptr; }
    [[nodiscard]] const OpenedFile& opened() const override { return opened_; }
    [[nodiscard]] std::uintptr_t unsaved_edits() const override {
        return session_ ? reinterpret_cast<std::uintptr_t>(session_->unsaved_edits()) : 0;
    }

    void open(const OpenedFile& file) override {
        if (!options_.open) return;
        if (opening_) opening_->stop = true;
        opening_.reset();  // waits for it
        opening_ = std::make_unique<Opening>();
        opening_->file = file;
        opening_->session = std::async(std::launch::async, [at = opening_.get(), &read = options_.open] {
            CancelFlag progress(at->stop, [at](std::string_view stage, double fraction) {
                const std::scoped_lock lock(at->mutex);
                at->work.stage = stage;
                at->work.fraction = fraction;
            });
            return read(at->file, &progress);
        });
    }

    void stop() override {
        if (opening_)
            opening_->stop = true;
        else if (session_)
            (void)run("{\"stop\": true}");
    }

    [[nodiscard]] WindowWork work() const override {
        if (opening_) {
            const std::scoped_lock lock(opening_->mutex);
            const std::string stage = opening_->work.stage;
            return {"opening " + opening_->file.name + (stage.empty() ? "" : ": " + stage), opening_->work.fraction,
                    opening_->since.seconds()};
        }
        if (!session_) return {};
        const auto [stage, fraction, seconds] = session_->work();
        return {stage, fraction, seconds};
    }

    [[nodiscard]] std::vector<std::string> recent() const override { return recent_files(options_.recent_list); }
    [[nodiscard]] const std::vector<std::string>& extensions() const override { return options_.extensions; }
    [[nodiscard]] const std::vector<std::string>& models() const override { return options_.models; }
    [[nodiscard]] std::vector<std::string> notes() const override {
        return session_ ? session_->source().notes : std::vector<std::string>{};
    }

    [[nodiscard]] const ViewState& state() const override {
        static const ViewState kNone;
        return session_ ? session_->state() : kNone;
    }

    [[nodiscard]] std::string run(const std::string& action) override {
        if (!session_) return {};
        try {
            session_->start(action);
        } catch (const Error& error) {
            return error.what();
        }
        return {};
    }

    [[nodiscard]] std::string settle() override {
        try {
            if (opening_ && opening_->session.wait_for(std::chrono::seconds(0)) == std::future_status::ready) take_opened();
            if (session_) session_->settle();
        } catch (const Error& error) {
            return error.what();
        } catch (const std::exception& error) {  // a file may be anything
            return error.what();
        }
        return {};
    }

    [[nodiscard]] WindowLook& look() override { return session_ ? session_->look() : look_; }

    [[nodiscard]] bool take_picture(ScreenPicture& picture) override {
        const ViewState& state = session_->state();
        const Seen now{session_->pictures(), opened_count_, state.slider, state.difference, state.compare};
        const auto latest = session_->worker().latest();
        if (!latest || now == seen_) return false;
        seen_ = now;
        const Image image = session_->composed(*latest);
        picture.width = image.width;
        picture.height = image.height;
        picture.scale = latest->scale;
        picture.rgba = screen_pixels(image, background_of(state));
        ++picture.number;
        return true;
    }

    [[nodiscard]] bool busy() const override { return opening_ || (session_ && session_->busy()); }
    [[nodiscard]] bool shows_reference() const override { return session_ && session_->shows_reference(); }
    [[nodiscard]] std::string problem() const override { return session_ ? session_->worker().error().value_or("") : ""; }

    [[nodiscard]] std::string figures() const override {
        const auto latest = session_->worker().latest();
        if (!latest) return "drawing ...";
        const Method method = latest->state.method;
        const bool cells = method == Method::Dense || method == Method::Grid;
        const std::string things = latest->is_boundary     ? " points of the boundary"
                                   : draws_kernels(method) ? " kernels"
                                   : cells                 ? " small cells"
                                                           : " tetrahedra";
        std::string text = std::to_string(latest->points) + things + "   " + fixed_text(1e3 * latest->seconds_draw, 0) +
                           " ms   " + std::string(name_of(method)) + ", " + latest->backend + "   " +
                           std::to_string(latest->image.width) + " x " + std::to_string(latest->image.height);
        if (latest->scale > 1) text += "   coarse";
        if (const auto& apart = session_->compared())
            text = "PSNR " + (std::isfinite(apart->psnr) ? fixed_text(apart->psnr, 1) + " dB" : "infinite") + "   FLIP " +
                   fixed_text(apart->flip, 4) + "   " + text;
        return text;
    }

    [[nodiscard]] std::vector<std::string> fields() const override { return session_->fields(); }
    [[nodiscard]] std::vector<std::string> methods() const override { return session_->methods(); }
    [[nodiscard]] std::vector<std::string> maps() const override { return transfer_function_names(); }
    [[nodiscard]] const std::vector<double>& times() const override { return session_->source().times; }
    [[nodiscard]] ValueRange field_range() const override { return session_->body().range; }
    [[nodiscard]] ValueRange shown_range() const override {
        return session_->state().look.range.value_or(session_->body().range);
    }

    [[nodiscard]] std::vector<double> histogram(const ValueRange& range, std::size_t bins) const override {
        std::vector<double> counts(bins);
        const double width = range.max - range.min;
        for (const double value : session_->body().mesh.attributes.front().values) {
            if (!(value >= range.min && value <= range.max)) continue;
            const double part = width > 0 ? (value - range.min) / width : 0.5;
            ++counts[std::min(bins - 1, static_cast<std::size_t>(part * static_cast<double>(bins)))];
        }
        return counts;
    }

    [[nodiscard]] std::vector<CurvePlace> curve(const ValueRange& range, std::size_t count) const override {
        const TransferFunction function = optics_of(session_->state(), session_->body()).function();
        std::vector<CurvePlace> places;
        for (std::size_t k = 0; k < count; ++k) {
            const double value =
                range.min + (range.max - range.min) * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
            const Vec3 rgb = color_at(function, value);
            places.push_back({static_cast<float>(srgb_from_linear(rgb.x)), static_cast<float>(srgb_from_linear(rgb.y)),
                              static_cast<float>(srgb_from_linear(rgb.z)), static_cast<float>(alpha_at(function, value))});
        }
        return places;
    }

    [[nodiscard]] std::vector<TransferFunction::OpacityKnot> opacity() const override {
        return optics_of(session_->state(), session_->body()).function().opacity;
    }

    [[nodiscard]] int edit_level() const override { return session_->edit_level(); }
    [[nodiscard]] std::size_t inverted_cells() const override { return session_->inverted_cells().size(); }

    [[nodiscard]] std::vector<Vec3> selected_pixels() const override {
        constexpr std::size_t kMost = 3000;  // more would hide the body
        const Selection& selection = session_->selection();
        const ViewState& state = session_->state();
        const View view = seen_view(state, session_->body());
        const auto count = static_cast<std::size_t>(std::ranges::count_if(selection, [](double share) { return share > 0; }));
        const std::size_t step = count / kMost + 1;
        std::vector<Vec3> pixels;
        std::size_t found = 0;
        for (std::size_t p = 0; p < selection.size(); ++p) {
            if (selection[p] == 0 || found++ % step != 0) continue;
            const Vec3 eye = view.to_eye(session_->handles().points[p]);
            if (!(eye.z > 0)) continue;
            pixels.emplace_back(view.to_pixels(eye), selection[p]);
        }
        return pixels;
    }

    [[nodiscard]] std::vector<CutHandle> cut_handles() const override { return session_->cut_handles(); }

    [[nodiscard]] std::vector<std::string> picked() const override {
        const auto& picked = session_->picked();
        if (!picked) return {};
        const auto three = [](const Vec3& v) {
            return number_text(v.x, 4) + ", " + number_text(v.y, 4) + ", " + number_text(v.z, 4);
        };
        return {session_->body().field() + " " + number_text(picked->value), "at " + three(picked->place),
                "gradient " + three(picked->gradient),
                picked->cell == kNone ? "of the kernels" : "cell " + std::to_string(picked->cell)};
    }

    [[nodiscard]] std::string render_command() const override { return session_->render_command(); }

    [[nodiscard]] bool play_script() override {
        if (ended_ || opening_ || (script_.empty() && !options_.window_shot)) return false;
        if (next_ < script_.size()) {
            if (!session_ || session_->busy()) return false;  // each action is seen, and `wait` needs no more
            session_->run_numbered(script_[next_], next_ + 1, options_.script_file);
            ++next_;
            return false;
        }
        if (busy()) return false;
        ended_ = true;
        return static_cast<bool>(options_.window_shot);
    }

    void save_window(int width, int height, const std::vector<std::uint8_t>& pixels) override {
        Image image(width, height);
        for (std::size_t p = 0; p < image.rgba.size() / 4; ++p) {
            for (std::size_t c = 0; c < 3; ++c)
                image.rgba[4 * p + c] = static_cast<float>(linear_from_srgb(pixels[3 * p + c] / 255.0));
            image.rgba[4 * p + 3] = 1;
        }
        options_.window_shot(image);
    }

private:
    /// What the picture on the screen was made of.
    struct Seen {
        std::uint64_t pictures = 0, opened = 0;
        double slider = 0;
        bool difference = false;
        std::optional<Method> compare{};
        bool operator==(const Seen&) const = default;
    };

    /// A file that is being read.
    struct Opening {
        OpenedFile file{};
        std::atomic<bool> stop = false;
        Stopwatch since{};
        mutable std::mutex mutex{};  // guards `work`
        WindowWork work{};
        std::future<std::unique_ptr<ViewSession>> session{};  // the last member: it ends first
    };

    /// Shows the file that has been read. Of the same file with other options the view stays.
    void take_opened() {
        const std::unique_ptr<Opening> ready = std::move(opening_);
        std::unique_ptr<ViewSession> next;
        try {
            next = ready->session.get();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) return;
            throw;
        }
        next->look() = look();
        if (session_ && ready->file.name == opened_.name) next->take_state(*session_);
        session_ = std::move(next);
        opened_ = ready->file;
        ++opened_count_;
        add_recent(options_.recent_list, opened_.name);
    }

    std::unique_ptr<ViewSession> session_;
    const WindowOptions& options_;
    OpenedFile opened_;
    std::uint64_t opened_count_ = 0;
    WindowLook look_{};  // without a session
    std::unique_ptr<Opening> opening_{};
    std::vector<std::string> script_;
    std::size_t next_ = 0;
    bool ended_ = false;
    Seen seen_{};
};

}  // namespace

std::unique_ptr<WindowHost> detail::window_host(std::unique_ptr<ViewSession> session, const WindowOptions& options) {
    return std::make_unique<Host>(std::move(session), options);
}

std::unique_ptr<ViewSession> open_view_window(std::unique_ptr<ViewSession> session, const WindowOptions& options) {
#ifdef SUBVOL_WITH_WINDOW
    using ModuleEntry = const WindowFunctions* (*)();
    Host host(std::move(session), options);
    const WindowFunctions& window = *reinterpret_cast<ModuleEntry>(load_module("window", "a window"))();
    const auto missing = window.run(host, {options.width, options.height, options.title.c_str()});
    if (missing) throw Error(ErrorCode::MissingCapability, *missing, "view", "--script and --screenshot need no window");
    return host.release();
#else
    (void)session;
    (void)options;
    throw Error(ErrorCode::MissingCapability, "this program was built without GLFW and Dear ImGui, so it has no window", "view",
                "--script and --screenshot need none");
#endif
}

}  // namespace subvol
