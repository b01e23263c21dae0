#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "subvol/rbf_field.h"
#include "subvol/refine.h"

namespace subvol {

/// Places in a volume with the values of its limit.
struct FieldPlaces {
    std::vector<Vec3> positions;
    std::vector<double> values;
};

/// Where in a mesh: anywhere; at interior edges of other than four cells; at the boundary.
enum class PlaceKind { Anywhere, Extraordinary, Boundary };

/// Random places in the cells of a mesh and the limit of an attribute's one channel there, to level 6.
///
/// within:  for the last two kinds, how far from the edge or face a place may be, in cells: (0,1]
/// returns: nothing if the mesh has no such edge
/// throws:  Error(InvalidInput) as `evaluate_limit`, or if there is no such attribute of one channel
[[nodiscard]] FieldPlaces random_places(const HexMesh& mesh, std::string_view attribute, PlaceKind kind, double within,
                                        std::size_t count, std::uint64_t seed, Scheme scheme = Scheme::Mcq);

/// missing: places at which the field is nothing; they do not count
struct FieldError {
    double rmse = 0;
    double max = 0;
    std::size_t missing = 0;
};

[[nodiscard]] FieldError field_error(const RbfField& field, const FieldPlaces& places);

}  // namespace subvol
