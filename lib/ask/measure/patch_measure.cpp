// SPDX-License-Identifier: Apache-2.0
// A side of a cell is a map x(s,t) of the unit square. With the outward normal n the patch's area and flow are
//
//     A = Σ ∫∫ |∂x/∂s × ∂x/∂t| ds dt        Φ = Σ ∫∫ F · (∂x/∂s × ∂x/∂t) ds dt        (n dA = ∂x/∂s × ∂x/∂t ds dt)
//
// over its sides. Both are summed at the places of Gauss, of which the limit gives position, Jacobian and fields. The flow
// needs no unit normal, so that it is exact where A is not: the integrand is a product of smooth functions.
#include "subvol/patch_measure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "extreme_bounds.h"
#include "extreme_search.h"
#include "given_figures.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/node_steps.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/error.h"
#include "subvol/progress.h"

namespace subvol {
namespace {

constexpr int kMostPartsOfSide = 8;
constexpr std::size_t kSidePlacesAtOnce = std::size_t{1} << 18;

/// A place of a rule on the unit interval.
struct RuleNode {
    double at, weight;
};

/// The 3-point rule of Gauss in each of n equal parts.
std::vector<RuleNode> gauss_nodes(int n) {
    const double away = std::sqrt(0.6);
    std::vector<RuleNode> nodes;
    for (int part = 0; part < n; ++part) {
        for (const auto& [at, weight] : {RuleNode{-away, 5.0 / 18}, RuleNode{0, 8.0 / 18}, RuleNode{away, 5.0 / 18}})
            nodes.push_back({(part + (1 + at) / 2) / n, weight / n});
    }
    return nodes;
}

/// Places at which the search for least and largest values begins, corners among them.
constexpr std::size_t kEvenNodes = 5;
std::vector<RuleNode> even_nodes() {
    return {{0, 0}, {0.25, 0}, {0.5, 0}, {0.75, 0}, {1, 0}};
}

Vec3 vector_of(const std::array<double, 3>& a) {
    return {a[0], a[1], a[2]};
}

/// What is summed over a patch.
struct PatchSums {
    double area = 0, flux = 0, throughput = 0;
    Vec3 normal{0.0};
    std::vector<double> fields;  // of each channel
};

/// The limit near some patches, at places of their sides.
class PatchLimit {
public:
    /// flux: the field whose flow is wanted; with a potential, as one channel: its gradient
    PatchLimit(const HexMesh& mesh, std::span<const Patch> patches, const PatchOptions& options,
               const std::optional<Attribute>& flux)
        : part_(near(mesh, patches, flux)),
          extent_(extent(mesh, flux)),
          limit_(part_.mesh, {.scheme = options.scheme, .tolerance = 1e-5}, extent_),
          has_flux_(flux.has_value()),
          of_potential_(flux && flux->channels == 1) {
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const Attribute& attribute = mesh.attributes[a];
            const auto& [least, largest] = extent_.ranges[a];
            for (int c = 0; c < attribute.channels; ++c) {
                const std::string suffix = attribute.channels > 1 ? "." + std::to_string(c) : "";
                channels_.push_back(attribute.name + suffix);
                scales_.push_back(detail::value_scale(least, largest));
                origins_.push_back(least + (largest - least) / 2);
            }
        }
        for (std::size_t i = 0; has_flux_ && !of_potential_ && i < flux->values.size(); i += 3) {
            const double* const v = &flux->values[i];
            longest_ = std::max(longest_, glm::length(Vec3(v[0], v[1], v[2])));
        }
    }

    [[nodiscard]] const std::vector<std::string>& channels() const { return channels_; }
    /// Of each channel 1/range of its attribute, 0 for a constant.
    [[nodiscard]] const std::vector<double>& scales() const { return scales_; }
    /// A value in the range of each channel, without which its sums are taken.
    [[nodiscard]] const std::vector<double>& origins() const { return origins_; }
    [[nodiscard]] bool has_flux() const { return has_flux_; }
    /// The length of the longest vector whose flow is asked for.
    [[nodiscard]] double longest() const { return longest_; }

    /// PatchSums over a patch by a rule in both directions of each side.
    [[nodiscard]] PatchSums sums(const Patch& patch, const std::vector<RuleNode>& rule) const {
        PatchSums sums;
        sums.fields.resize(channels_.size(), 0);
        each_place(patch, rule, [&](const Vec3& normal, std::span<const double> values, double weight) {
            const double area = weight * glm::length(normal);
            sums.area += area;
            sums.normal += weight * normal;
            const std::size_t fields = channels_.size();
            for (std::size_t k = 0; k < fields; ++k) sums.fields[k] += area * (values[k] - origins_[k]);
            if (!has_flux_) return;
            const double flow = weight * glm::dot(normal, Vec3(values[fields], values[fields + 1], values[fields + 2]));
            sums.flux += flow;
            sums.throughput += std::abs(flow);
        });
        return sums;
    }

    /// Least and largest values over the sides of the patches.
    void find_extremes(std::span<const Patch> patches, const PatchOptions& options, std::vector<PatchMeasure>& all) const {
        constexpr double kTolerance = 1e-4;  // of a range
        if (channels_.empty()) return;
        detail::ExtremeSearch search(patches.size(), scales_, detail::channel_bounds(part_.mesh), kTolerance);
        for (std::size_t p = 0; p < patches.size(); ++p) look(search, p, patches[p]);
        HexMesh mesh = part_.mesh;
        detail::LimitExtent extent = extent_;
        if (has_flux_) {
            mesh.attributes.pop_back();
            extent.ranges.pop_back();
        }
        std::vector<PartMeasure> found(1 + patches.size());  // the first one is the whole
        for (PartMeasure& one : found) one.fields.resize(channels_.size());
        search.find(detail::control_mesh(std::move(mesh), options.scheme), options.scheme, extent, options.progress, found);
        for (std::size_t p = 0; p < patches.size(); ++p) {
            for (std::size_t k = 0; k < channels_.size(); ++k) {
                const FieldMeasure& from = found[p + 1].fields[k];
                PatchField& to = all[p].fields[k];
                to.min = in_whole(from.min);
                to.max = in_whole(from.max);
                to.extreme_error = from.extreme_error;
            }
        }
    }

private:
    static detail::LimitExtent extent(const HexMesh& mesh, const std::optional<Attribute>& flux) {
        detail::LimitExtent extent = detail::limit_extent(mesh);
        if (!flux) return extent;
        const auto [least, greatest] = std::ranges::minmax(flux->values);
        extent.ranges.push_back({least, greatest});
        return extent;
    }

    /// The cells near the patches; the vectors of the flow become the last attribute.
    static detail::MeshSubset near(const HexMesh& mesh, std::span<const Patch> patches, const std::optional<Attribute>& flux) {
        std::vector<std::uint8_t> cells(mesh.cells.size(), 0);
        for (const Patch& patch : patches) {
            if (patch.sides.empty()) throw Error(ErrorCode::InvalidInput, "has no sides", "patch \"" + patch.name + "\"");
            for (const CellSide& side : patch.sides) {
                if (side.cell >= cells.size() || side.side > 5)
                    throw Error(ErrorCode::InvalidInput, "has a side that is not of the mesh", "patch \"" + patch.name + "\"");
                cells[side.cell] = 1;
            }
        }
        detail::grow(mesh, cells, detail::kHaloOfLimit);
        detail::MeshSubset part = detail::subset(mesh, cells);
        if (!flux) return part;
        Attribute& vectors = part.mesh.attributes.emplace_back(detail::without_values(*flux));
        for (const Index p : part.points) detail::add_point(*flux, p, vectors);
        return part;
    }

    /// Shows the sides of a patch to the search, each by 5² values.
    void look(detail::ExtremeSearch& search, std::size_t number, const Patch& patch) const {
        const std::vector<RuleNode> rule = even_nodes();
        std::vector<double> places;  // the values of all channels at the places of a side
        std::vector<CellSide> sides;
        std::vector<detail::GridMeasure::Extreme> found;
        const std::size_t of_place = channels_.size() + (has_flux_ ? 3 : 0);
        each_place(patch, rule, [&](const Vec3&, std::span<const double> values, double) {
            places.insert(places.end(), values.begin(), values.end());
            if (places.size() < kEvenNodes * kEvenNodes * of_place) return;
            const CellSide side{number_of(patch.sides[sides.size()].cell), patch.sides[sides.size()].side};
            found.clear();
            for (std::size_t k = 0; k < channels_.size(); ++k) {
                if (scales_[k] == 0) {
                    search.know_constant(number, k, places[k], side.cell);
                    continue;
                }
                for (const double sign : {-1.0, 1.0}) {
                    std::array<double, 125> grid;  // the same five times
                    for (std::size_t n = 0; n < grid.size(); ++n) grid[n] = sign * places[n % 25 * of_place + k];
                    const auto best = static_cast<std::size_t>(std::ranges::max_element(grid) - grid.begin());
                    const double bound = std::max(grid[best], std::ranges::max(detail::octant_bounds(grid).bounds));
                    const Vec3 at = vector_of(place_on_side(side.side, rule[best / kEvenNodes].at, rule[best % kEvenNodes].at));
                    found.push_back({k, sign, grid[best], bound, at, at, sides.size()});
                }
            }
            search.look(number, side.cell, sides.size(), detail::box_of_side(side.side).width / 4.0, found);
            sides.push_back(side);
            places.clear();
        });
        search.end_sides(sides);
    }

    [[nodiscard]] LimitExtreme in_whole(LimitExtreme extreme) const {
        if (extreme.cell != kNone) extreme.cell = part_.cells[extreme.cell];
        return extreme;
    }

    [[nodiscard]] Index number_of(Index cell) const {
        return static_cast<Index>(std::ranges::lower_bound(part_.cells, cell) - part_.cells.begin());
    }

    /// Calls call(∂x/∂s × ∂x/∂t, values of all channels, weight) place by place, in the order of the sides.
    template <class Call>
    void each_place(const Patch& patch, const std::vector<RuleNode>& rule, const Call& call) const {
        const std::size_t of_side = rule.size() * rule.size();
        const std::size_t at_once = std::max<std::size_t>(1, kSidePlacesAtOnce / of_side);
        std::vector<LimitQuery> queries;
        std::vector<double> values(channels_.size() + (has_flux_ ? 3 : 0));
        for (std::size_t begin = 0; begin < patch.sides.size(); begin += at_once) {
            const std::size_t end = std::min(begin + at_once, patch.sides.size());
            queries.clear();
            for (std::size_t i = begin; i < end; ++i) {
                const auto [cell, side] = patch.sides[i];
                const Index number = number_of(cell);
                for (const RuleNode& s : rule) {
                    for (const RuleNode& t : rule) queries.push_back({number, vector_of(place_on_side(side, s.at, t.at))});
                }
            }
            const LimitSamples samples = limit_.at(queries);
            for (std::size_t q = 0; q < queries.size(); ++q) {
                const std::uint8_t side = patch.sides[begin + q / of_side].side;
                const Vec3 origin = vector_of(place_on_side(side, 0, 0));
                const Vec3 along_s = samples.jacobians[q] * (vector_of(place_on_side(side, 1, 0)) - origin);
                const Vec3 along_t = samples.jacobians[q] * (vector_of(place_on_side(side, 0, 1)) - origin);
                std::size_t next = 0;
                for (const LimitAttribute& attribute : samples.attributes) {
                    for (std::size_t c = 0; c < attribute.channels; ++c)
                        values[next++] = attribute.values[q * attribute.channels + c];
                }
                if (of_potential_) {
                    const Vec3 gradient = samples.attributes.back().derivatives[q] * glm::inverse(samples.jacobians[q]);
                    for (int k = 0; k < 3; ++k) values[channels_.size() + static_cast<std::size_t>(k)] = gradient[k];
                }
                const std::size_t k = q % of_side;
                call(glm::cross(along_s, along_t), values, rule[k / rule.size()].weight * rule[k % rule.size()].weight);
            }
        }
    }

    detail::MeshSubset part_;
    detail::LimitExtent extent_;
    LimitEvaluator limit_;
    std::vector<std::string> channels_;
    std::vector<double> scales_, origins_;
    bool has_flux_, of_potential_;
    double longest_ = 0;
};

/// What the finer sums change, as parts of what the error is a part of.
double change_of(const PatchLimit& limit, const PatchSums& sums, const PatchSums& finer) {
    if (!(finer.area > 0)) return 0;
    double largest = std::abs(finer.area - sums.area) / finer.area;
    for (std::size_t k = 0; k < sums.fields.size(); ++k) {
        const double before = sums.area > 0 ? sums.fields[k] / sums.area : 0, after = finer.fields[k] / finer.area;
        largest = std::max(largest, limit.scales()[k] * std::abs(after - before));
    }
    const double flow = finer.area * limit.longest();
    return flow > 0 ? std::max(largest, std::abs(finer.flux - sums.flux) / flow) : largest;
}

PatchMeasure measure_patch(const PatchLimit& limit, const Patch& patch, const PatchOptions& options) {
    PatchMeasure result;
    result.name = patch.name;
    result.sides = patch.sides.size();
    PatchSums sums = limit.sums(patch, gauss_nodes(1));
    for (int n = 2; n <= kMostPartsOfSide; n *= 2) {
        PatchSums finer = limit.sums(patch, gauss_nodes(n));
        result.error = change_of(limit, sums, finer);
        sums = std::move(finer);
        if (result.error <= options.tolerance) break;
    }
    result.area = sums.area;
    result.normal = sums.normal;
    if (limit.has_flux()) {
        result.flux = sums.flux;
        result.throughput = sums.throughput;
    }
    for (std::size_t k = 0; k < limit.channels().size(); ++k) {
        PatchField& field = result.fields.emplace_back();
        field.name = limit.channels()[k];
        if (!(sums.area > 0)) continue;
        field.mean = limit.origins()[k] + sums.fields[k] / sums.area;
        field.integral = field.mean * sums.area;
    }
    return result;
}

}  // namespace

namespace {

/// given: of the cells as they were given
std::vector<PatchMeasure> measured(const HexMesh& mesh, std::span<const Patch> patches, const PatchOptions& options,
                                   bool given) {
    std::optional<Attribute> flux = options.flux_field;
    if (!flux && !options.flux.empty()) flux = Attribute{"", 3, {options.flux.begin(), options.flux.end()}};
    if (flux && (flux->channels != 3 || flux->values.size() != 3 * mesh.points.size()))
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(flux->values.size()) + " numbers", "flux",
                    "three for each of the " + std::to_string(mesh.points.size()) + " points");
    if (given && flux && flux->derived) flux = flux->potential ? std::optional(*flux->potential) : std::nullopt;
    const PatchLimit limit(mesh, patches, options, flux);
    std::vector<PatchMeasure> all;
    for (const Patch& patch : patches) {
        report_progress(options.progress, "patches", static_cast<double>(all.size()) / static_cast<double>(patches.size()));
        all.push_back(measure_patch(limit, patch, options));
    }
    limit.find_extremes(patches, options, all);
    return all;
}

}  // namespace

std::vector<PatchMeasure> measure_patches(const HexMesh& mesh, std::span<const Patch> patches, const PatchOptions& options) {
    validate(mesh);
    report_progress(options.progress, "patches", 0);
    std::vector<PatchMeasure> all = measured(mesh, patches, options, false);
    PatchOptions linear = options;
    linear.scheme = {.kind = Scheme::Linear};
    const HexMesh cells = detail::as_given(mesh);
    std::vector<PatchMeasure> given = measured(cells, patches, linear, true);
    for (std::size_t p = 0; p < all.size(); ++p) {
        all[p].given_area = given[p].area;
        all[p].given_flux = given[p].flux;
        all[p].given_throughput = given[p].throughput;
        std::size_t k = 0;
        for (const Attribute& attribute : cells.attributes) {
            for (int c = 0; c < attribute.channels; ++c, ++k) {
                if (attribute.derived) continue;
                PatchField& from = given[p].fields[k];
                detail::move_to_own_places(cells, attribute, from.min, from.max);
                all[p].fields[k].given = {from.integral, from.mean, from.min, from.max};
            }
        }
    }
    return all;
}

}  // namespace subvol
