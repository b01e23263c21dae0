// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ensight_data.h"
#include "subvol/index.h"

namespace subvol::detail {

/// Turns the files of EnSight 6 into what binary files of EnSight Gold have.
///
/// Version 6 has one list of nodes for all parts, and the values at them without parts; Gold has the nodes and values of each
/// part, one component after the other.
class EnsightSix {
public:
    /// The geometry of a step, which is remembered for the variables.
    [[nodiscard]] std::string geometry(EnsightData& data);
    /// A variable on that geometry.
    [[nodiscard]] std::string variable(EnsightData& data, std::size_t components, bool at_cells) const;

private:
    // The elements of one type: the nodes of all of them, as places in the list of nodes.
    struct Group {
        std::string type;
        std::size_t count = 0;
        std::vector<Index> corners;
    };
    struct Part {
        std::int64_t number = 0;
        std::string name;
        std::string block;  ///< bytes of a structured part
        std::size_t block_points = 0, block_cells = 0;
        std::vector<Group> groups;
        std::vector<Index> nodes;  ///< nodes that its elements use
    };

    void read_nodes(EnsightData& data, const std::string& ids);
    void read_block(EnsightData& data, Part& part, const std::string& line);
    void read_elements(EnsightData& data, Part& part, const std::string& type, bool ids) const;
    static void put(std::string& out, Part& part, const std::vector<float>& points);
    [[nodiscard]] const Part& part_of(const EnsightData& data, const std::string& line) const;

    std::vector<Part> parts_;
    std::size_t count_ = 0;  // of the nodes in the list
    std::vector<float> points_;
    std::unordered_map<std::int64_t, Index> places_;  // of the nodes by their numbers, where elements use these
    bool numbered_ = false;
    std::endian order_ = std::endian::little;  // of the files: those of variables begin with reals, which show none
};

}  // namespace subvol::detail
