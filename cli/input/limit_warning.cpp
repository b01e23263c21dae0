// SPDX-License-Identifier: Apache-2.0
#include "limit_warning.h"

#include "input.h"
#include "subvol/detail/limit_words.h"

namespace subvol::cli {

std::string limit_warning(const LimitBody& body) {
    return detail::limit_words(body, OptionNames::Flags);
}

std::string fold_warning(const SeenFolds& folds) {
    return detail::fold_words(folds.cells, folds.first, folds.place, OptionNames::Flags);
}

std::string range_warning(const std::string& field, const Range& file, const Range& limit, bool at_least) {
    return detail::range_words(field, file.min, file.max, limit.min, limit.max, OptionNames::Flags, at_least);
}

std::string range_warning(const Attribute& field, const Range& file, const Range& limit, bool at_least) {
    return field.derived ? "" : range_warning(field.name, file, limit, at_least);
}

std::string limit_warning(const std::string& input, const MeshSource& source, const SchemeOptions& scheme, Progress* progress) {
    const HexMesh* mesh = source.mesh();
    if (mesh == nullptr || mesh->cells.empty() || is_model(input) || scheme.kind == Scheme::Linear) return "";
    return limit_warning(limit_body(*mesh, scheme, 1, progress));
}

}  // namespace subvol::cli
