// SPDX-License-Identifier: Apache-2.0
// netCDF-4: each variable is a dataset of the root group, and so is each dimension. The dataset of a dimension is a "dimension
// scale"; if there is no variable of that name its own NAME says so, and only its length counts. Names that a dimension and
// another variable share are told apart by a prefix.
#include "subvol/detail/netcdf_source.h"

#include <algorithm>
#include <array>
#include <optional>

#include "subvol/detail/hdf5_file.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

namespace {

constexpr std::endian kOrder = std::endian::big;
constexpr std::size_t kPadding = 4;

// The types in the order of their numbers in the format, from 1. Number 2 means characters.
constexpr std::array kTypes{NumberType::Int8,    NumberType::UInt8,   NumberType::Int16, NumberType::Int32,
                            NumberType::Float32, NumberType::Float64, NumberType::UInt8, NumberType::UInt16,
                            NumberType::UInt32,  NumberType::Int64,   NumberType::UInt64};
constexpr std::int64_t kCharacters = 2;

std::size_t padded(std::size_t bytes) {
    return (bytes + kPadding - 1) / kPadding * kPadding;
}

class ClassicNetcdf : public NetcdfSource {
public:
    ClassicNetcdf(std::string_view bytes, std::string_view file) : in_(bytes, file, TextScanner::Comments::None) {
        in_.name_bytes();
        in_.seek(0);
        read_header();
    }

    [[nodiscard]] std::string values(const std::string& name, std::span<const std::size_t> places) const override {
        const NetcdfVariable& variable = variables.find(name)->second;
        TextScanner in = in_;
        const std::size_t size = size_of(variable.type), end = in.size();
        const auto expect = [&](bool within) {
            if (!within) in.fail_at(std::min(variable.begin, end), "values go beyond the end of the file");
        };
        std::size_t offset = 0, count = 1;
        for (std::size_t d = variable.record ? 1 : 0; d < variable.lengths.size();
             ++d) {  // the first dimension is that of the records
            const std::size_t length = variable.lengths[d];
            expect(length == 0 || offset <= end / length);
            offset = offset * length + (d < places.size() ? places[d] : 0);
            if (d >= places.size()) count *= length;
        }
        const std::size_t record = variable.record ? places[0] : 0;
        expect(variable.begin <= end && (record == 0 || record_bytes_ <= (end - variable.begin) / record));
        const std::size_t begin = variable.begin + record * record_bytes_;
        expect(offset <= end && offset + count <= (end - begin) / size);
        // Variables may lie at the same place.
        named_.take({}, in.size(), count * size, [&] { return in.place_of(std::min(variable.begin, end)); });
        in.seek(begin + offset * size);
        std::string bytes(in.bytes(count * size, {"values"}));
        if (std::endian::native == kOrder) return bytes;
        for (std::size_t v = 0; v < bytes.size(); v += size) {
            const auto value = bytes.data() + v;
            std::reverse(value, value + size);
        }
        return bytes;
    }

    [[nodiscard]] std::string attribute(const std::string& variable, const std::string& name) const override {
        const auto found = texts_.find({variable, name});
        return found == texts_.end() ? std::string() : found->second;
    }

    [[nodiscard]] std::size_t growth() const override { return 1; }

private:
    void read_header() {
        const std::string_view magic = in_.bytes(4, {"version"});
        version_ = magic[3];
        if (version_ != 1 && version_ != 2 && version_ != 5)
            in_.fail("this version of netCDF's classic format is not supported");
        const std::int64_t records = number({"records"});
        read_list(Tag::Dimensions, "dimensions", [&] { read_dimension(); });
        read_list(Tag::Attributes, "attributes", [&] { read_attribute(); });
        read_list(Tag::Variables, "variables", [&] { read_variable(); });
        find_records(records);
    }

    // A number in a list or a length: 4 bytes, in version 5 8.
    std::int64_t number(const Place& place) {
        const NumberType type = version_ == 5 ? NumberType::Int64 : NumberType::Int32;
        return integer_from(in_.bytes(size_of(type), place), type, kOrder);
    }
    std::size_t count(const Place& place) {
        const std::int64_t value = number(place);
        if (value < 0) in_.fail("netCDF: negative count");
        return static_cast<std::size_t>(value);
    }
    std::int64_t tag() { return integer_from(in_.bytes(4, {"list"}), NumberType::Int32, kOrder); }

    enum Tag : std::int64_t { Dimensions = 10, Variables = 11, Attributes = 12 };

    // Each element takes at least a byte of the file, so the loop ends.
    template <class ReadElement>
    void read_list(Tag expected, std::string_view what, const ReadElement& read_element) {
        const std::int64_t found = tag();
        const std::size_t elements = count({what});
        if (found == 0 && elements == 0) return;
        if (found != expected) in_.fail("netCDF: a list of " + std::string(what) + " is expected here");
        for (std::size_t e = 0; e < elements; ++e) read_element();
    }

    std::string name() {
        const std::size_t length = count({"name"});
        std::string text(in_.bytes(length, {"name"}));
        in_.bytes(padded(length) - length, {"name"});
        return text;
    }

    void read_dimension() {
        const std::string name = this->name();
        lengths_.push_back(count({"length of a dimension"}));
        names_.push_back(name);
        if (lengths_.back() == 0) unlimited_ = lengths_.size() - 1;
        dimensions.emplace(name, lengths_.back());
    }

    NumberType type(std::int64_t number) const {
        if (number >= 1 && number <= static_cast<std::int64_t>(kTypes.size()))
            return kTypes[static_cast<std::size_t>(number - 1)];
        in_.fail("netCDF: there is no type " + std::to_string(number));
    }

    // Reads the name and the text of an attribute; no text if it consists of numbers.
    std::pair<std::string, std::optional<std::string>> read_attribute() {
        const std::string name = this->name();
        const std::int64_t kind = tag();
        const std::size_t values = count({"attribute"}), size = size_of(type(kind));
        if (values > in_.bytes_left() / size) in_.fail("netCDF: an attribute goes beyond the end of the file");
        const std::string text(in_.bytes(values * size, {"attribute"}));
        in_.bytes(padded(values * size) - values * size, {"attribute"});
        return {name, kind == kCharacters ? std::optional(text) : std::nullopt};
    }

    void read_variable() {
        const std::string name = this->name();
        NetcdfVariable variable;
        const std::size_t rank = count({"dimensions of a variable"});
        for (std::size_t d = 0; d < rank; ++d) {
            const std::size_t dimension = count({"dimension of a variable"});
            if (dimension >= lengths_.size()) in_.fail("netCDF: there is no dimension " + std::to_string(dimension));
            if (d == 0 && dimension == unlimited_) variable.record = true;
            variable.lengths.push_back(lengths_[dimension]);
        }
        read_list(Tag::Attributes, "attributes", [&] {
            const auto [key, text] = read_attribute();
            if (text) texts_.try_emplace({name, key}, *text);
        });
        const std::int64_t kind = tag();
        variable.type = type(kind);
        variable.characters = kind == kCharacters;
        count({"size of a variable"});
        const NumberType offset = version_ == 1 ? NumberType::Int32 : NumberType::Int64;
        const std::int64_t begin = integer_from(in_.bytes(size_of(offset), {"begin of a variable"}), offset, kOrder);
        if (begin < 0) in_.fail("netCDF: a variable has a negative position");
        variable.begin = static_cast<std::size_t>(begin);
        variables.emplace(name, variable);
    }

    // A record has the values of each variable at one place of the unlimited dimension; it cannot be longer than the file.
    void find_records(std::int64_t announced) {
        std::size_t first = in_.size(), all = 0, last = 0;
        for (const auto& [name, variable] : variables) {
            if (!variable.record) continue;
            last = size_of(variable.type);
            for (std::size_t d = 1; d < variable.lengths.size(); ++d) {
                const std::size_t length = variable.lengths[d];
                if (length > 0 && last > in_.size() / length) in_.fail("netCDF: a record is longer than the file");
                last *= length;
            }
            first = std::min(first, variable.begin);
            record_bytes_ += padded(last);
            ++all;
        }
        if (all == 1) record_bytes_ = last;  // the only variable is not padded
        // A file that was written as a stream does not have the number of records.
        std::size_t records = 0;
        if (announced >= 0) records = static_cast<std::size_t>(announced);
        if (announced < 0 && record_bytes_ > 0) records = (in_.size() - first) / record_bytes_;
        for (auto& [name, variable] : variables) {
            if (variable.record) variable.lengths[0] = records;
        }
        if (unlimited_) dimensions[names_[*unlimited_]] = records;
    }

    TextScanner in_;
    char version_ = 0;
    std::vector<std::size_t> lengths_;  // of the dimensions, by their numbers
    std::vector<std::string> names_;
    std::map<std::pair<std::string, std::string>, std::string> texts_;  // by variable and attribute
    std::optional<std::size_t> unlimited_;
    std::size_t record_bytes_ = 0;
    mutable NamedFiles named_;
};

}  // namespace

std::unique_ptr<NetcdfSource> open_classic_netcdf(std::string_view bytes, std::string_view file) {
    return std::make_unique<ClassicNetcdf>(bytes, file);
}

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
