// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "subvol/picture_drawer.h"

namespace subvol {

/// Seconds from a request to its first picture, however coarse, and to the full one.
struct DrawTimes {
    double first = 0, full = 0;
    int coarse_scale = 0;
    double boundary = 0, kernels = 0, draw = 0;  // of the first picture; kernels of the full one if the first has none
};

/// Draws on a thread of its own, always the newest state: first a coarse picture, then the full one. A picture that a newer
/// request makes useless is given up.
class DrawWorker {
public:
    /// on_picture: called from the thread after each picture and each error, so that a window can wake up
    explicit DrawWorker(const MethodOptions& settings, std::function<void()> on_picture = {});
    ~DrawWorker();
    DrawWorker(const DrawWorker&) = delete;
    DrawWorker& operator=(const DrawWorker&) = delete;

    /// What is being done.
    struct Work {
        std::string stage{};  ///< as in Progress; empty: nothing is being done
        double fraction = 0;  ///< as in Progress
        double seconds = 0;   ///< since it was asked for
    };
    [[nodiscard]] Work work() const;

    /// Gives up what is being drawn; the last picture stays, and `error` says so.
    void stop();

    /// Returns at once.
    void show(const ViewState& state, std::shared_ptr<const ViewBody> body);

    /// The last picture that was finished; null: none yet.
    [[nodiscard]] std::shared_ptr<const DrawnPicture> latest() const;
    /// How many pictures were finished.
    [[nodiscard]] std::uint64_t count() const;
    /// Whether the newest state has not got its full picture yet.
    [[nodiscard]] bool busy() const;
    /// The error that the newest state led to; none: there is none.
    [[nodiscard]] std::optional<std::string> error() const;
    /// The times of the newest state, as far as it is drawn.
    [[nodiscard]] DrawTimes times() const;

    /// Waits for any picture of the newest state, or its error.
    void wait_first() const;

    /// Waits for the full picture of the newest state.
    ///
    /// throws: the error of drawing it
    [[nodiscard]] std::shared_ptr<const DrawnPicture> wait() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
