// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace subvol {

struct Image;

/// Where long work tells how far it is. Long calls take a `Progress*`; null means that nobody listens.
///
/// Thread-safety: `report` may be called from any thread, one call at a time.
class Progress {
public:
    virtual ~Progress() = default;

    /// stage: a short noun phrase ("refine level 2"); fraction: of that stage, in [0,1]
    virtual void report(std::string_view stage, double fraction) = 0;

    /// A picture on its way: what has been drawn so far, of the size asked for. Valid during the call.
    virtual void picture(const Image& /*image*/) {}

    /// True once the caller wants the work to stop; the work then throws Error(Cancelled) soon.
    [[nodiscard]] virtual bool cancelled() const { return false; }
};

/// Reports to `progress`, if there is one, and throws Error(Cancelled) if its owner wants to stop.
void report_progress(Progress* progress, std::string_view stage, double fraction);

}  // namespace subvol
