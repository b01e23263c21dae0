// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <utility>

namespace subvol::detail {

/// Values by their keys: each is made when it is first asked for, and then shared. Thread-safe; `make` may ask for other keys.
template <class Key, class Value>
class Kept {
public:
    template <class Make>
    const Value& get(const Key& key, const Make& make) {
        const std::scoped_lock lock(mutex_);
        if (const auto found = values_.find(key); found != values_.end()) return found->second;
        Value value = make();
        return values_.emplace(key, std::move(value)).first->second;
    }

private:
    std::recursive_mutex mutex_;
    std::map<Key, Value> values_;
};

}  // namespace subvol::detail
