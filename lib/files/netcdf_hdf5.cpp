// SPDX-License-Identifier: Apache-2.0
// netCDF-4: each variable is a dataset of the root group, and so is each dimension. The dataset of a dimension is a "dimension
// scale"; if there is no variable of that name its own NAME says so, and only its length counts. Names that a dimension and
// another variable share are told apart by a prefix.
#include <algorithm>

#include "hdf5_file.h"
#include "netcdf_source.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostOfDeflate = 1040;  // 1032, and some bytes for the blocks
constexpr std::string_view kNotDimension = "_nc4_non_coord_";
constexpr std::string_view kNoVariable = "This is a netCDF dimension but not a netCDF variable";

class Netcdf4 : public NetcdfSource {
public:
    explicit Netcdf4(const std::filesystem::path& path) : file_(open_hdf5(path), path.string()) {
        std::size_t records = 0;
        std::vector<std::string> unlimited;
        for (const std::string& name : file_.names("/")) {
            const auto found = file_.find("/" + name);
            if (!found) continue;  // a group, or of a user's type
            const bool dimension = file_.text("/" + name, "CLASS") == "DIMENSION_SCALE";
            if (dimension) dimensions.emplace(name, found->lengths.empty() ? 1 : found->lengths[0]);
            if (dimension && found->grows) unlimited.push_back(name);
            if (dimension && file_.text("/" + name, "NAME").value_or("").starts_with(kNoVariable)) continue;
            if (found->grows) records = std::max(records, found->lengths[0]);
            const NetcdfVariable variable{found->type, found->characters, found->grows, found->lengths};
            variables.emplace(name.starts_with(kNotDimension) ? name.substr(kNotDimension.size()) : name, variable);
        }
        // The dataset of an unlimited dimension keeps its first length; the variables grow. Exodus has one such dimension.
        for (const std::string& name : unlimited) dimensions[name] = std::max(dimensions[name], records);
    }

    [[nodiscard]] std::string values(const std::string& variable, std::span<const std::size_t> places) const override {
        const std::string path = path_of(variable);
        const auto dataset = file_.find(path);
        if (!dataset) file_.fail(path + " cannot be read: the file is damaged");
        std::vector<std::size_t> starts(dataset->lengths.size()), counts = dataset->lengths;
        std::copy(places.begin(), places.end(), starts.begin());
        std::fill_n(counts.begin(), places.size(), 1);
        return file_.block(path, *dataset, starts, counts);
    }

    [[nodiscard]] std::string attribute(const std::string& variable, const std::string& name) const override {
        return file_.text(path_of(variable), name).value_or("");
    }

    [[nodiscard]] std::size_t growth() const override { return kMostOfDeflate; }

private:
    [[nodiscard]] std::string path_of(const std::string& variable) const {
        const std::string other = "/" + std::string(kNotDimension) + variable;
        return file_.find(other) ? other : "/" + variable;
    }

    Hdf5File file_;
};

}  // namespace

std::unique_ptr<NetcdfSource> open_netcdf4(const std::filesystem::path& path) {
    return std::make_unique<Netcdf4>(path);
}

}  // namespace subvol::detail
