// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "input.h"
#include "subvol/detail/hdf5_file.h"

namespace subvol::fuzz {

/// An HDF5 file as text: how HDF5's library copes with damaged files is its own matter. A line is an object: its name, a label
/// if it has one, the lengths of its dimensions, a colon, and its values, where 'word stands for the letters of the word.
class Lines : public detail::Hdf5Source {
public:
    /// root: the group of the datasets; data: what follows a name that has a label
    Lines(std::string_view text, std::string root, std::string data = {}) : root_(std::move(root)), data_(std::move(data)) {
        std::istringstream in{std::string(text)};
        for (std::string line; std::getline(in, line);) take(line);
    }

    [[nodiscard]] std::vector<std::string> names(const std::string& group) const override {
        std::vector<std::string> names;
        const std::string start = group == "/" ? group : group + "/";
        for (const std::string& path : paths_) {
            if (path.starts_with(start) && path.size() > start.size() && path.find('/', start.size()) == std::string::npos) {
                names.push_back(path.substr(start.size()));
            }
        }
        return names;
    }
    [[nodiscard]] std::optional<detail::Hdf5Dataset> find(const std::string& path) const override {
        const auto found = sets_.find(path);
        if (found == sets_.end()) return std::nullopt;
        const bool real = std::ranges::any_of(found->second.values, [](double value) { return value != std::floor(value); });
        const bool at_places = path.find("PointData/") != std::string::npos || path.find("CellData/") != std::string::npos;
        const auto type =
            real || path.ends_with("Points") || at_places ? detail::NumberType::Float64 : detail::NumberType::Int64;
        return detail::Hdf5Dataset{type, found->second.lengths, 8 * found->second.values.size()};
    }
    [[nodiscard]] std::optional<std::string> values(const std::string& path, const detail::Hdf5Dataset& dataset,
                                                    std::span<const std::size_t> starts,
                                                    std::span<const std::size_t> counts) const override {
        const auto& all = sets_.at(path).values;
        std::size_t row = 1;
        for (std::size_t d = 1; d < counts.size(); ++d) row *= counts[d];
        std::string bytes;
        const std::size_t first = starts.empty() ? 0 : starts[0] * row, count = starts.empty() ? 1 : counts[0] * row;
        for (std::size_t i = first; i < first + count; ++i) {
            const double value = i < all.size() ? all[i] : 0;
            const auto integer = static_cast<std::int64_t>(std::abs(value) < 1e18 ? value : -1);
            bytes.append(dataset.type == detail::NumberType::Float64 ? reinterpret_cast<const char*>(&value)
                                                                     : reinterpret_cast<const char*>(&integer),
                         8);
        }
        return bytes;
    }
    [[nodiscard]] std::optional<std::string> text(const std::string& object, const std::string& attribute) const override {
        if (attribute == "GridDescription") return std::nullopt;
        if (attribute == "Type" && sets_.contains(object + "/Level0/AMRBox")) return "OverlappingAMR";
        const auto found = labels_.find(object);
        return found == labels_.end() ? "UnstructuredGrid" : found->second;
    }
    /// A line for an attribute has an @ before its name.
    [[nodiscard]] std::vector<double> reals(const std::string& object, const std::string& attribute) const override {
        const auto found = sets_.find(object + "/@" + attribute);
        return found == sets_.end() || found->second.values.size() > 16 ? std::vector<double>() : found->second.values;
    }
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string&, const std::string&) const override { return {2, 0}; }

private:
    struct Set {
        std::vector<std::size_t> lengths;
        std::vector<double> values;
    };
    void take(const std::string& line) {
        std::istringstream words(line);
        std::string name, word;
        words >> name;
        const std::string path = root_ + name;
        paths_.insert(path);
        Set set;
        bool labelled = false;
        while (words >> word && word != ":") {
            if (std::isalpha(static_cast<unsigned char>(word.front())) != 0) {
                labels_[path] = word;
                labelled = true;
            } else if (set.lengths.size() < 8) {
                set.lengths.push_back(std::strtoull(word.c_str(), nullptr, 10));
            }
        }
        while (words >> word) {
            if (word.front() == '\'') {
                for (const char c : word.substr(1)) set.values.push_back(c);
            } else {
                set.values.push_back(std::strtod(word.c_str(), nullptr));
            }
        }
        if (!set.lengths.empty()) sets_[labelled ? path + data_ : path] = set;
    }
    std::string root_, data_;
    std::set<std::string> paths_;
    std::map<std::string, Set> sets_;
    std::map<std::string, std::string> labels_;
};

}  // namespace subvol::fuzz
