// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "subvol/detail/hdf5_file.h"

namespace subvol::detail {

/// The nodes of a CGNS file: groups of HDF5 with a label, and data in a dataset of theirs.
class CgnsTree {
public:
    explicit CgnsTree(const Hdf5File& file) : file_(file) {}

    /// The paths of the children with this label, in the order of their names.
    [[nodiscard]] std::vector<std::string> children(const std::string& node, const std::string& label) const;
    /// The paths and labels of all children.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> labelled_children(const std::string& node) const;
    /// The first of them.
    [[nodiscard]] std::optional<std::string> child(const std::string& node, const std::string& label) const;

    [[nodiscard]] bool has_data(const std::string& node) const { return file_.has(node + kData); }
    [[nodiscard]] std::vector<double> reals(const std::string& node) const;
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& node) const;
    /// A text; empty if the node has none.
    [[nodiscard]] std::string text(const std::string& node) const;
    /// Texts of 32 characters each.
    [[nodiscard]] std::vector<std::string> texts(const std::string& node) const;

    [[nodiscard]] static std::string name_of(const std::string& node) { return node.substr(node.rfind('/') + 1); }
    [[nodiscard]] const Hdf5File& file() const { return file_; }

private:
    static constexpr const char* kData = "/ data";
    [[nodiscard]] std::size_t all_rows(const std::string& node) const;

    const Hdf5File& file_;
};

}  // namespace subvol::detail
