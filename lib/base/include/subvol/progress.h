// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace subvol {

struct Image;

/// Receives the progress of long work. Long calls take a `Progress*`, which may be null.
///
/// Thread-safety: `report` may be called from any thread, one call at a time.
class Progress {
public:
    virtual ~Progress() = default;

    /// stage: a short noun phrase ("refine level 2"); fraction: of that stage, in [0,1]
    virtual void report(std::string_view stage, double fraction) = 0;

    /// A picture in progress: what has been drawn so far, in the requested size. Valid only during the call.
    virtual void picture(const Image& /*image*/) {}

    /// True once the caller wants the work to stop; the work then throws Error(Cancelled) soon.
    [[nodiscard]] virtual bool cancelled() const { return false; }
};

/// Reports to `progress` unless it is null.
///
/// throws: Error(Cancelled) if `progress` is cancelled
void report_progress(Progress* progress, std::string_view stage, double fraction);
/// The fraction is that of the things that are done, of so many.
void report_progress(Progress* progress, std::string_view stage, std::size_t done, std::size_t all);

}  // namespace subvol
