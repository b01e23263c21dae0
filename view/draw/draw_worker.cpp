// SPDX-License-Identifier: Apache-2.0
#include "subvol/draw_worker.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "cancel_flag.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kCoarse_s = 0.05;               // within this time of a motion there should be a picture
constexpr std::chrono::milliseconds kPause{20};  // of a motion, before the full picture is begun
constexpr int kFinest = 2, kCoarsest = 16;

}  // namespace

struct DrawWorker::State {
    struct Request {
        ViewState state{};
        std::shared_ptr<const ViewBody> body{};
        Stopwatch since{};
        std::uint64_t serial = 0;
    };

    State(const MethodOptions& settings, std::function<void()> wake) : drawer(settings), on_picture(std::move(wake)) {}

    void work(const std::stop_token& stop) {
        std::unique_lock lock(mutex);
        while (changed.wait(lock, stop, [&] { return next.has_value(); })) {
            const Request request = std::move(*next);
            next.reset();
            abandon = given_up = stopped = false;
            doing = {"draw", 0};
            since = request.since;
            drawing = true;
            lock.unlock();
            run(request);
            lock.lock();
            drawing = false;
            done.notify_all();
        }
    }

    void run(const Request& request) {
        const auto listen = [this](std::string_view stage, double fraction) {
            const std::scoped_lock lock(mutex);
            doing.stage = stage;
            doing.fraction = fraction;
        };
        CancelFlag when_given_up(given_up, listen), when_newer(abandon, listen);
        try {
            DrawTimes taken{.coarse_scale = coarse_scale};
            const double before = request.since.seconds();
            auto coarse = drawer.draw(request.state, request.body, coarse_scale, &when_given_up);  // not given up: things move
            taken.first = request.since.seconds();
            taken.boundary = coarse.seconds_boundary;
            taken.kernels = coarse.seconds_kernels;
            taken.draw = coarse.seconds_draw;
            adapt(taken.first - before - coarse.seconds_build);
            publish(std::move(coarse), taken, request.serial);
            if (moves_on()) return;
            auto whole = drawer.draw(request.state, request.body, 1, &when_newer);
            taken.kernels += whole.seconds_kernels;
            taken.full = request.since.seconds();
            publish(std::move(whole), taken, request.serial);
        } catch (const Error& thrown) {
            if (thrown.code() != ErrorCode::Cancelled || was_stopped()) fail(thrown.what());
        } catch (const std::exception& thrown) {
            fail(thrown.what());
        }
    }

    /// Whether the next request comes at once, as while something is dragged: a full picture would be given up, which takes
    /// time.
    [[nodiscard]] bool moves_on() {
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, kPause, [&] { return next.has_value() || quit; });
    }

    [[nodiscard]] bool was_stopped() {
        const std::scoped_lock lock(mutex);
        return stopped && !next;
    }

    /// Coarse pictures get coarser while they take too long, and finer while there is much time left.
    void adapt(double seconds) {
        if (seconds > kCoarse_s) coarse_scale = std::min(kCoarsest, 2 * coarse_scale);
        if (seconds < 0.2 * kCoarse_s) coarse_scale = std::max(kFinest, coarse_scale / 2);
    }

    void publish(DrawnPicture picture, const DrawTimes& taken, std::uint64_t serial) {
        {
            const std::scoped_lock lock(mutex);
            latest = std::make_shared<const DrawnPicture>(std::move(picture));
            ++count;
            error.reset();
            times = taken;
            shown = serial;
            if (latest->scale == 1) full = latest;
        }
        done.notify_all();
        if (on_picture) on_picture();
    }

    void fail(const std::string& what) {
        {
            const std::scoped_lock lock(mutex);
            error = what;
            failure = std::current_exception();
        }
        if (on_picture) on_picture();
    }

    PictureDrawer drawer;  // of the thread
    std::function<void()> on_picture;
    int coarse_scale = 4;

    std::mutex mutex{};  // guards what follows
    std::condition_variable_any changed{}, done{};
    std::optional<Request> next{};
    bool drawing = false, stopped = false;
    std::atomic<bool> abandon = false, given_up = false, quit = false;
    Work doing{};
    Stopwatch since{};
    std::shared_ptr<const DrawnPicture> latest{}, full{};
    std::uint64_t count = 0, asked = 0, shown = 0;
    std::optional<std::string> error{};
    std::exception_ptr failure{};
    DrawTimes times{};
    std::jthread thread{};
};

DrawWorker::DrawWorker(const MethodOptions& settings, std::function<void()> on_picture)
    : state_(std::make_unique<State>(settings, std::move(on_picture))) {
    state_->thread = std::jthread([state = state_.get()](const std::stop_token& stop) { state->work(stop); });
}

DrawWorker::~DrawWorker() {
    {
        const std::scoped_lock lock(state_->mutex);
        state_->next.reset();
        state_->abandon = state_->given_up = state_->quit = true;
        state_->changed.notify_all();
    }
    state_->thread.request_stop();
    state_->thread.join();
}

void DrawWorker::show(const ViewState& state, std::shared_ptr<const ViewBody> body) {
    const std::scoped_lock lock(state_->mutex);
    state_->next = State::Request{state, std::move(body), {}, ++state_->asked};
    state_->abandon = true;
    state_->error.reset();
    state_->failure = nullptr;
    state_->full.reset();
    state_->changed.notify_all();
}

DrawWorker::Work DrawWorker::work() const {
    const std::scoped_lock lock(state_->mutex);
    if (!state_->drawing) return {};
    Work work = state_->doing;
    work.seconds = state_->since.seconds();
    return work;
}

void DrawWorker::stop() {
    const std::scoped_lock lock(state_->mutex);
    if (!state_->drawing) return;
    state_->next.reset();
    state_->abandon = state_->given_up = state_->stopped = true;
}

std::shared_ptr<const DrawnPicture> DrawWorker::latest() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->latest;
}

std::uint64_t DrawWorker::count() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->count;
}

bool DrawWorker::busy() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->drawing || state_->next.has_value();
}

std::optional<std::string> DrawWorker::error() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->error;
}

DrawTimes DrawWorker::times() const {
    const std::scoped_lock lock(state_->mutex);
    return state_->times;
}

void DrawWorker::wait_first() const {
    std::unique_lock lock(state_->mutex);
    state_->done.wait(lock, [&] { return state_->shown == state_->asked || (!state_->drawing && !state_->next); });
}

std::shared_ptr<const DrawnPicture> DrawWorker::wait() const {
    std::unique_lock lock(state_->mutex);
    state_->done.wait(lock, [&] { return !state_->drawing && !state_->next; });
    if (state_->failure) std::rethrow_exception(state_->failure);
    return state_->full;
}

}  // namespace subvol
