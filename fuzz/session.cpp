// SPDX-License-Identifier: Apache-2.0
// Scripts of actions, and states (what follows the letter s), run on a small mesh; in a folder of their own, as actions write
// files.

#include "input.h"
#include "view/session/small_sessions.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static const bool in_folder = [] {
        std::filesystem::current_path(fuzz::own_folder());
        return true;
    }();
    fuzz::check(in_folder);
    static const HexMesh mesh = ball_with_height();
    static const ViewState start = small_state(bounds(mesh), {1, -1, .5});
    ViewSession session({.read = [](std::size_t) { return mesh; }}, mesh, start, kByCpu);
    if (size > 0 && data[0] == 's') {
        std::ofstream("state.json", std::ios::binary) << fuzz::text_of(data + 1, size - 1);
        return fuzz::run([&] { session.run(R"({"load_state": "state.json"})"); });
    }
    return fuzz::run([&] {
        for (const std::string& action : ViewSession::split_script(fuzz::text_of(data, size), "script")) session.run(action);
    });
}
