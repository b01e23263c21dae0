// SPDX-License-Identifier: Apache-2.0
#include "xdmf_path.h"

#include <algorithm>
#include <charconv>

#include "trimmed.h"

namespace subvol::detail {

namespace {

// One of: the place among the elements that passed the tests before, from 1; a value of an attribute; a choice of names.
struct PathTest {
    std::size_t number = 0;
    std::string_view attribute, value;
    std::vector<std::string_view> names;
};

struct PathStep {
    std::string_view name;  // or *
    std::vector<PathTest> tests;
};

bool is_path_name(std::string_view name) {
    return !name.empty() && name.find_first_of("()[]@=\"' \t\r\n|.") == std::string_view::npos;
}

std::optional<PathTest> parse_test(std::string_view text) {
    PathTest test;
    text = trimmed(text);
    if (text.starts_with('@')) {
        const std::size_t equals = text.find('=');
        if (equals == std::string_view::npos) return std::nullopt;
        test.attribute = trimmed(text.substr(1, equals - 1));
        test.value = trimmed(text.substr(equals + 1));
        const bool quoted = test.value.size() > 1 && (test.value.front() == '"' || test.value.front() == '\'') &&
                            test.value.find(test.value.front(), 1) == test.value.size() - 1;
        if (!quoted || !is_path_name(test.attribute)) return std::nullopt;
        test.value = test.value.substr(1, test.value.size() - 2);
        return test;
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), test.number);
    if (error == std::errc() && end == text.data() + text.size()) {
        return test.number > 0 ? std::optional(test) : std::nullopt;
    }
    constexpr std::string_view kSelf = "self::", kOr = " or ";
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t end_of_name = std::min(rest.find(kOr), rest.size());
        const std::string_view name = trimmed(rest.substr(0, end_of_name));
        if (!name.starts_with(kSelf) || !is_path_name(name.substr(kSelf.size()))) return std::nullopt;
        test.names.push_back(name.substr(kSelf.size()));
        rest.remove_prefix(std::min(end_of_name + kOr.size(), rest.size()));
    }
    if (test.names.empty()) return std::nullopt;
    return test;
}

// The end of a test in brackets; what is in quotes may have brackets.
std::size_t end_of_test(std::string_view text) {
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (quote != 0) {
            if (text[i] == quote) quote = 0;
        } else if (text[i] == '"' || text[i] == '\'') {
            quote = text[i];
        } else if (text[i] == ']') {
            return i;
        }
    }
    return std::string_view::npos;
}

// The steps of a path without the slash at its start.
std::optional<std::vector<PathStep>> parse_steps(std::string_view path) {
    std::vector<PathStep> steps;
    while (true) {
        const std::size_t end = std::min(path.find_first_of("/["), path.size());
        PathStep step{path.substr(0, end), {}};
        if (step.name != "*" && !is_path_name(step.name)) return std::nullopt;
        path.remove_prefix(end);
        while (path.starts_with('[')) {
            path.remove_prefix(1);
            const std::size_t close = end_of_test(path);
            if (close == std::string_view::npos) return std::nullopt;
            auto test = parse_test(path.substr(0, close));
            if (!test) return std::nullopt;
            step.tests.push_back(std::move(*test));
            path.remove_prefix(close + 1);
        }
        steps.push_back(std::move(step));
        if (path.empty()) return steps;
        if (!path.starts_with('/')) return std::nullopt;
        path.remove_prefix(1);
    }
}

// Adds the children of an element that a step takes.
void take_step(const pugi::xml_node& parent, const PathStep& step, std::vector<std::size_t>& passed,
               std::vector<pugi::xml_node>& taken, std::size_t& visited) {
    passed.assign(step.tests.size(), 0);
    for (const auto& child : parent.children()) {
        ++visited;
        if (child.type() != pugi::node_element) continue;
        const std::string_view name = child.name();
        bool takes = step.name == "*" || name == step.name;
        for (std::size_t t = 0; t < step.tests.size() && takes; ++t) {
            const PathTest& test = step.tests[t];
            ++passed[t];  // of those that passed the earlier tests
            ++visited;
            if (test.number > 0) {
                takes = passed[t] == test.number;
            } else if (!test.names.empty()) {
                takes = std::ranges::find(test.names, name) != test.names.end();
            } else {
                const auto attribute = child.find_attribute([&](const pugi::xml_attribute& other) {
                    ++visited;
                    return std::string_view(other.name()) == test.attribute;
                });
                takes = attribute && std::string_view(attribute.value()) == test.value;
            }
        }
        if (takes) taken.push_back(child);
    }
}

}  // namespace

std::optional<std::vector<pugi::xml_node>> follow_path(const pugi::xml_node& document, std::string_view path,
                                                       std::size_t& visited) {
    constexpr std::size_t kLongest = 1000;
    const bool anywhere = path.starts_with("//");
    if (!path.starts_with('/') || path.size() > kLongest) return std::nullopt;
    const auto steps = parse_steps(path.substr(anywhere ? 2 : 1));
    if (!steps) return std::nullopt;
    std::vector<pugi::xml_node> here{document}, next;
    for (std::size_t k = 0; anywhere && k < here.size(); ++k) {  // each level after the one above it
        for (const auto& child : here[k].children()) {
            ++visited;
            if (child.type() == pugi::node_element) here.push_back(child);
        }
    }
    std::vector<std::size_t> passed;
    for (const PathStep& step : *steps) {
        next.clear();
        for (const auto& parent : here) take_step(parent, step, passed, next, visited);
        std::swap(here, next);
    }
    std::ranges::stable_sort(here, {}, [](const pugi::xml_node& node) { return node.offset_debug(); });
    return here;
}

}  // namespace subvol::detail
