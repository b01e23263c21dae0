// SPDX-License-Identifier: Apache-2.0
// The reader of VTKHDF on any datasets: how HDF5's library copes with damaged files is its own matter. A line of the input is a
// dataset: its name, the lengths of its dimensions, a colon, and its values.

#include "vtkhdf/vtkhdf_io.h"

#include <map>
#include <sstream>

#include "input.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

namespace {

class Lines : public detail::Hdf5Source {
public:
    explicit Lines(std::string_view text) {
        std::istringstream in{std::string(text)};
        for (std::string line; std::getline(in, line);) take(line);
    }

    [[nodiscard]] std::vector<std::string> names(const std::string& group) const override {
        std::vector<std::string> names;
        for (const auto& [path, set] : sets_) {
            if (path.starts_with(group + "/") && path.find('/', group.size() + 1) == std::string::npos) {
                names.push_back(path.substr(group.size() + 1));
            }
        }
        return names;
    }
    [[nodiscard]] std::optional<detail::Hdf5Dataset> find(const std::string& path) const override {
        const auto found = sets_.find(path);
        if (found == sets_.end()) return std::nullopt;
        const auto type = path.ends_with("Points") || path.find("Data/") != std::string::npos ? detail::NumberType::Float64
                                                                                              : detail::NumberType::Int64;
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
    [[nodiscard]] std::optional<std::string> text(const std::string&, const std::string&) const override {
        return "UnstructuredGrid";
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
        Set set;
        while (words >> word && word != ":") {
            if (set.lengths.size() < 8) set.lengths.push_back(std::strtoull(word.c_str(), nullptr, 10));
        }
        while (words >> word) set.values.push_back(std::strtod(word.c_str(), nullptr));
        sets_["/VTKHDF/" + name] = set;
    }
    std::map<std::string, Set> sets_;
};

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    return fuzz::run([&] {
        const detail::Hdf5File file(std::make_unique<fuzz::Lines>(fuzz::text_of(data, size)), "file");
        static_cast<void>(detail::vtkhdf_times(file));
        const ReadResult result = detail::read_vtkhdf(file, {});
        validate(result.mesh);
        static_cast<void>(inspect(result.mesh));
    });
}
