// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/detail/flat_array.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Which groups of a file the user has asked for, by name.
class SharpGroups {
public:
    explicit SharpGroups(std::span<const std::string> wanted) : wanted_(wanted.begin(), wanted.end()), missing_(wanted_) {}

    /// Whether any are wanted; if not, readers need not look at groups.
    [[nodiscard]] bool any() const { return !wanted_.empty(); }

    /// Whether a group of the file that has faces or edges is wanted, by its name or by its number.
    bool takes(const std::string& name, const std::string& number);
    bool takes(const std::string& name) { return takes(name, name); }

    /// To be called after the last group. throws: Error(InvalidInput) if a wanted group was not in the file; lists those that
    /// were
    void check(std::string_view file) const;

private:
    std::set<std::string> wanted_, missing_, known_;
};

/// Tags faces and edges of a mesh: faces inside as sharp, edges as creases. Faces on the hull and edges that are creases
/// already stay as they are.
///
/// sources: the points of the file whose mean each point of the mesh is, if its cells were split; null if they are the same.
///          The tags are split too
/// throws:  Error(InvalidInput) if a face is not one of a cell, or an edge is not on the boundary or on a sharp face
void add_sharp_tags(HexMesh& mesh, FileTags&& tags, const IndexRows* sources, std::string_view file, const EntityNames& names);

/// "2 creases and 1 sharp face"; for warnings of writers
[[nodiscard]] std::string sharp_counts(const HexMesh& mesh);

}  // namespace subvol::detail
