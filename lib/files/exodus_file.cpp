// SPDX-License-Identifier: Apache-2.0
#include "exodus_file.h"

#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace {

// netCDF pads names with zeros or blanks.
std::string trimmed(std::string_view text) {
    text = text.substr(0, text.find('\0'));
    return as_utf8(text.substr(0, text.find_last_not_of(' ') + 1));
}

}  // namespace

ExodusFile::ExodusFile(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {
    if (bytes.empty()) fail("the file is empty");
    if (bytes.starts_with("CDF")) {
        source_ = open_classic_netcdf(bytes, file);
    } else if (bytes.starts_with("\x89HDF")) {
        source_ = open_netcdf4(file);
    } else {
        fail("not an Exodus II file: it begins neither as netCDF nor as HDF5");
    }
}

std::size_t ExodusFile::dimension(const std::string& name) const {
    const auto found = source_->dimensions.find(name);
    return found == source_->dimensions.end() ? 0 : found->second;
}

const NetcdfVariable& ExodusFile::checked(const std::string& name, const std::vector<std::size_t>& places,
                                          std::size_t count) const {
    const auto found = source_->variables.find(name);
    if (found == source_->variables.end()) fail("there is no " + name);
    const NetcdfVariable& variable = found->second;
    if (variable.lengths.size() < places.size() || (variable.record && places.empty())) {
        fail(name + " has " + counted(variable.lengths.size(), "dimension", "dimensions"));
    }
    expect_room(count, size_of(variable.type), name);
    std::size_t values = 1;
    bool too_many = false;  // so that no product overflows
    for (std::size_t d = 0; d < variable.lengths.size(); ++d) {
        const std::size_t length = variable.lengths[d];
        if (d < places.size()) {
            if (places[d] >= length) fail(name + " has " + std::to_string(length) + " values along a dimension");
            continue;
        }
        too_many = too_many || (length > 0 && values > count / length);
        if (!too_many) values *= length;
    }
    if (too_many || values != count) fail(name + " does not have the " + std::to_string(count) + " values that are needed");
    return variable;
}

void ExodusFile::expect_room(std::size_t things, std::size_t bytes, const std::string& what) const {
    if (things <= bytes_.size() * source_->growth() / bytes) return;
    fail(what + ": count out of range: " + std::to_string(things), "the file has " + counted(bytes_.size(), "byte", "bytes"));
}

std::vector<double> ExodusFile::reals(const std::string& variable, const std::vector<std::size_t>& places,
                                      std::size_t count) const {
    const NetcdfVariable& found = checked(variable, places, count);
    if (found.characters) fail(variable + " does not consist of numbers");
    return reals_from(source_->values(variable, places), found.type, std::endian::native);
}

std::vector<std::int64_t> ExodusFile::integers(const std::string& variable, std::size_t count) const {
    const NetcdfVariable& found = checked(variable, {}, count);
    if (found.characters || !is_integer(found.type)) fail(variable + " does not consist of integers");
    return integers_from(source_->values(variable, {}), found.type, std::endian::native);
}

std::vector<std::string> ExodusFile::names(const std::string& variable, std::size_t count) const {
    if (count == 0) return {};
    const auto found = source_->variables.find(variable);
    const bool rows = found != source_->variables.end() && found->second.characters && found->second.lengths.size() == 2;
    const std::size_t length = rows ? found->second.lengths[1] : 0;
    if (length == 0 || found->second.lengths[0] != count)
        fail("there are no " + std::to_string(count) + " names in " + variable);
    expect_room(count, length, variable);
    static_cast<void>(checked(variable, {}, count * length));
    const std::string text = source_->values(variable, {});
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.push_back(trimmed(std::string_view(text).substr(i * length, length)));
    return names;
}

std::string ExodusFile::attribute(const std::string& variable, const std::string& name) const {
    return trimmed(source_->attribute(variable, name));
}

void ExodusFile::fail(const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, printable(message), std::string(file_), printable(allowed));
}

}  // namespace subvol::detail
