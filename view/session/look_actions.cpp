// SPDX-License-Identifier: Apache-2.0
// Actions that choose what is shown, by which method, in which colours.
#include <utility>

#include "subvol/error.h"
#include "subvol/option.h"
#include "view_actions.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

constexpr int kLargestSide_px = 8192;

/// Three parts from 0 to 1, or none.
std::optional<Vec3> color(const Json& value) {
    if (value.is_null()) return {};
    for (const Json& part : value) (void)number(part, 0, 1);
    return vector(value);
}

Method method_of(const Json& name, const Session& session) {
    return named<Method>(word_of(name, methods_of(*session.body)), "method");
}

}  // namespace

void field(Session& session, const Json& name) {
    const std::string before = std::exchange(session.state.field, word(name));
    try {
        session.choose_body();
    } catch (...) {
        session.state.field = before;
        throw;
    }
    session.show();
}

void step(Session& session, const Json& value) {
    const auto steps = static_cast<int>(session.source.times.size());
    const auto wanted = static_cast<std::size_t>(whole_number(value, 0, steps - 1));
    if (wanted == session.state.step) return;
    session.take_step(wanted, session.source.read(wanted));
}

void size(Session& session, const Json& value) {
    const auto n = numbers(value, 2);
    edit_state(session, [&](ViewState& next) {
        next.width = whole_number(value[0], 1, kLargestSide_px);
        next.height = whole_number(value[1], 1, kLargestSide_px);
    });
}

void method(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) { next.method = method_of(name, session); });
}

void look(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) { next.look.look = named<Look>(word_of(name, names_of<Look>()), "look"); });
}

void tf(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) { next.look.colors = readable_word(name); });
}

void range(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.look.range.reset();
        next.look.stretch = !value.is_null();
        if (value.is_null() || value == "field") return;
        const auto ends = numbers(value, 2);
        if (!(ends[0] < ends[1])) throw Error(ErrorCode::InvalidInput, "is not ascending", {}, "[MIN, MAX]");
        next.look.range = ValueRange{ends[0], ends[1]};
    });
}

void opacity(Session& session, const Json& value) {
    if (!value.is_array()) throw Error(ErrorCode::InvalidInput, "is not an array", {}, "[[VALUE, OPACITY], ...]");
    edit_state(session, [&](ViewState& next) {
        next.look.opacity.clear();
        for (const Json& knot : value) {
            const auto pair = numbers(knot, 2);
            next.look.opacity.push_back({pair[0], number(knot[1], 0, 1)});
        }
    });
}

void log(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        ColorScale& scale = next.look.shape.scale;
        scale.where = "log";
        scale.logarithmic = flag(value);
        if (scale.logarithmic) scale.linear_within = 0;
    });
}

void symlog(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        ColorScale& scale = next.look.shape.scale;
        scale.linear_within = value.is_null() ? 0 : number(value, 1e-300, 1e300);
        if (!value.is_null()) scale.logarithmic = false;
    });
}

void bands(Session& session, const Json& value) {
    edit_state(session,
               [&](ViewState& next) { next.look.shape.bands = value.is_null() ? 0 : whole_number(value, 1, kMostBands); });
}

void below(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.look.shape.below = color(value); });
}

void above(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.look.shape.above = color(value); });
}

void opacity_unit(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.look.opacity_unit_world.reset();
        if (!value.is_null()) next.look.opacity_unit_world = number(value, 1e-18, kMostWorld);
    });
}

void clamp(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.look.clamp = flag(value); });
}

void background(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.background = color(value); });
}

void axes(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.axes = flag(value); });
}

void edges(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.edges = flag(value);
        if (next.edges && session.body->points.volume) throw Error(ErrorCode::InvalidInput, "points have no control mesh");
    });
}

void legend(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.legend = flag(value); });
}

void inverted(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.inverted = flag(value); });
}

/// Streamlines and arrows, by the options of the command; no options: none are drawn.
void flow(Session& session, const Json& value) {
    ViewFlow next;
    const std::vector<Option> options = options_of(next.chosen);
    if (!value.is_object()) refuse(value, R"(an object with options of streamlines, as {"streamlines": "U"})");
    for (const auto& [key, given] : value.items()) {
        if (key == "seeds") {
            for (const Json& places : given.is_array() ? given : Json::array({given})) next.seeds.push_back(word(places));
            continue;
        }
        const auto option = std::ranges::find(options, key, &Option::name);
        if (option == options.end()) {
            std::vector<std::string> known{"seeds"};
            for (const Option& one : options) known.push_back(one.name);
            throw Error(ErrorCode::InvalidInput, "the key " + in_quotes(key) + " is not known" + did_you_mean(key, known));
        }
        option->read(given.is_string() ? word(given) : given.dump(), key);
    }
    if (next.chosen.streamlines.empty() && !next.seeds.empty())
        throw Error(ErrorCode::InvalidInput, "has no effect without streamlines", "seeds");
    std::swap(session.state.flow, next);
    try {
        session.choose_body();
    } catch (...) {
        std::swap(session.state.flow, next);
        throw;
    }
    session.show();
}

void compare(Session& session, const Json& name) {
    session.state.compare = name.is_null() ? std::nullopt : std::optional(method_of(name, session));
    session.show_reference();
}

void slider(Session& session, const Json& value) {
    session.state.slider = number(value, 0, 1);
}

void difference(Session& session, const Json& value) {
    session.state.difference = flag(value);
}

}  // namespace subvol::detail
