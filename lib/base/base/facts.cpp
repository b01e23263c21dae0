// SPDX-License-Identifier: Apache-2.0
#include "subvol/facts.h"

#include <algorithm>

namespace subvol {

Facts::Facts() = default;
Facts::Facts(const Facts&) = default;
Facts::Facts(Facts&&) noexcept = default;
Facts& Facts::operator=(const Facts&) = default;
Facts& Facts::operator=(Facts&&) noexcept = default;
Facts::~Facts() = default;

FactValue& Facts::operator[](std::string_view name) {
    const auto found = std::ranges::find(all_, name, &Fact::name);
    return found != all_.end() ? found->value : all_.emplace_back(Fact{std::string(name), {}}).value;
}

const FactValue* Facts::find(std::string_view name) const {
    const auto found = std::ranges::find(all_, name, &Fact::name);
    return found != all_.end() ? &found->value : nullptr;
}

Facts& Facts::group(std::string_view name) {
    FactValue& fact = (*this)[name];
    if (!std::holds_alternative<Facts>(fact.value)) fact.value = Facts();
    return std::get<Facts>(fact.value);
}

void Facts::add_sentence(std::string_view list, const std::string& sentence) {
    if (sentence.empty()) return;
    FactValue& fact = (*this)[list];
    if (!std::holds_alternative<FactValue::List>(fact.value)) fact.value = FactValue::List();
    auto& sentences = std::get<FactValue::List>(fact.value);
    const auto is_same = [&](const FactValue& other) { return std::get<std::string>(other.value) == sentence; };
    if (std::ranges::none_of(sentences, is_same)) sentences.emplace_back(sentence);
}

void Facts::add_seconds(std::string_view stage, double seconds) {
    FactValue& sum = group("seconds")[stage];
    const double* const before = std::get_if<double>(&sum.value);
    sum = before != nullptr ? *before + seconds : seconds;
}

void Facts::merge(const Facts& other) {
    for (const Fact& fact : other.all_) {
        if (fact.name == "warnings" || fact.name == "notes") {
            for (const FactValue& sentence : std::get<FactValue::List>(fact.value.value))
                add_sentence(fact.name, std::get<std::string>(sentence.value));
        } else if (fact.name == "seconds") {
            for (const Fact& stage : std::get<Facts>(fact.value.value).all_)
                add_seconds(stage.name, std::get<double>(stage.value.value));
        } else {
            (*this)[fact.name] = fact.value;
            std::ranges::find(all_, fact.name, &Fact::name)->unit = fact.unit;
        }
    }
}

bool Facts::empty() const {
    return all_.empty();
}

}  // namespace subvol
