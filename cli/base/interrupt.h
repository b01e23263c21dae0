// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace subvol::cli {

/// After this call SIGINT (Ctrl-C), SIGTERM and SIGHUP ask the running work to stop; a second signal of the same kind ends the
/// program at once. A signal that was ignored, as under nohup, stays ignored.
void catch_interrupts();

/// The signal that asked the work to stop; 0: none.
[[nodiscard]] int interrupt_signal();

}  // namespace subvol::cli
