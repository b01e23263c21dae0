// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace subvol::cli {

/// After this call SIGINT (Ctrl-C), SIGTERM and SIGHUP ask the running work to stop; a second signal of the same kind ends the
/// program at once. A signal that was ignored, as under nohup, stays ignored. SIGPIPE ends the program at once,
/// without its unfinished files. A `silent` process says nothing when it ends so: another one speaks for all.
void catch_interrupts(bool silent);

/// After this call a failure that no code can catch ends the program with a sentence and without its unfinished files. An
/// exception that is thrown where it cannot be caught, and abort(), which libraries call when they are out of memory, end it
/// with exit code 3. A crash, which is a fault of the program or of a library, still ends it by its signal.
void catch_failures();

/// After an interrupt the work has this long to stop by itself. Then the program ends in the midst of it, without its
/// unfinished files.
inline constexpr int kGrace_ms = 300;

/// What standard output gets if the program ends in the midst of its work: the object of --json, for its exit code.
void say_when_interrupted(const std::function<std::string(int code)>& json);

/// Says the program's last words: an interrupt waits for them, and adds none. Words that follow are said, too.
void say_at_last(const std::function<void()>& say);

/// While it exists, the program waits for a child that was told to stop: twice the time.
class WaitsForChild {
public:
    WaitsForChild();
    ~WaitsForChild();
    WaitsForChild(const WaitsForChild&) = delete;
    WaitsForChild& operator=(const WaitsForChild&) = delete;
};

/// The signal that asked the work to stop; 0: none.
[[nodiscard]] int interrupt_signal();

}  // namespace subvol::cli
