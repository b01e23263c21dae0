// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace subvol::cli {

/// From here on SIGINT (Ctrl-C), SIGTERM and SIGHUP ask the running work to stop; a second one of the same kind ends the
/// program at once. One that is ignored, as under nohup, stays so.
void catch_interrupts();

/// The signal that has asked to stop; 0: none has.
[[nodiscard]] int interrupt_signal();

}  // namespace subvol::cli
