// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "bind.h"

namespace subvol::python {
namespace {

using namespace std::chrono_literals;
constexpr auto kLook = 20ms;  // how often signals are looked for, and news are passed on

struct News {
    bool done = false;
    bool fresh = false;
    std::string stage;
    double fraction = 0;
};

/// What the working thread says to the waiting one, and back.
class Wire : public Progress {
public:
    void report(std::string_view stage, double fraction) override {
        const std::lock_guard lock(mutex_);
        news_.stage = stage;
        news_.fraction = fraction;
        news_.fresh = true;
    }
    [[nodiscard]] bool cancelled() const override { return cancelled_; }

    void cancel() { cancelled_ = true; }
    void finish() {
        {
            const std::lock_guard lock(mutex_);
            news_.done = true;
        }
        finished_.notify_one();
    }
    [[nodiscard]] News wait() {
        std::unique_lock lock(mutex_);
        finished_.wait_for(lock, kLook, [&] { return news_.done; });
        News now = news_;
        news_.fresh = false;
        return now;
    }

private:
    std::mutex mutex_;
    std::condition_variable finished_;
    News news_;
    std::atomic<bool> cancelled_ = false;
};

/// Calls Python once: its exception, if there is one.
std::optional<py::error_already_set> pass_on(const py::object& progress, const News& news) {
    const py::gil_scoped_acquire with_gil;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (news.fresh && !progress.is_none()) progress(news.stage, news.fraction);
    } catch (py::error_already_set& error) {
        return std::optional<py::error_already_set>(std::move(error));
    }
    return std::nullopt;
}

}  // namespace

void run(const py::object& progress, const std::function<void(Progress*)>& work) {
    if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0) {
        throw Error(ErrorCode::InvalidInput, "is not callable", "progress",
                    "None, True, or a function of a stage and a fraction");
    }
    Wire wire;
    std::exception_ptr failure;
    std::optional<py::error_already_set> interruption;
    {
        const py::gil_scoped_release without_gil;
        const std::jthread worker([&] {
            try {
                work(&wire);
            } catch (...) {
                failure = std::current_exception();
            }
            wire.finish();
        });
        for (News news = wire.wait();; news = wire.wait()) {
            if (!interruption && (interruption = pass_on(progress, news))) wire.cancel();
            if (news.done) break;
        }
    }
    if (interruption) throw py::error_already_set(std::move(*interruption));
    if (failure) std::rethrow_exception(failure);
}

}  // namespace subvol::python
